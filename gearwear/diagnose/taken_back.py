"""Effects of which the others take back most: together they describe a form, and none of them is a finding by itself.

Beside a form that the catalogue does not have, wear of a whole side or of the coast flanks, a tip relief of 74 µm, slopes of 57 and 147 µm and a laser
238 µm beside the axis may fit best, which on a flank leave some micrometres. Each stands out of its own ± by far: what tells is how much of it is there in
their sum.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.surface import FILLET, FLANK
from gearwear.diagnose.rules import rules


def beside_pose(fields: Floats, pose: Floats, weight: Floats) -> Floats:
    """What effects do to the deviation of cells, (m, k) mm, less what a motion of the scan takes up of it.

    Parameters
    ----------
    fields : (m, k) float
        mm.
    pose : (m, p) float
        What a motion of the scan does.
    weight : (m,) float
        Of the cells; 0 where one is not used.
    """
    root = np.sqrt(weight)[:, None]
    return np.asarray(fields - pose @ np.linalg.lstsq(pose * root, fields * root)[0], dtype=np.float64)


def taken_back(fields: Floats, weight: Floats, surface: Ints) -> Bools:
    """Which effects take each other back by more than a share.

    Parameters
    ----------
    fields : (m, k) float
        What each effect does to the deviation of cells, beside the pose, mm.
    weight : (m,) float
        Of the cells; 0 where one is not used.
    surface : (m,) int
        Codes of `gearwear.design.surface`.

    Returns
    -------
    (k,) bool
        The largest set of effects of each of which, both on the sides of teeth and on all else that holds a `surface_share` of it, less than `left_of_it` is
        in the sum of the set, and of all: s f / f f, weighted. A relief beside a crowning three times as large, the other way round, is not taken back
        by it: what is left is the crowning.

    Notes
    -----
    Flanks and fillets, which are cut together, apart from all other surfaces, because others may hide an effect there and not here: a coat over teeth that
    were cut thin stands on tips, roots and ends.
    """
    sides = (surface == FLANK) | (surface == FILLET)
    on = [sides, ~sides]
    size = np.array([weight[where] @ fields[where] ** 2 for where in on])
    holds = size > rules().surface_share * size.sum(axis=0)

    def among(which: Bools) -> Bools:
        together = weight * fields[:, which].sum(axis=1)
        shown = np.array([together[where] @ fields[where] for where in on])
        return np.asarray(which & (~holds | (shown < rules().left_of_it * size)).all(axis=0))

    back = among(np.ones(fields.shape[1], dtype=np.bool_))
    while (fewer := among(back)).sum() < back.sum():
        back = fewer
    return back

"""How high the flanks of sides worn throughout may stand as they were made, where nothing shows it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK
from gearwear.diagnose.clustered import fit_by_teeth
from gearwear.diagnose.fit import Fit, Model


@dataclass(frozen=True, slots=True)
class MadeHeight:
    """What a worn side may have been made like, unlike `Loop.hidden` no doubt that it is worn.

    Parameters
    ----------
    sides : frozenset of Side
        Worn throughout, and not seen to both ends of the face.
    std : float
        Standard deviation of how high all flanks of each stand in their mean, mm.
    """

    sides: frozenset[Side] = frozenset()
    std: float = 0.0

    def of(self, side: Side) -> float:
        """`std` of one side, mm; 0 of one that is known."""
        return self.std if side in self.sides else 0.0


def made_height(
    worn: frozenset[Side], fit: Fit, told: list[Floats], untold: Floats, besides: float = 0.0, from_one_end: bool = False
) -> MadeHeight:
    """Of sides `worn` throughout: as much as what the maker left varies over the flanks that are seen (RMS): who is off by that in form and pitch is
    no better in thickness. Of each kind that is `told`, (m,) mm, only its mean over the face counts, but where the height is known `from_one_end` of it; of what is `untold`, (m,) mm, all.
    And what else leaves it open, `besides`, mm.

    Notes
    -----
    A lead, a crowning along the face, a twist or the marks of a feed leave the mean over the face where it is, and so say nothing of how high a flank stands.
    Of what differs from tooth to tooth that of neighbours counts, as in a single pitch deviation: what goes slowly round the gear, as the sum of these or a blank off
    its axis, turns both flanks of a tooth alike and tells nothing of its thickness. It is the root of half their mean square difference, that of teeth which scatter each by itself.
    """
    points = fit.cells.points
    flank = (points.surface == FLANK) & fit.cells.seen
    seen = fit.use & flank if (fit.use & flank).any() else flank
    if not worn or not seen.any():
        return MadeHeight()
    grid = fit.cells.grid
    variance = besides**2
    known = grid.flank_shape(seen)
    untold, *told = (grid.flank_shape(np.where(seen, field, 0.0)) for field in (untold, *told))
    for values in (untold, *(values if from_one_end else _over_the_face(known, values) for values in told)):
        variance += _variance_alike(known, values) + _variance_of_neighbours(known, values)
    return MadeHeight(worn, math.sqrt(variance)) if variance > 0.0 else MadeHeight()


def _over_the_face(seen: Bools, values: Floats) -> Floats:
    """Values (teeth, 2, rows, columns), each the mean of its row across the face; 0 where they are not seen."""
    number = np.maximum(seen.sum(axis=2, keepdims=True), 1)
    return np.where(seen, values.sum(axis=2, keepdims=True) / number, 0.0)


def _variance_alike(seen: Bools, values: Floats) -> float:
    """Of what (teeth, 2, rows, columns) values have in common on all teeth, about its mean on each side."""
    number = seen.sum(axis=0)
    mean = values.sum(axis=0) / np.maximum(number, 1)
    middle = values.sum(axis=(0, 2, 3)) / np.maximum(number.sum(axis=(1, 2)), 1)
    return float((number * (mean - middle[:, None, None]) ** 2).sum() / number.sum())


def _variance_of_neighbours(seen: Bools, values: Floats) -> float:
    """Of what values (teeth, 2, rows, columns) have of their own on each tooth, by half the squares of differences of neighbours."""
    both = seen & np.roll(seen, 1, axis=0)
    squares = np.where(both, values - np.roll(values, 1, axis=0), 0.0) ** 2
    return 0.5 * float(squares.sum()) / max(int(both.sum()), 1)


def fillets_off(fit: Fit, model: Model, worn: frozenset[Side]) -> float:
    """How far fillets stand off where a model has them beside flanks, mm, the sides' means together (RMS) and less what is chance; 0 of none.

    Parameters
    ----------
    fit : Fit
    model : Model
        What is told; of its effects nothing is asked.
    worn : frozenset of Side
        Sides worn throughout: where one is sound its fillets tell, and no wear that reaches down to them.

    Notes
    -----
    Fillets tell how high a worn flank was made as far as they were cut with it. How far flanks and fillets of a gear stand apart those that are seen show.
    The variance of a mean is that of `fit_by_teeth`.
    """
    points, squares = fit.cells.points, list[float]()
    residual, weight = fit.residual(model), fit.weight
    for side in set(Side) - worn or set(Side):
        used = (points.surface == FILLET) & (points.side == int(side)) & fit.use
        fitted = fit_by_teeth(np.ones((int(used.sum()), 1)), weight[used], residual[used], points.tooth[used])
        if fitted is not None:
            (mean,), ((variance,),) = fitted
            squares.append(float(mean**2 - variance))
    return math.sqrt(max(float(np.mean(squares)), 0.0)) if squares else 0.0

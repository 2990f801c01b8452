"""The thickness of worn teeth of which few sections have enough points: by the surfaces of their flanks, which rest on all points of these.

What a surface says where nobody saw the flank is no thickness: only sections in which every worn flank of the tooth has points about the radius are
looked at. How high a surface lies there, next to the ridge that wear leaves at the pitch point, is known from the teeth that both sections and
surfaces measured.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.quantity import NORMAL_95
from gearwear.robust import scale_about
from gearwear.wear.flank_arcs import WornArcs, drawn
from gearwear.wear.least import least_of_curves
from gearwear.wear.regions import Wear
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.tooth_summary import ThinnestTooth, UnmeasuredTeeth

MEASURED = 0.5
"""Share of its sections from which on a tooth counts as measured; of measured teeth, of those that must have a section for it to count."""
FEWEST_TEETH = 5
"""Measured teeth that say how high surfaces lie."""


def unmeasured_teeth(thickness: SectionThickness, wear: Wear, arcs: WornArcs) -> UnmeasuredTeeth | None:
    """Of the worn teeth that few sections measured; None where every worn tooth was measured, or nothing is known of the others.

    Parameters
    ----------
    thickness : SectionThickness
    wear : Wear
    arcs : WornArcs
        The flanks of worn teeth.

    Notes
    -----
    Where few teeth were measured, how high a surface lies is known as well as the deepest places of the flanks are.
    """
    arc, as_made, z = thickness.arc, thickness.as_made, thickness.z
    seen = np.isfinite(arc)
    measured = seen.mean(axis=1) >= MEASURED
    # Not those at chamfered ends, which no tooth has.
    usual = seen[measured].mean(axis=0) >= MEASURED if measured.any() else np.ones(len(z), dtype=np.bool_)
    measurable = arcs.measurable()
    off, found = list[Floats](), dict[int, Floats]()
    for tooth in np.flatnonzero(arcs.worn.any(axis=1)).tolist():
        own = [flank.expected[0] for flank in arcs.flanks(tooth)]
        if len(own) == 2 and measured[tooth]:
            off.append(arc[tooth] - as_made[tooth] - sum(own))
        elif own and not measured[tooth]:
            found[tooth] = as_made[tooth] + sum(own)
    level, apart = _level(np.array(off)[:, usual]) if len(off) >= FEWEST_TEETH else (0.0, math.nan)
    rows = list[tuple[int, int, float, float]]()
    for tooth, curve in found.items():
        here = usual & np.isfinite(curve) & measurable[tooth]
        known = apart if math.isfinite(apart) else _by_regions(wear, tooth, thickness.turn)
        if not here.any() or not math.isfinite(known):
            continue
        curve[usual] += level
        # Of the surface that is expected: the least of one that is drawn is lower by its luck.
        off_expected = drawn(arcs.flanks(tooth))
        at = int(np.argmin(np.where(here, curve, np.inf)))
        rows.append((tooth, at, float(curve[at]), math.hypot(known, float(off_expected[:, at].std()))))
    return _of_rows(rows, thickness) if rows else None


def _level(off: Floats) -> tuple[Floats, float]:
    """What measured teeth lie off their surfaces, in each section (n_z,), and how far it differs from tooth to tooth, mm, from (teeth, n_z)."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a section that none of them has
        level = np.nan_to_num(np.nanmedian(off, axis=0), nan=float(np.nanmedian(off)))
        return level, scale_about(np.nanmean(off - level, axis=1))


def _of_rows(rows: list[tuple[int, int, float, float]], thickness: SectionThickness) -> UnmeasuredTeeth:
    """Of tooth, section, arc and its standard deviation by itself: each, and the least of all, without the bias of having looked for it."""
    teeth = tuple(_tooth(tooth, at, value, std, thickness) for tooth, at, value, std in rows)
    if len(teeth) == 1:  # nothing was looked for
        return UnmeasuredTeeth(teeth, teeth[0])
    value, std = (np.array([row[place] for row in rows])[:, None] for place in (2, 3))
    least = least_of_curves(value, std)
    tooth, at = rows[least.curve][:2]
    of_all = _tooth(tooth, at, least.overall, least.overall_std, thickness)
    # Any of them may be the thinnest.
    return UnmeasuredTeeth(teeth, replace(of_all, low=min(of_all.low, *(one.low for one in teeth))))


def _tooth(tooth: int, at: int, value: float, std: float, thickness: SectionThickness) -> ThinnestTooth:
    std = math.hypot(std, thickness.common_std)
    made, reach = float(thickness.as_made[tooth, at]), NORMAL_95 * std
    nominal = thickness.nominal if thickness.drawn is None else float(thickness.drawn[tooth, at])
    # No thicker than it was made.
    high = max(value, min(value + reach, made))
    return ThinnestTooth(tooth, value, std, value - reach, high, float(thickness.z[at]), nominal)


def _by_regions(wear: Wear, tooth: int, turn: float) -> float:
    """As well as the deepest places of a tooth's flanks are known, mm of arc."""
    return turn * math.hypot(*(region.max_depth_std for region in wear.regions if region.tooth == tooth))

"""The thickness of worn teeth of which few sections have enough points: by the surface of their wear, which rests on the points of the whole flank."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy import ndimage

from gearwear.design.quantity import NORMAL_95
from gearwear.placing.cells import CellGrid
from gearwear.wear.regions import Wear
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.tooth_summary import ThinnestTooth

ABOUT = 3
"""Cells along the profile and along the face over which the depth at the radius is averaged."""

MEASURED = 0.5
"""Share of its sections from which on a tooth counts as measured."""


def thinnest_unmeasured(thickness: SectionThickness, wear: Wear, grid: CellGrid, roll: float) -> ThinnestTooth | None:
    """The thinnest of the worn teeth that few sections measured.

    Parameters
    ----------
    thickness : SectionThickness
    wear : Wear
    grid : CellGrid
    roll : float
        Length of roll at the radius where thickness is measured, mm.

    Returns
    -------
    ThinnestTooth or None
        As thick as it was made less the depth of its wear there, known as well as the deepest place of each flank; None where every worn tooth was measured.
    """
    arc, as_made, z, turn = thickness.arc, thickness.as_made, thickness.z, thickness.turn
    column = grid.fillet + int(grid.flank_column(roll))
    about = slice(max(column - ABOUT // 2, grid.fillet), column + ABOUT // 2 + 1)
    heights, found = grid.row_middles, list[ThinnestTooth]()
    for tooth in sorted({region.tooth for region in wear.regions}):
        if np.isfinite(arc[tooth]).mean() >= MEASURED or not np.isfinite(as_made[tooth]).any():
            continue
        lost = turn * wear.depth[tooth, :, :, about].mean(axis=2).sum(axis=0)
        left = np.interp(heights, z, as_made[tooth]) - ndimage.uniform_filter1d(lost, ABOUT, mode="nearest")
        row = int(np.argmin(left))
        std = turn * math.hypot(*(region.max_depth_std for region in wear.regions if region.tooth == tooth))
        value, made = float(left[row]), float(np.interp(heights[row], z, as_made[tooth]))
        if math.isfinite(std):
            reach = NORMAL_95 * std
            found.append(ThinnestTooth(tooth, value, std, value - reach, min(value + reach, made), float(heights[row]), made))
    if not found:
        return None
    # Any of them may be the thinnest.
    low, high = (min(getattr(one, end) for one in found) for end in ("low", "high"))
    return replace(min(found, key=lambda one: one.value), low=low, high=high)

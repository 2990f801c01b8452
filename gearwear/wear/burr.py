"""Burrs beside the wear of a whole side: metal pushed over the tip edge, kept apart from what was lost.

Wear of a side runs on evenly to the tip. A burr stands on it there, within some tenths of a module, and where it is higher than the wear is deep it
is proud of the as-made gear. A signed sum over the flank would take it off the wear.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtr, pdtrc

from gearwear.arrays import Floats, Ints
from gearwear.design.side import Side
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.side_maps import SideMaps

WIDTH = 0.2
"""How far a burr reaches down from the tip, in modules along the profile; at least one column of cells."""
BELOW = 0.9
"""How far from the tip, in modules, the columns reach through which the wear is taken to run on straight; at least three columns."""
PROUD_STDS = 3.0
"""Standard deviations of its noise by which a cell, or a point, must stand above the as-made gear to be proud of it."""
CHANCE = 1e-4
"""Chance that a side without a burr shows one, for the number of proud cells, for that of cells with a proud point, and for their excess over the wear
below them, each."""


@dataclass(frozen=True, slots=True)
class TipBurr:
    """Metal pushed over the tip edges of a side.

    Parameters
    ----------
    side : Side
    volume, std : float
        On all its flanks, mm³: above the surface that the wear would have left.
    """

    side: Side
    volume: float
    std: float


def without_burrs(
    sheets: SideMaps, filled: Floats, cells: Cells, noise: float, worn: Iterable[Side]
) -> tuple[SideMaps, tuple[TipBurr, ...], Floats]:
    """The deviations of tooth sides without the burrs of worn sides.

    Parameters
    ----------
    sheets : SideMaps
    filled : (teeth, 2, rows, columns) float
        Their deviations with the unseen cells filled (`infill`), mm.
    cells : Cells
        What they were made of.
    noise : float
        Scatter of points, mm.
    worn : iterable of Side
        Sides worn throughout.

    Returns
    -------
    sheets : SideMaps
        With the mean excess of each of the columns at the tip taken off, flank by flank.
    burrs : tuple of TipBurr
    std : (2,) float
        How well the burr of one flank is known, mm³, on each side; 0 without a burr.

    Notes
    -----
    There is a burr where more cells at the tip stand above the as-made gear than noise lifts (Poisson), or have a point that does, and the columns there
    lie above the straight line through those below them on the mean of all flanks, by Student's t of the flanks. A burr narrower than a cell shows in
    points alone: of so many the highest is proud as often as chance, or strays elsewhere on the flanks, have it.
    """
    std, grid = np.zeros(2), cells.grid
    tip, below = _columns(sheets, grid)
    worn = [side for side in Side if side in worn]
    if not worn or len(below) < 3 or grid.rows == 1 or len(sheets.deviation) < 3:
        return sheets, (), std
    deviation, burrs = sheets.deviation.copy(), []
    for side in worn:
        seen = sheets.seen[:, side.index]
        if not seen[..., tip].any():
            continue
        limit = PROUD_STDS * noise / np.sqrt(np.maximum(sheets.count[:, side.index][..., tip], 1.0))
        proud = (sheets.deviation[:, side.index][..., tip] > limit) & seen[..., tip]
        by_noise = float(ndtr(-PROUD_STDS)) * float(seen[..., tip].sum())
        profile = filled[:, side.index, grid.toothed].mean(axis=1)
        line = np.polynomial.polynomial.polyfit(below, profile[:, below].T, 1)
        excess = profile[:, tip] - np.polynomial.polynomial.polyval(tip, line)
        volume = (excess * sheets.area[tip]).sum(axis=1) * int(grid.toothed.sum())
        scatter = float(volume.std(ddof=1))
        enough = -float(np.sqrt(len(volume))) * float(volume.mean()) / max(scatter, 1e-300)
        lifted = pdtrc(max(float(proud.sum()) - 1.0, 0.0), by_noise) < CHANCE or _points_proud(sheets, cells, noise, side, tip)
        if not lifted or ndtr(enough) > CHANCE:
            continue
        deviation[:, side.index][..., tip] -= excess[:, None, :]
        std[side.index] = scatter
        burrs.append(TipBurr(side, float(volume.sum()), scatter * float(np.sqrt(len(volume)))))
    return replace(sheets, deviation=deviation), tuple(burrs), std


def _points_proud(sheets: SideMaps, cells: Cells, noise: float, side: Side, tip: Ints) -> bool:
    """Whether more cells at the tip of a side have a point proud of the as-made gear than their number of points lets expect."""
    if cells.highest is None:
        return False
    points = cells.grid.sides(cells.count)[..., sheets.fillet :]
    top = cells.grid.sides(cells.points.deviation + cells.highest)[..., sheets.fillet :]
    proud = (top > PROUD_STDS * noise) & (points > 0.0)
    at_tip = np.zeros(points.shape, dtype=bool)
    at_tip[:, side.index][..., tip - sheets.fillet] = True
    share = max(float(ndtr(-PROUD_STDS)), float(proud[~at_tip].sum()) / max(float(points[~at_tip].sum()), 1.0))
    return bool(pdtrc(max(float(proud[at_tip].sum()) - 1.0, 0.0), share * float(points[at_tip].sum())) < CHANCE)


def _columns(sheets: SideMaps, grid: CellGrid) -> tuple[Ints, Ints]:
    """Columns that a burr may reach, and those below them."""
    end, step = sheets.deviation.shape[3], grid.size / grid.gear.transverse_module
    width = max(1, int(np.ceil(WIDTH / step - 0.5)))
    reach = max(width + 3, round(BELOW / step))
    return np.arange(end - width, end), np.arange(max(end - reach, sheets.fillet + 1), end - width)

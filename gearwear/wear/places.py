"""Where on the flanks metal is missing: the cells that stand out of the scan's own scatter, and what may be summed with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import SideMaps, between, infill, make_side_maps, rim, window_mean, worn_cells
from gearwear.robust import median_scale
from gearwear.wear.burr import TipBurr, without_burrs
from gearwear.wear.edges import at_ends_only, end_zone, seen_places, seen_sides, shared_edges, within_ends
from gearwear.wear.own_level import at_own_level, standing_proud
from gearwear.wear.ridge import PitchRidge, worn_level
from gearwear.wear.volume import FEWEST_PLACEBOS

RIM = 0.2
"""Width, in modules, of the rim that is summed with a region: its mask follows the noise, and a wide rim gives back what that picked."""
HOLLOW = 10.0
"""By how many standard deviations a flank's deepest place lies further below its level than usual where it stands out whatever that level is. The least
of many scatters with a long tail: at 10 chance makes one of some 10⁴ flanks of 12 teeth, and one of 500 of three teeth (normal scatter, counted)."""


@dataclass(frozen=True, slots=True)
class LaidFlat:
    """Tooth sides as wear is looked for on them: within their ends, without burrs, each at the level it was made at.

    Parameters
    ----------
    cells : Cells
    sheets : SideMaps
        The same, laid flat.
    filled : (teeth, 2, rows, columns) float
        The same with the unseen cells filled, mm.
    burrs : tuple of TipBurr
        What was taken off.
    burr_std : (2,) float
        What that leaves uncertain of a flank's volume, by side, mm³.
    proud : (float, float)
        What left and right flanks were lowered by, mm (`standing_proud`), without a ridge.
    level_open : (float, float)
        By how much less and by how much more that may be, mm, as there may be a ridge (`worn_level`).
    ridges : tuple of PitchRidge
        What was taken off besides, as far as it stands above that.
    perhaps : float
        What flanks that were raised would have lost were that wear, mm³ (`at_own_level`).
    """

    cells: Cells
    sheets: SideMaps
    filled: Floats
    burrs: tuple[TipBurr, ...]
    burr_std: Floats
    proud: tuple[float, float]
    level_open: tuple[float, float]
    ridges: tuple[PitchRidge, ...]
    perhaps: float


def lay_flat(cells: Cells, noise: float, loop: Loop | None, worn: frozenset[Side]) -> LaidFlat:
    """Tooth sides as wear is looked for on them; arguments as those of `regions.find_wear`."""
    cells, perhaps = at_own_level(within_ends(cells, noise, loop), noise, loop, worn)
    with_burrs = make_side_maps(cells)
    filled = infill(with_burrs)
    sheets, burrs, burr_std = without_burrs(with_burrs, filled, cells, noise, worn)
    if burrs:
        filled = infill(sheets)
        taken = cells.grid.on_cells(np.nan_to_num(sheets.deviation - with_burrs.deviation))
        cells = cells.with_deviation(cells.points.deviation + taken)
    proud, level = standing_proud(sheets, loop, worn), None
    if loop is not None and any(proud):  # of one side at most
        (side,) = worn
        level = worn_level(sheets, cells.grid, loop, side, proud[side.index])
        proud = (level.height, 0.0) if side is Side.LEFT else (0.0, level.height)
        raised = np.zeros((len(Side), *sheets.count.shape[2:]))
        raised[side.index] = level.height
        raised[side.index, :, sheets.fillet :] += level.proud
        cells = cells.with_deviation(cells.points.deviation - cells.grid.on_cells(np.broadcast_to(raised, sheets.count.shape)))
        sheets = make_side_maps(cells)
        filled = infill(sheets)
    return LaidFlat(
        cells=cells, sheets=sheets, filled=filled, burrs=burrs, burr_std=burr_std, proud=proud,
        level_open=(0.0, 0.0) if level is None else (level.height - level.low, level.high - level.height),
        ridges=() if level is None or level.ridge is None else (level.ridge,), perhaps=perhaps,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class StandingOut:
    """Cells that stand out, before it is asked whether what they lack is more than chance.

    Parameters
    ----------
    mask, wide, allowed : (teeth, 2, rows, columns) bool
        The cells; with the rim that is summed with them; what may be summed at all.
    at_ends : (teeth, 2, rows, columns) bool
        Cells that stand out on flanks where these are next to an end alone: no wear.
    edges : (teeth, 2) bool
        Those flanks.
    edge_depth : float
        Depth of the deepest of those cells, mm.
    pitted : (teeth, 2) bool
        Flanks where more points lie far below than strays can.
    by_level : (teeth, 2) bool
        Flanks known to be worn all over by their level.
    hollowed : (teeth, 2) bool
        Flanks whose deepest place stands out of their own level (`hollowed_sides`).
    beyond : (teeth, 2, rows, columns) float
        Area of what is low past the edge of what was seen on any flank, mm².
    spread, limit : float
        As of `regions.Wear`, mm.
    around : int
        Width of the rim, cells.
    """

    mask: Bools
    wide: Bools
    allowed: Bools
    at_ends: Bools
    edges: Bools
    edge_depth: float
    pitted: Bools
    by_level: Bools
    hollowed: Bools
    beyond: Floats
    spread: float
    limit: float
    around: int


def standing_out(laid: LaidFlat, noise: float, loop: Loop | None, worn: frozenset[Side], gone: Bools) -> StandingOut:
    """The cells that stand out; arguments as those of `regions.find_wear`."""
    cells, sheets, filled = laid.cells, laid.sheets, laid.filled
    gear, grid = cells.grid.gear, cells.grid
    local, number = window_mean(sheets)
    mask, spread, limit = worn_cells(local, number, noise)
    pits: Bools = np.zeros_like(mask) if cells.far is None else grid.sides(cells.far.hung)
    mask |= between(pits, sheets.fillet)
    mask &= ~gone
    zone = end_zone(sheets, cells)
    edges = at_ends_only(mask, zone)
    corners: Bools = np.zeros_like(zone)
    for side in worn if len(worn) == 1 else ():  # of both sides nothing tells what was made from what was lost
        corners[side.index] = shared_edges(sheets, zone, gear.transverse_module, noise)[side.index]
    on_edges = edges[:, :, None, None]
    at_ends = mask & on_edges
    mask &= ~on_edges
    by_level = np.zeros(edges.shape, dtype=np.bool_) if loop is None or loop.worn_flanks is None else loop.worn_flanks
    whole = by_level.copy()
    whole[:, [side.index for side in worn]] = True
    mask[whole, :, sheets.fillet :] = True
    mask &= seen_sides(sheets)[:, :, None, None]  # a fillet that was seen alone says nothing of its flank
    on_gear = grid.toothed[:, None] & ~corners & ~gone
    known = seen_places(grid.sides(cells.count), sheets.fillet)
    beyond = ((on_gear & ~known & (filled < -limit)) * sheets.area)[..., sheets.fillet :]
    allowed = on_gear & known
    mask &= allowed
    around = max(1, round(RIM * gear.transverse_module / grid.size))
    return StandingOut(
        mask=mask, wide=rim(mask, around) & allowed, allowed=allowed, at_ends=at_ends, edges=edges,
        edge_depth=-float(filled[at_ends].min(initial=0.0)), pitted=np.asarray(pits.any(axis=(2, 3))), by_level=by_level,
        hollowed=hollowed_sides(local[..., sheets.fillet :]), beyond=beyond, spread=spread, limit=limit, around=around,
    )  # fmt: skip


def hollowed_sides(local: Floats) -> Bools:
    """Sides with a place that stands out of their own level.

    Parameters
    ----------
    local : (teeth, 2, rows, columns) float
        Means over 3 × 3 cells of flanks, mm; nan where nothing was seen.

    Returns
    -------
    (teeth, 2) bool
        Whether the least of the side lies further below its median than on other sides, by `HOLLOW`; nowhere with fewer than `FEWEST_PLACEBOS` others.

    Notes
    -----
    By pitch and thickness flanks stand at levels of their own. Where these scatter by as much as a hollow has volume, its volume stands out of nothing,
    but its depth does. All sides are asked for their least, so that the choice of a place is in the comparison; medians, as others may be hollow too.
    """
    known = np.isfinite(local).any(axis=(2, 3))
    deeper = np.full(known.shape, np.nan)
    deeper[known] = np.nanmedian(local[known], axis=(1, 2)) - np.nanmin(local[known], axis=(1, 2))
    usual, scatter = median_scale(deeper)
    return np.asarray((known.sum() > FEWEST_PLACEBOS) & (np.nan_to_num(deeper) > usual + HOLLOW * scatter))

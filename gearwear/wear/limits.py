"""From what depth on wear of a flank would have been found, flank by flank.

Wear is reported where a mean over 3 × 3 cells stands out of the scatter, and its volume is five times its own standard deviation. Both
chances are worked out for a patch of even depth anywhere on the flank: the scatter of the means from the flank's own density, the standard
deviation of the volume from noise, texture, pose and effects as for a region that was found. The limit is the depth at which both hold in
`FOUND` of such patches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from gearwear.arrays import Bools, Floats
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.flank_columns import wear_columns
from gearwear.diagnose.found import Loop
from gearwear.diagnose.gram import Gram
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.side_maps import SideMaps, own_spread, window_mean
from gearwear.wear.own_level import strip_means, typical_heights
from gearwear.wear.ridge import pitch_level
from gearwear.wear.uncertainty import model_columns, noise_covariance, region_weights

FOUND = 0.965
"""Share of patches of the depth stated that are found."""
PATCH = 6
"""Edge of the patch, in cells: about where neither of the two chances rules alone."""
BEST_OF, BEST_STD = 1.28, 0.72
"""By how much the deepest of the means over 3 × 3 cells of a patch lies below its depth, and how much that scatters, in standard deviations of one
mean by the noise of its points: simulated, for a patch that lies anyhow to the cells. Texture is alike all over the patch."""
SEEN = 0.5
"""Share of a flank that must be seen for anything to be said of it."""
DEEPEST = 0.1
"""Limit, in modules, above which a flank is too thin to say anything."""
FEWEST_SIDES = 3
"""Sides without wear from which on they say something."""
FAINT = 1.5
"""Standard deviations from which on means over 3 × 3 cells are counted as perhaps worn, at which half of the faintest wear is counted and nearly all
of what is nearly found."""
PLACES = np.linspace(0.05, 0.95, 10)
"""Quantiles of the density on a flank."""


@dataclass(frozen=True, slots=True)
class FlankLimit:
    """What could have been seen of the wear of one flank.

    Parameters
    ----------
    tooth : int
        0-based.
    side : Side
    depth : float
        Mean depth of a patch that would have been found, mm; NaN where too little of the flank was seen to say so.
    area : float
        Area of that patch, mm² (on a planar section its length, mm).
    seen : float
        Share of the flank that was seen.
    """

    tooth: int
    side: Side
    depth: float
    area: float
    seen: float

    @property
    def says(self) -> bool:
        """Whether anything can be said of this flank."""
        return math.isfinite(self.depth)


def flank_limits(
    cells: Cells,
    sheets: SideMaps,
    mask: Bools,
    noise: float,
    spread: float,
    limit: float,
    least: float,
    rim: int,
    loop: Loop | None,
    gone: Bools,
) -> tuple[FlankLimit, ...]:
    """Limits of all flanks.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    sheets : SideMaps
        The same, laid flat.
    mask : (teeth, 2, rows, columns) bool
        Worn cells.
    noise : float
        Scatter of points, mm.
    spread, limit : float
        Of means over 3 × 3 cells: their standard deviation, and the depth from which they are taken for wear, mm.
    least : float
        Volume, in its standard deviations, from which a region is reported.
    rim : int
        Cells round a region that are summed with it.
    loop : Loop or None
        Where the as-made gear comes from.
    gone : (teeth, 2, rows, columns) bool
        Cells that are broken off: of a flank what is left of it counts.
    """
    _, number = window_mean(sheets)
    rows, first = sheets.count.shape[2], sheets.fillet
    level = (0.0, 0.0) if loop is None else loop.level_std
    left = ~gone[..., first:] & cells.grid.toothed[:, None]
    seen = (sheets.seen[..., first:] & left).sum(axis=(2, 3)) / np.maximum(left.sum(axis=(2, 3)), 1)
    gear = cells.grid.gear
    white = noise / math.sqrt(max(float(np.median(number[number > 0.5])), 1.0)) if (number > 0.5).any() else 0.0
    beyond = _beyond_noise(cells, sheets, noise, loop, rim)
    scatter, shared = _placebo(cells.grid, sheets, mask, rim)
    result = []
    for tooth, half in np.ndindex(seen.shape):
        edge = max(PATCH, 3 * int(sheets.merged[tooth, half]))
        high, wide = min(edge, rows), min(edge, sheets.count.shape[3] - first)
        area = high * wide * float(sheets.area[-1])
        depth = math.nan
        if seen[tooth, half] >= SEEN and math.isfinite(spread) and spread > 0.0:
            density = np.quantile(number[tooth, half, :, first:][left[tooth, half]], PLACES)
            cell_std = own_spread(density, noise, spread, white)
            # Cells of a region: where half of a mean lies on the patch it is just what a region grows over; and the rim.
            cells_in = min(high + 2 * rim, rows) * min(wide + 2 * rim, sheets.count.shape[3])
            count = np.maximum(density / min(9.0, 3.0 * rows), 1e-3)
            known = noise**2 / count / cells_in + beyond[half]
            volume = np.sqrt(np.maximum(known, scatter) + shared) * cells_in * float(sheets.area[-1])
            by_noise = noise / np.sqrt(np.maximum(density, 1e-3))
            depth = _depth(limit / spread, cell_std, np.minimum(by_noise, cell_std), volume / area, least, level[half])
        if not depth < DEEPEST * gear.transverse_module:
            depth = math.nan
        result.append(FlankLimit(tooth, tuple(Side)[half], depth, area, float(seen[tooth, half])))
    return tuple(result)


def faint_wear(sheets: SideMaps, looked_at: Bools, noise: float, spread: float) -> float:
    """What wear too faint to be found may come to in all, at most (95 %), mm³.

    Parameters
    ----------
    sheets : SideMaps
        Deviations from the as-made gear.
    looked_at : (teeth, 2, rows, columns) bool
        Cells outside the regions found.
    noise, spread : float
        Scatter of points, and of means over 3 × 3 cells where there is no wear, mm.

    Notes
    -----
    Scatter goes up as often as down, wear goes down alone: it is what cells low by `FAINT` standard deviations of their means lack, less what cells as
    high have too much. Side by side that differs by chance and by wear: the squares of all sides add up to its variance.
    """
    local, number = window_mean(sheets)
    known = np.isfinite(local) & sheets.seen & looked_at
    if not known.any() or not spread > 0.0:
        return 0.0
    white = noise / math.sqrt(float(np.median(number[known])))
    score = np.where(known, local, 0.0) / own_spread(number, noise, spread, white)
    missing = np.where(np.abs(score) > FAINT, -np.nan_to_num(sheets.deviation) * sheets.area, 0.0).sum(axis=(2, 3))
    return max(float(missing.sum()) + NORMAL_95 * math.sqrt(float((missing**2).sum())), 0.0)


def faint_sides(cells: Cells, noise: float, loop: Loop, found: Bools, area: Floats) -> float:
    """What sides that seem to have lost by sliding, but may as well be made so, would have lost in all, at most (95 %), mm³.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    noise : float
        Scatter of points, mm.
    loop : Loop
        Where the as-made gear comes from; sides it takes for worn throughout are not asked of.
    found : (teeth, 2, rows, columns) bool
        Cells whose wear is found, and those round them.
    area : (columns,) float
        Of a cell, mm².

    Notes
    -----
    Spread over all flanks of a side, wear of a hundredth of what would stand out on one of them adds up to as much as a patch. So each side is asked
    how much it has lost by sliding, and in proportion to the way from the pitch point, whichever may be more. Beside the columns X of pose and
    effects, with the weights W of the fit, a loss of the shape ℓ has the amplitude gᵀ d and the variance gᵀ Σ g,

        g = W p / ℓᵀ W p,   p = ℓ − X (XᵀWX)⁻¹ XᵀW ℓ,

    and to it what effects trusted too far, or too small to be found, leave along g. What is no more than chance (95 %) is none; sides err by themselves.
    """
    known = loop.covariance
    covariance = CellCovariance(
        cells.grid, noise**2 / np.maximum(cells.count, 1.0), known.texture, known.row_step, known.column_step
    )
    weight = np.where(loop.use & cells.seen & ~cells.grid.on_cells(found), covariance.weight, 0.0)
    columns, fields = model_columns(cells, loop)
    form = fields if loop.hidden is None else np.hstack([fields, loop.hidden])
    _, inverse = Gram.of(columns, np.zeros(len(weight)), weight, np.zeros(len(weight), np.int64), 1).solve(
        np.arange(columns.shape[1])
    )
    deviation = np.where(cells.seen, np.nan_to_num(cells.points.deviation), 0.0)
    areas = cells.grid.on_cells(np.broadcast_to(area, found.shape))
    lost = square = 0.0
    for side in set(Side) - loop.worn_sides:
        sliding, below, above = wear_columns(cells, loop.context, frozenset({side}))[0].T
        limits = []
        for shape in (sliding, below + above):
            own = weight * (shape - columns @ (inverse @ (columns.T @ (weight * shape))))
            response = float(own @ shape)
            if response <= 0.0:
                continue
            volume = -float(shape @ areas) / response
            variance = float(own @ covariance.apply(own[:, None])[:, 0]) + float(((own @ form) ** 2).sum())
            value, std = volume * float(own @ deviation), abs(volume) * math.sqrt(variance)
            if value > NORMAL_95 * std:
                limits.append((value, std))
        value, std = max(limits, key=lambda limit: limit[0] + NORMAL_95 * limit[1], default=(0.0, 0.0))
        lost, square = lost + value, square + std**2
    return lost + NORMAL_95 * math.sqrt(square)


def upper_limit(volumes: Floats, covariance: Floats, which: Bools) -> float:
    """What some flanks may have lost in all, at most (95 %), mm³; 0 where that is less than nothing.

    Parameters
    ----------
    volumes, covariance : (k,), (k, k) float
        What flanks seem to have lost, mm³, and the covariance of that, mm⁶.
    which : (k,) bool
        The flanks to be summed.
    """
    std = math.sqrt(max(float(covariance[np.ix_(which, which)].sum()), 0.0))
    return max(float(volumes[which].sum()) + NORMAL_95 * std, 0.0)


def common_loss(sheets: SideMaps, shared: Floats, toothed: Bools, worn: frozenset[Side]) -> float:
    """What the flanks of sides that count as made so would have lost were what no effect explains of them wear, mm³.

    Parameters
    ----------
    sheets : SideMaps
        Of the scan.
    shared : (teeth, 2, rows, columns) float
        Deviation that all teeth have in common and no effect explains, mm.
    toothed : (rows,) bool
        Rows that have teeth; those of a groove have none.
    worn : frozenset of Side
        Sides whose wear is in the volume already.

    Notes
    -----
    A form that every tooth has may be cut or worn, the scan alone cannot tell. Were it worn, nothing would be missing where it is highest.
    """
    flank = np.nan_to_num(shared[..., sheets.fillet :])
    lost = flank.max(axis=(2, 3), keepdims=True) - flank
    lost[:, [side.index for side in worn]] = 0.0
    lost[:, :, ~toothed] = 0.0
    return float((lost * sheets.area[sheets.fillet :]).sum())


def even_part(sheets: SideMaps, worn: frozenset[Side], grid: CellGrid, loop: Loop) -> float:
    """What the flanks of sides worn throughout have lost all over alike, mm³: as teeth cut thinner have on both sides. Parameters as of `even_depth`, of
    several sides."""
    lost = 0.0
    for side in worn:
        seen = int(_of_side(sheets, side, grid.toothed)[1].sum())
        lost += even_depth(sheets, side, grid, loop) * seen * int(grid.toothed.sum()) * sheets.flank_row
    return lost


def even_depth(sheets: SideMaps, side: Side, grid: CellGrid, loop: Loop) -> float:
    """How much the flanks of a side worn throughout have lost all over alike, mm.

    Parameters
    ----------
    sheets : SideMaps
        Deviations from the as-made gear.
    side : Side
    grid : CellGrid
    loop : Loop
        Where the as-made gear comes from.

    Notes
    -----
    Nothing slides at the pitch point, and what slides leaves the face where nothing carries: a place that lost nothing by sliding there is on every
    flank. How low even that lies tells the profile as it goes on to the pitch point (`pitch_level`), for a column next to it has slid and a single cell is
    high by chance; or the highest strip over the face or up the profile, in the median of the teeth, where that is higher. Below 1.96 standard deviations it
    is none.
    """
    flank, seen = _of_side(sheets, side, grid.toothed)
    typical = typical_heights(flank[seen]) if seen.any() else np.full(flank.shape[1:], np.nan)
    strips = np.concatenate([means[often] for means, often in (strip_means(typical, axis) for axis in (0, 1))])
    if not len(strips):
        return 0.0
    std, highest = loop.as_made_std[side.index], float(strips.max())
    level = pitch_level(typical, grid, loop, side)
    if level is not None and level[0] > highest:
        highest, std = level[0], math.hypot(std, level[1])
    return -highest if -highest > NORMAL_95 * std else 0.0


def _of_side(sheets: SideMaps, side: Side, toothed: Bools) -> tuple[Floats, Bools]:
    """Deviations of the flanks of a side, (teeth, rows, columns) mm, nan where not seen, and which of them were seen, (teeth,)."""
    flank = np.where(sheets.seen, sheets.deviation, np.nan)[:, side.index, toothed, sheets.fillet :]
    return flank, np.asarray(np.isfinite(flank).any(axis=(1, 2)))


def _depth(seed: float, cell_std: Floats, by_noise: Floats, volume: Floats, least: float, level: float) -> float:
    """Depth at which `FOUND` of the patches pass both tests, over places of different scatter (`by_noise` that of their points alone), mm; by
    halving."""
    low, high = 0.0, 100.0 * float((cell_std + volume).max()) + 10.0 * level
    scatter = np.sqrt((BEST_STD * by_noise) ** 2 + cell_std**2 - by_noise**2 + level**2)
    for _ in range(60):
        depth = 0.5 * (low + high)
        stands_out = ndtr((depth + BEST_OF * by_noise - seed * cell_std) / scatter)
        is_sure = ndtr((depth - least * volume) / np.hypot(volume, level))
        low, high = (depth, high) if float((stands_out * is_sure).mean()) < FOUND else (low, depth)
    return high


def _reference(grid: CellGrid, sheets: SideMaps, rim: int) -> Bools:
    """(rows, columns) cells that a patch in the middle of a flank and its surroundings take; of the lower half of a double helical gear."""
    rows, columns = grid.zones[0][0], sheets.count.shape[3]
    edge = PATCH + 2 * rim
    beside, left = max((rows.stop - rows.start - edge) // 2, 0), max((sheets.fillet + columns) // 2 - edge // 2, 0)
    result = np.zeros(sheets.count.shape[2:], dtype=bool)
    result[rows.start + beside : rows.stop - beside, left : left + edge] = True
    return result


def _beyond_noise(cells: Cells, sheets: SideMaps, noise: float, loop: Loop | None, rim: int) -> tuple[float, float]:
    """Variance of the mean depth of a region by texture, pose and effects, mm², on a typical left and right flank."""
    if loop is None:
        return 0.0, 0.0
    total, square = ((sheets.count[..., sheets.fillet :] ** power).sum(axis=(2, 3)) for power in (1, 2))
    region = _reference(cells.grid, sheets, rim)
    regions = np.zeros((2, *sheets.count.shape), dtype=bool)
    for half in range(2):
        typical = int(
            np.lexsort((square[:, half], total[:, half]))[len(total) // 2]
        )  # of two alike not the one with the lower number
        regions[half, typical, half] = region
    weights = region_weights(sheets, regions)
    known = np.diag(noise_covariance(cells, noise, loop, weights))
    alone = np.diag(noise_covariance(cells, noise, None, weights))
    size = (region * sheets.area).sum() ** 2
    left, right = np.maximum(known - alone, 0.0) / size
    return float(left), float(right)


def _placebo(grid: CellGrid, sheets: SideMaps, mask: Bools, rim: int) -> tuple[float, float]:
    """Variance of the mean over a region from side to side without wear, and the square of its mean, mm²: what the as-made gear does not know."""
    sound = ~mask.any(axis=(2, 3)) & (sheets.seen[:, :, grid.toothed].mean(axis=(2, 3)) > SEEN)
    if sound.sum() < FEWEST_SIDES:
        return 0.0, 0.0
    region = _reference(grid, sheets, rim) & (sheets.seen[sound].any(axis=0))
    inside = np.where(sheets.seen, sheets.deviation, 0.0)[sound][:, region]
    means = inside.sum(axis=1) / np.maximum(sheets.seen[sound][:, region].sum(axis=1), 1)
    return float(means.var()), float(means.mean()) ** 2

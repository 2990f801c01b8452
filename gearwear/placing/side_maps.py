"""Tooth sides laid flat: fillet and flank of every side as one map of cells, root to tip."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from statistics import NormalDist

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK
from gearwear.design.twist import normal_lean
from gearwear.placing.cells import CellGrid, Cells
from gearwear.robust import scale_about

FALSE_ALARM = 0.01
"""Chance that a gear without wear shows any region, for normal scatter."""
LEAST_SHARE = 0.25
"""Cells with less than this share of the number usual on their side are taken as unseen: a stray alone in a cell cannot be told."""
THIN = 1.5
"""Points a cell from which down the cells of a side are merged."""
ENOUGH = 4.0
"""Points that merged cells shall hold together."""
FEWEST_BLOCKS = 3
"""Blocks of merged cells along each way of a flank, at least."""
LEAN_STEPS = 8
"""Steps of an arc of the root over which the lean of its normals is averaged."""
RING_CELLS = 2
"""Cells round a hole that say what is in it."""
CROSS = ndimage.generate_binary_structure(2, 1)
"""What is beside a cell."""
AROUND = np.pad(np.ones((1, 1, 3, 3), dtype=bool), ((1, 1), (1, 1), (0, 0), (0, 0)))
"""The cells round one on the same side."""
HOLES_AT_A_TIME = 4096
"""Holes of one form that are filled together."""
NEAR_EDGE = 2
"""Cells from an edge of the flank within which pits are taken to go on to it."""
GROWTH_LIMIT_STDS = 2.5
"""A region grows over neighbours below this many standard deviations."""


@dataclass(frozen=True, slots=True)
class SideMaps:
    """Mean deviations of all tooth sides, cell by cell.

    Parameters
    ----------
    deviation : (teeth, 2, rows, columns) float
        mm, + is too much material; nan where nothing was seen. Side 0 is left, 1 right. Columns run from the root to the
        tip: first the fillet's, then the flank's.
    count : same shape
        Points in the cell.
    position : (teeth, 2, rows, columns, 3) float
        Mean foot of the cell, mm.
    area : (columns,) float
        Area of a cell in mm²: Σ (missing depth × area) is the removed volume (see Notes).
    fillet : int
        Number of fillet columns.
    offset : (2, teeth, 2, rows, columns) float
        How far the points of a cell lie from its centre on average, along z and along the profile, in cells; nan where nothing was seen.
    torn : (teeth, 2, rows, columns) float
        Standard deviation of the points of a cell about their mean, mm; nan below 2 points.
    points : (teeth, 2, rows, columns) float
        Points in the cell itself; `count` is the mean over the cells it is merged with.
    merged : (teeth, 2) int
        Cells that are merged along each way, where a side is thinner than the cells were made for; else 1.

    Notes
    -----
    On the involute the angle lost at radius r is d / r_b with d the plumb-line depth, so the removed volume is
    ``∫∫ d / r_b · r dr dz`` with r the **measured** point's radius. Columns are equal in r², hence of equal weight
    Δ(r²) Δz / (2 r_b): exact for any depth (the curvature term of foot-point coordinates is in it). On the fillet the weight is arc × Δz,
    first order in depth / radius of curvature. Where normals lean out of the section (helical teeth: β_b on flanks, γ on fillets), a depth in
    space is 1/cos of it in the section, and so is the weight.
    """

    deviation: Floats
    count: Floats
    position: Floats
    area: Floats
    fillet: int
    offset: Floats
    torn: Floats
    points: Floats = field(default_factory=lambda: np.ones((1, 1, 1, 1)))
    merged: Ints = field(default_factory=lambda: np.ones((1, 1), dtype=np.int64))

    @property
    def seen(self) -> Bools:
        return self.count > 0

    @property
    def flank_row(self) -> float:
        """Area of one row of a flank's cells, without the fillet's, mm²."""
        return float(self.area[self.fillet :].sum())


def make_side_maps(cells: Cells) -> SideMaps:
    """Lay the side cells of a binned scan flat."""
    grid, gear = cells.grid, cells.grid.gear

    position = np.stack([grid.sides(cells.points.position[:, axis]) for axis in range(3)], axis=-1)
    height = grid.row_height if grid.rows > 1 else 1.0  # a planar section: mm² per mm of height
    radius = grid.fillet_radius
    phi = gear.fillet_phi(radius)
    r, angle = gear.root_curve.polar(phi)
    arcs = np.hypot(np.diff(r), 0.5 * (r[1:] + r[:-1]) * np.diff(angle))
    flank = abs(gear.tip_roll**2 - gear.form_roll**2) / (2.0 * gear.base_radius * grid.flank) / gear.base_helix_cosine
    arcs = arcs * _leaning(gear, phi)
    area = height * np.concatenate([arcs, np.full(grid.flank, flank)])
    deviation, count = grid.sides(cells.points.deviation), grid.sides(cells.count)
    least = np.maximum(2.0, LEAST_SHARE * _usual(count))
    if cells.far is not None:
        # Where pits are known to be, a lone point is no stray, and what lies round it says little of its cell.
        least = np.where(grid.sides(cells.far.hung).any(axis=(2, 3), keepdims=True), np.minimum(least, 1.0), least)
    sparse = count < least
    merged = _to_merge(count, grid)
    offset, torn = cell_offsets(cells), grid.sides(cells.scatter)
    points, known = count, np.where(sparse, np.nan, deviation)
    sheets = SideMaps(
        deviation=_at_centres(known, offset, grid),
        count=np.where(sparse, 0.0, count),
        position=position,
        area=area,
        fillet=grid.fillet,
        offset=offset,
        torn=torn,
        points=np.where(sparse, 0.0, points),
        merged=merged,
    )
    for tooth, half in np.argwhere(merged > 1):
        _merge(sheets, int(tooth), int(half), deviation[tooth, half], count[tooth, half])
    return sheets


def _leaning(gear: Gear, phi: Floats) -> Floats:
    """Mean of 1 / cos γ over the arcs of the root between rack angles `phi` (n + 1,), (n,); 1 for spur gears."""
    nodes = np.linspace(phi[:-1], phi[1:], LEAN_STEPS + 1)
    radius, angle = gear.root_curve.polar(nodes)
    arc = np.hypot(np.diff(radius, axis=0), radius[1:] * np.diff(angle, axis=0))
    cosine = normal_lean(gear, gear.root_curve.lever(0.5 * (nodes[1:] + nodes[:-1])))[0]
    return np.asarray((arc / cosine).sum(axis=0) / arc.sum(axis=0), dtype=np.float64)


def _usual(count: Floats) -> Floats:
    """(teeth, 2, 1, 1) median number of points in the cells of a side that hold any; 0 without."""
    result = np.zeros((*count.shape[:2], 1, 1))
    for side in np.ndindex(count.shape[:2]):
        filled = count[side][count[side] > 0]
        result[side] = float(np.median(filled)) if len(filled) else 0.0
    return result


def _to_merge(count: Floats, grid: CellGrid) -> Ints:
    """`SideMaps.merged`: as many cells as hold `ENOUGH` points on average over what was seen."""
    result = np.ones(count.shape[:2], dtype=np.int64)
    if grid.rows == 1:
        return result
    flank = count[..., grid.fillet :]
    near = ndimage.maximum_filter(flank > 0, (1, 1, 5, 5)).sum(axis=(2, 3))
    density = flank.sum(axis=(2, 3)) / np.maximum(near, 1)
    most = max(min(grid.rows, grid.flank) // FEWEST_BLOCKS, 1)
    thin = (density > 0.0) & (density < THIN)
    result[thin] = np.clip(np.ceil(np.sqrt(ENOUGH / density[thin])), 1, most).astype(np.int64)
    return result


def _merge(sheets: SideMaps, tooth: int, half: int, deviation: Floats, count: Floats) -> None:
    """Give the cells of a thin side the mean of their block, in place: its weighted sum over a block is as uncertain as that of its points."""
    side, size = (tooth, half), int(sheets.merged[tooth, half])
    block, inside = _blocks(size, count.shape, sheets.fillet)
    total = np.bincount(block.ravel(), count.ravel())

    def mean(values: Floats) -> Floats:
        weighted = np.where(count > 0, np.nan_to_num(values) * count, 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray((np.bincount(block.ravel(), weighted.ravel()) / total)[block], dtype=np.float64)

    number = np.bincount(block.ravel())[block]
    few = total[block] < 2.0
    middle = mean(deviation)
    scatter = mean(
        (deviation - middle) ** 2 + np.nan_to_num(sheets.torn[side]) ** 2 * np.maximum(count - 1.0, 0.0) / np.maximum(count, 1.0)
    )
    sheets.deviation[side] = np.where(few, np.nan, middle)
    sheets.count[side] = np.where(few, 0.0, total[block] / number)
    sheets.points[side] = np.where(few, 0.0, count)
    with np.errstate(invalid="ignore", divide="ignore"):
        sheets.torn[side] = np.where(few, np.nan, np.sqrt(scatter * total[block] / np.maximum(total[block] - 1.0, 1.0)))
    for axis in range(3):
        sheets.position[(*side, ..., axis)] = mean(sheets.position[(*side, ..., axis)])
    for axis in range(2):
        # Where the points of the block lie off its middle, in blocks.
        off = mean(sheets.offset[(axis, *side)] + inside[axis]) / size
        sheets.offset[(axis, *side)] = np.where(few, np.nan, np.clip(off, -0.5, 0.5))


def _blocks(size: int, shape: tuple[int, ...], fillet: int) -> tuple[Ints, Floats]:
    """(rows, columns) number of each cell's block, and (2, rows, columns) how many cells it lies off the block's middle."""
    ways, start = [], 0
    for length in (shape[0], fillet, shape[1] - fillet):
        ways.append(in_blocks(length, max(length // size, 1)) + start)
        start = ways[-1][-1] + 1 if len(ways) == 2 else 0  # the flank's columns go on from the fillet's
    row, column = ways[0], np.concatenate(ways[1:])
    block = row[:, None] * (column[-1] + 1) + column
    centres = [np.bincount(way, np.arange(len(way))) / np.bincount(way) for way in (row, column)]
    off = [np.arange(len(way)) - centre[way] for way, centre in zip((row, column), centres, strict=True)]
    return block, np.stack(np.broadcast_arrays(off[0][:, None], off[1]))


def in_blocks(length: int, number: int) -> Ints:
    """(length,) block of each of a row of cells, about evenly filled, and the same from either end: an odd row has an odd number of them."""
    number -= (number + 1) % 2 * (length % 2) if number > 1 else 0
    lower = (2 * np.arange(length // 2) + 1) * number // (2 * length)
    middle = [(number - 1) // 2] * (length % 2)
    return np.concatenate([lower, middle, number - 1 - lower[::-1]]).astype(np.int64)


def cell_offsets(cells: Cells) -> Floats:
    """How far the points of each cell lie from its centre on average, along z and along the profile, in cells, (2, teeth, 2, rows, columns); nan
    without points."""
    grid, gear = cells.grid, cells.grid.gear
    # In columns: equal steps of r² on the flank, of arc on the fillet.
    foot = np.hypot(cells.points.position[:, 0], cells.points.position[:, 1])
    at_point = cells.points.own_roll(gear) ** 2
    on_flank = grid.fillet + (at_point - gear.form_roll**2) / (gear.tip_roll**2 - gear.form_roll**2) * grid.flank
    on_fillet = grid.fillet_place(foot)
    column, z = grid.sides(np.where(cells.points.surface == FLANK, on_flank, on_fillet)), grid.sides(cells.points.own_height)
    along = grid.place_of(z) - (np.arange(grid.rows) + 0.5)[:, None]
    across = column - (np.arange(grid.fillet + grid.flank) + 0.5)
    # The square of the mean L is less than the mean of L², by which columns are equal: by a 40th of a column near the form circle.
    edges = grid.roll_edges
    square = np.diff(edges**2)
    across[..., grid.fillet :] += (0.5 * (edges[1:] ** 2 + edges[:-1] ** 2) - (np.diff(edges**3) / square / 1.5) ** 2) / square
    # Points that a radial error carried over a cell's edge were counted in it all the same: their mean stays inside.
    return np.asarray(np.clip(np.stack([along, across]), -0.5, 0.5), dtype=np.float64)


def _at_centres(deviation: Floats, offset: Floats, grid: CellGrid) -> Floats:
    """Cell means taken from where their points lie on average to the cells' centres.

    On a coarse regular lattice the points of a cell are not spread evenly over it; without this the sum over cells would
    carry a moiré of lattice and cells (1 % of a volume seen on a triangle export of 6 points a cell).
    """
    result = deviation.copy()
    rows, columns = (np.arange(number) for number in deviation.shape[2:])
    for axis, off, centre in ((-1, offset[1], columns), (-2, offset[0], rows[:, None])):
        if deviation.shape[axis] < 3:
            continue
        at = centre + off
        slope = _slope(deviation, at, axis)
        if axis == -1:  # wear may end at the form circle and goes on to the tip: at a flank's ends the slope to its next column
            for place, beside in ((grid.fillet, grid.fillet + 1), (-1, -2)):
                with np.errstate(invalid="ignore", divide="ignore"):
                    slope[..., place] = (deviation[..., beside] - deviation[..., place]) / (at[..., beside] - at[..., place])
        result -= np.nan_to_num(slope * off)
    return result


def _slope(value: Floats, at: Floats, axis: int) -> Floats:
    """Difference quotient over the two neighbours along an axis; nan at the ends and beside gaps."""
    v, x = np.moveaxis(value, axis, -1), np.moveaxis(at, axis, -1)
    slope = np.full_like(v, np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope[..., 1:-1] = (v[..., 2:] - v[..., :-2]) / (x[..., 2:] - x[..., :-2])
    return np.moveaxis(slope, -1, axis)


def window_mean(side_maps: SideMaps) -> tuple[Floats, Floats]:
    """Count-weighted mean over 3 × 3 cells of the same side, and its number of points; nan where nothing was seen."""
    value = np.where(side_maps.seen, np.nan_to_num(side_maps.deviation), 0.0) * side_maps.count
    rows = min(3, side_maps.deviation.shape[2])
    box = (1, 1, rows, 3)
    total = ndimage.uniform_filter(value, box, mode="constant") * (rows * 3)
    number = ndimage.uniform_filter(side_maps.count, box, mode="constant") * (rows * 3)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(number > 0.5, total / number, np.nan), number


def common_fillet(cells: Cells) -> Floats:
    """What the fillets of all teeth deviate by alike, height by height along the profile, (m,) mm; 0 off the fillets: the median of each column."""
    values = np.where(cells.seen, cells.points.deviation, np.nan)
    sides = cells.grid.sides(values)
    known = np.isfinite(sides).any(axis=(0, 1, 2))
    level = np.zeros(sides.shape[-1])
    level[known] = np.nanmedian(sides[..., known], axis=(0, 1, 2))
    level[cells.grid.fillet :] = 0.0
    return cells.grid.on_cells(np.broadcast_to(level, sides.shape))


def infill(side_maps: SideMaps) -> Floats:
    """Deviations with every unseen cell filled smoothly from its own side's neighbours; 0 on a side nobody saw.

    A hole with cells all round it takes the quadratic surface through them: over the deepest place of wear a mean of the rim would lose
    a tenth of the volume. The rest takes a normalised convolution with a widening Gaussian: near the edge of what was seen the nearest
    cells count, further off the far ones.
    """
    filled = np.where(side_maps.seen, np.nan_to_num(side_maps.deviation), 0.0)
    missing = ~side_maps.seen
    weight = side_maps.seen.astype(np.float64)
    values = filled.copy()
    for sigma in (1.0, 2.0, 4.0, 8.0, 16.0):
        if not missing.any():
            break
        spread = (0.0, 0.0, sigma if filled.shape[2] > 1 else 0.0, sigma)
        near = ndimage.gaussian_filter(weight, spread, mode="constant")
        mean = ndimage.gaussian_filter(values, spread, mode="constant")
        reached = missing & (near > 0.02)
        filled[reached] = mean[reached] / near[reached]
        missing &= ~reached
    _span_holes(filled, side_maps)
    return filled


def _span_holes(filled: Floats, side_maps: SideMaps) -> None:
    """Put quadratic surfaces into the holes of `filled` that lie inside a flank or a fillet."""
    seen = side_maps.seen
    label, _ = ndimage.label(~seen, AROUND & CROSS)
    rows, columns = label.shape[2:]
    alike = dict[tuple[int, int, bytes], list[tuple[int, int, int, int]]]()
    for number, place in enumerate(ndimage.find_objects(label), start=1):
        side, (low, high), (start, stop) = (place[0].start, place[1].start), *((edges.start, edges.stop) for edges in place[2:])
        first, last = (0, side_maps.fillet) if stop <= side_maps.fillet else (side_maps.fillet, columns)
        if low == 0 or high == rows or start <= first or stop >= last:
            continue
        form = label[place] == number
        alike.setdefault((high - low, stop - start, form.tobytes()), []).append((*side, low, start))
    for (high, wide, inside), holes in alike.items():
        hole = np.frombuffer(inside, dtype=bool).reshape(high, wide)
        for some in np.array_split(np.array(holes), max(1, -(-len(holes) // HOLES_AT_A_TIME))):
            _span(filled, side_maps, seen, hole, some)


def _span(filled: Floats, side_maps: SideMaps, seen: Bools, hole: Bools, holes: Ints) -> None:
    """The same for holes of one form, (rows, columns), of which a scan of many points has thousands, that begin at `holes` (n, 4)."""
    wide = np.pad(hole, RING_CELLS)
    inside = np.argwhere(wide) - RING_CELLS
    ring = np.argwhere(ndimage.binary_dilation(wide, CROSS, iterations=RING_CELLS) & ~wide) - RING_CELLS
    middle = 0.5 * np.array(hole.shape)

    def terms(at: Ints) -> Floats:
        z, x = (at - middle).T
        return np.stack([np.ones(len(at)), x, z, x * x, x * z, z * z], axis=-1)

    z, x = (holes[:, way, None] + ring[:, way - 2] for way in (2, 3))
    fillet = holes[:, 3, None] < side_maps.fillet
    first, last = np.where(fillet, 0, side_maps.fillet), np.where(fillet, side_maps.fillet, seen.shape[3])
    within = (z >= 0) & (z < seen.shape[2]) & (x >= first) & (x < last)
    around = holes[:, :1], holes[:, 1:2], z.clip(0, seen.shape[2] - 1), x.clip(0, seen.shape[3] - 1)
    known = within & seen[around]
    enough = known.sum(axis=1) >= (2 * 6 if hole.size > 1 else len(ring))
    known, around, holes = known[enough], tuple(np.broadcast_to(axis, within.shape)[enough] for axis in around), holes[enough]
    # Cells that do not count have no weight.
    weight, round_it = np.where(known, np.sqrt(side_maps.count[around]), 0.0), np.where(known, side_maps.deviation[around], 0.0)
    inverse = np.linalg.pinv(terms(ring) * weight[..., None], rtol=len(ring) * np.finfo(float).eps)
    value = np.einsum("nti,ni->nt", inverse, round_it * weight) @ terms(inside).T
    least, most = (
        of(np.where(known, round_it, empty), axis=1, keepdims=True) for of, empty in ((np.min, np.inf), (np.max, -np.inf))
    )
    place = holes[:, :1], holes[:, 1:2], holes[:, 2:3] + inside[:, 0], holes[:, 3:] + inside[:, 1]
    filled[place] = np.clip(value, least - 0.5 * (most - least), most + 0.5 * (most - least))


def worn_cells(local: Floats, number: Floats, noise: float, caution: float = 1.0) -> tuple[Bools, float, float]:
    """Mask of worn cells from window means (mm) and their numbers of points; the spread they were judged by; the limit.

    The spread comes from the upper half of the means, which one-sided wear does not reach; it holds texture and whatever the
    model leaves, and is never less than the white noise allows. `caution` above 1 multiplies the limit.
    """
    known = np.isfinite(local)
    if known.sum() < 20:
        return np.zeros(local.shape, dtype=bool), math.nan, math.nan
    values = local[known]
    middle = float(np.median(values))
    white = noise / math.sqrt(float(np.median(number[known])))
    spread = max(scale_about(values[values >= middle], middle), white)
    stds = own_spread(number, noise, spread, white)
    looks = max(float(known.sum()) / 9.0, 1.0)
    seed = caution * NormalDist().inv_cdf(1.0 - FALSE_ALARM / looks)
    # Scatter about a centre a little below zero is not wear of its own; a centre far below is (all flanks worn).
    centre = min(0.0, middle) if abs(middle) < 2.0 * spread else 0.0
    score = np.where(known, (centre - local) / stds, 0.0)
    candidates = score > caution * GROWTH_LIMIT_STDS
    core = score > seed
    label, _ = ndimage.label(candidates, AROUND)
    seeded = np.unique(label[core])
    mask = np.isin(label, seeded[seeded > 0])
    return mask, spread, seed * spread


def own_spread(number: Floats, noise: float, spread: float, white: float) -> Floats:
    """Standard deviation of window means of so many points, where the typical one has `spread` and by its points' noise `white`, mm."""
    return np.asarray(np.sqrt(spread**2 + np.where(number > 0.5, noise**2 / np.maximum(number, 1.0), white**2) - white**2))


def rim(mask: Bools, cells: int = 1) -> Bools:
    """`mask` and so many cells round it on the same side: where the edge of the wear fades below the limit."""
    return np.asarray(ndimage.binary_dilation(mask, AROUND, iterations=cells))


def between(pits: Bools, fillet: int) -> Bools:
    """The rows and columns of flanks from the first to the last cell with pits: what is too shallow to be seen lies between those that are.

    Where they come within two cells of the flank's edge they are taken to go on to it: next to it no pits are looked for.
    """
    result = np.zeros_like(pits)
    for tooth, half in np.argwhere(pits.any(axis=(2, 3))):
        rows, columns = (np.flatnonzero(pits[tooth, half].any(axis=axis)) for axis in (1, 0))
        bottom, top = _to_edge(rows, 0, pits.shape[2])
        low, high = _to_edge(columns, fillet, pits.shape[3])
        result[tooth, half, bottom:top, low:high] = True
    return result


def _to_edge(at: Ints, first: int, end: int) -> tuple[int, int]:
    """First of some places and the one behind the last; those of the edges where these are near."""
    low, high = int(at[0]), int(at[-1]) + 1
    return first if low <= first + NEAR_EDGE else low, end if high >= end - NEAR_EDGE else high

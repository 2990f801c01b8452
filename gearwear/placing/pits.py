"""Small pits and grooves: points far below their surroundings that are too many, in one place, to be strays.

A pit smaller than a cell holds a point or two, and each by itself looks like a stray. Strays lie above the surface as often as below it, pits
only below. So the points that lie far above tell how many far below chance allows, and where more lie below, they are the surface.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.special import pdtrc

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.placing.cells import CellGrid, Cells, FarPoints
from gearwear.placing.strays import apart
from gearwear.robust import scale_about

FAR_STDS = 3.5
"""Standard deviations of the points of a flank from which on one lies far off its surroundings."""
PIT_FALSE_ALARM = 0.003
"""Chance that a gear without pits shows any, for strays that are as often above the surface as below it."""
WINDOWS = (3, 6, 12)
"""Edges, in cells, of the squares in which far points are counted, beside whole flanks."""
DEEPEST = 0.1
"""Modules beyond which a single point far off is no pit's: a hollow so deep is wider than cells, and its points are no strays anyway."""
FEWEST_FAR = 3
"""Far points below which nothing is called a pit: two strays may lie side by side."""
FEWEST_CELLS = 2
"""Cells in which they must lie: errors of neighbouring points may hang together over less."""
COMPANY = 2.0
"""A point more than so many times as deep as the next less deep one of its flank has no company: it and what is deeper are strays."""
EDGE_CELLS = 1
"""Cells along tip and ends of a flank in which nothing is counted: edges are rounded, broken, or carry a burr."""


def find_far_points(points: SurfacePoints, cell: Ints, grid: CellGrid) -> tuple[FarPoints, Bools]:
    """Find the cells of flanks whose low points hang together.

    Parameters
    ----------
    points : SurfacePoints
        The located scan, n points.
    cell : (n,) int
        Cell of each point; −1: none.
    grid : CellGrid
        The cells, m of them.

    Returns
    -------
    far : FarPoints
    belongs : (n,) bool
        Points of flanks with pits that are no strays, however far off their cell's centre: as far below or above as the pits are deep. Strays
        among them lie as often above as below; their sum is nothing.

    Notes
    -----
    A point is far off where it differs from the median of the medians of the 3 × 3 cells round it by more than `FAR_STDS` robust standard
    deviations of its flank, and by how much more than one of them these medians lie apart (steep wear is no pit), but not more than `DEEPEST`. Of N points on all flanks
    N₊ lie far above; a place without pits has, of n points, Poisson's λ = n (N₊ + 1) / N far below, or n times the share far above on its own
    flank where that is more. K of them or more have the chance P(K; λ). Places are squares of `WINDOWS` cells, half overlapping, rows along
    the profile as grooves run, and whole flanks; each of these sizes gets an equal part of `PIT_FALSE_ALARM`, shared among its places.
    """
    reach = FarReach.of(points, cell, grid)
    pits = hanging_together(reach.tally(points, cell), reach)
    return pits.far, pits.hold(points, cell)


@dataclass(frozen=True, slots=True)
class FarTally:
    """Points of flanks that lie far off, counted.

    Parameters
    ----------
    number, below, above : (m,) float
        Points of inner cells: all, far below, far above.
    cell : (k,) int
        Of each point far below.
    off : (k,) float
        How far these lie off, mm; negative.
    """

    number: Floats
    below: Floats
    above: Floats
    cell: Ints
    off: Floats

    def plus(self, other: FarTally) -> FarTally:
        """The points of both."""
        return FarTally(
            self.number + other.number, self.below + other.below, self.above + other.above,
            np.concatenate([self.cell, other.cell]), np.concatenate([self.off, other.off]),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class FarReach:
    """How far a point of a flank may lie off its surroundings.

    Parameters
    ----------
    grid : CellGrid
    centre, reach : (m,) float
        Median of the surroundings, and by how much more a point is far off, mm; nan where there is none.
    inner : (m,) bool
        Cells of flanks away from tip and ends, in which far points are counted.
    """

    grid: CellGrid
    centre: Floats
    reach: Floats
    inner: Bools

    @classmethod
    def of(cls, points: SurfacePoints, cell: Ints, grid: CellGrid) -> FarReach:
        """What n points say, each in its cell (−1: none)."""
        index = np.flatnonzero((points.surface == FLANK) & (cell >= 0))
        return cls._about(cell[index], points.deviation[index], grid)

    @classmethod
    def round(cls, cells: Cells, noise: float) -> FarReach:
        """What the cells of a pass before say; `noise` is the scatter of points, mm."""
        seen = np.flatnonzero(cells.seen & (cells.points.surface == FLANK))
        return cls._about(seen, cells.points.deviation[seen], cells.grid, noise)

    @classmethod
    def _about(cls, cell: Ints, deviation: Floats, grid: CellGrid, noise: float | None = None) -> FarReach:
        """What deviations in cells of flanks say; without `noise` by the scale of each flank."""
        if grid.rows == 1 or not len(cell):
            return cls(grid, np.full(grid.count, np.nan), np.full(grid.count, np.nan), _inner(grid))
        centre = _surroundings(cell, deviation, grid)
        scale: Floats | float = grid.on_flanks(_scales(deviation - centre[cell], cell, grid)) if noise is None else noise
        return cls(grid, centre, FAR_STDS * scale + np.maximum(apart(centre, grid) - scale, 0.0), _inner(grid))

    def tally(self, points: SurfacePoints, cell: Ints) -> FarTally:
        """The far ones among points, each in its cell (−1: none)."""
        grid = self.grid
        index = np.flatnonzero((points.surface == FLANK) & (cell >= 0))
        cells = cell[index]
        off, reach = points.deviation[index] - self.centre[cells], self.reach[cells]
        inner, deepest = self.inner[cells], DEEPEST * grid.gear.transverse_module
        deep = (off < -reach) & (off > -deepest)
        low, high = inner & deep, inner & (off > reach) & (off < deepest)
        number, below, above = (np.bincount(cells[mask], minlength=grid.count).astype(np.float64) for mask in (inner, low, high))
        return FarTally(number, below, above, cells[deep], off[deep])


@dataclass(frozen=True, slots=True)
class Pits:
    """Where low points hang together.

    Parameters
    ----------
    far : FarPoints
    grid : CellGrid
    centre : (m,) float
        Median of the surroundings of each cell, mm.
    deepest : (2 · teeth,) float
        How deep pits of each flank are, mm; 0 without any.
    """

    far: FarPoints
    grid: CellGrid
    centre: Floats
    deepest: Floats

    def hold(self, points: SurfacePoints, cell: Ints) -> Bools:
        """(n,) points of flanks with pits that are no strays, as `find_far_points` has it."""
        belongs = np.zeros(len(points), dtype=bool)
        if not self.deepest.any():
            return belongs
        index = np.flatnonzero((points.surface == FLANK) & (cell >= 0))
        deepest = self.deepest[_flank(cell[index], self.grid)]
        belongs[index] = (np.abs(points.deviation[index] - self.centre[cell[index]]) <= deepest) & (deepest > 0.0)
        return belongs


def hanging_together(tally: FarTally, reach: FarReach) -> Pits:
    """The pits that the far points of a scan show; see `find_far_points`."""
    grid, number, below, above, cells, off = reach.grid, tally.number, tally.below, tally.above, tally.cell, tally.off
    flank = _flank(cells, grid)
    hanging = reach.inner[cells] & _crowded(number, below, above, grid)[cells]
    deepest = np.zeros(2 * grid.gear.teeth)
    for side in np.unique(flank[hanging]):
        if len(np.unique(cells[hanging & (flank == side)])) < FEWEST_CELLS:
            hanging &= flank != side
            continue
        deepest[side] = _with_company(-off[flank == side])
    hung = np.zeros(grid.count, dtype=bool)
    hanging &= -off <= deepest[flank]
    hung[cells[hanging]] = True
    depth = float(-off[hanging].mean()) if hanging.any() else 0.0
    return Pits(FarPoints(hung, below, above, depth), grid, reach.centre, deepest)


def _flank(cell: Ints, grid: CellGrid) -> Ints:
    """2 · tooth + side (0 left, 1 right) of cells of flanks."""
    return (cell - grid.blocks[FLANK][0]) // (grid.rows * grid.flank)


def _surroundings(cell: Ints, deviation: Floats, grid: CellGrid) -> Floats:
    """(m,) median of the medians of the up to 3 × 3 cells round each cell of a flank, mm; nan where there is none, and on other surfaces.

    Next to the form circle of those of its own column: the window would lean outwards, and a slope look like a depth.
    """
    order = np.lexsort((deviation, cell))
    ordered, value = cell[order], deviation[order]
    first = np.flatnonzero(np.diff(ordered, prepend=-1))
    number = np.diff(np.append(first, len(ordered)))
    median = np.full(grid.count, np.nan)
    median[ordered[first]] = 0.5 * (value[first + (number - 1) // 2] + value[first + number // 2])
    sheets = grid.flank_shape(median)
    rows, columns = sheets.shape[2:]
    wide = np.pad(sheets, ((0, 0), (0, 0), (1, 1), (1, 1)), constant_values=np.nan)
    around = np.stack([wide[..., i : i + rows, j : j + columns] for j in range(3) for i in range(3)])
    around[:3, ..., 0] = around[6:, ..., 0] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # places nobody saw
        sheets[...] = np.nanmedian(around, axis=0)
    return median


def _scales(off: Floats, cell: Ints, grid: CellGrid) -> Floats:
    """(teeth, 2) scale about 0 on each flank, not less than the typical flank's."""
    flank = _flank(cell, grid)
    result = np.array([scale_about(off[flank == number]) for number in range(2 * grid.gear.teeth)])
    return np.asarray(np.fmax(result, np.nanmedian(result)).reshape(-1, 2), dtype=np.float64)


def _inner(grid: CellGrid) -> Bools:
    """(m,) cells of flanks away from tip and ends."""
    inner = np.zeros(grid.count, dtype=bool)
    grid.flank_shape(inner)[..., EDGE_CELLS:-EDGE_CELLS, :-EDGE_CELLS] = True
    return inner


def _crowded(number: Floats, below: Floats, above: Floats, grid: CellGrid) -> Bools:
    """(m,) cells in places with more points far below than chance; from the numbers of all points, of those far below and far above."""
    number, below, above = (grid.flank_shape(values) for values in (number, below, above))
    whole = np.maximum(number.sum(axis=(2, 3), keepdims=True), 1.0)
    share = np.maximum((above.sum() + 1.0) / max(number.sum(), 1.0), above.sum(axis=(2, 3), keepdims=True) / whole)
    squares = [(edge, edge) for edge in WINDOWS if edge < min(grid.rows, grid.flank)]
    sizes = [*squares, (1, grid.flank), (grid.rows, grid.flank)]
    level = PIT_FALSE_ALARM / len(sizes)
    result = np.zeros(grid.count, dtype=bool)
    crowded = grid.flank_shape(result)
    for rows, columns in sizes:
        if columns == grid.flank:  # grooves run along the profile
            way = 3 if rows == 1 else (2, 3)
            expected, counted = share * number.sum(axis=way, keepdims=True), below.sum(axis=way, keepdims=True)
            looks = float((expected > 0).sum())
        else:
            box = (1, 1, rows, columns)
            expected, counted = (
                np.maximum(ndimage.uniform_filter(values, box, mode="constant") * rows * columns, 0.0)
                for values in (number, below)
            )
            expected = expected * share
            looks = 4.0 * float((number > 0).sum()) / (rows * columns)
        many = np.round(counted)
        chance = np.where(many > 0, pdtrc(np.maximum(many - 1.0, 0.0), np.maximum(expected, 1e-12)), 1.0)
        centre = (many >= FEWEST_FAR) & (chance < level / max(looks, 1.0))
        crowded |= centre if columns == grid.flank else ndimage.maximum_filter(centre, (1, 1, rows, columns))
    return result


def _with_company(depth: Floats) -> float:
    """Greatest of some depths that is not more than `COMPANY` times the next smaller one, from the middle one on."""
    ordered = np.sort(depth)
    upper = ordered[(len(ordered) - 1) // 2 :]
    alone = np.flatnonzero(upper[1:] > COMPANY * upper[:-1])
    return float(upper[alone[0]] if len(alone) else upper[-1])

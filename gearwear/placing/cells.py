"""A scan binned on the surfaces of the gear: what every later fit works on.

A cell keeps the sums a linear least-squares fit needs, so a fit on cells is the fit on points up to the
variation inside a cell, at a fifteenth of the size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gearwear import compiled
from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, OTHER, ROOT, TIP, SurfacePoints
from gearwear.design.twist import Segment, section_angle, segments
from gearwear.placing.strays import near_centre
from gearwear.placing.sums import CellSums

Value = TypeVar("Value", np.float64, np.bool_)

POINTS_PER_CELL = 4
"""Points that a cell should hold on average."""
FEWEST_SEEN = 3
"""Cells of a column of the fillets that tell how it was cut."""
LEAST_OF_TOOTH = 0.02
"""Share of the points on the densest tooth from which on a tooth counts as seen; uneven scans are 30 times as dense in places."""
FINEST = 0.08
"""Least cell size in modules: 0.5 mm at module 6.35."""
MAX_VARIANCE_RATIO = 4.0
"""Variance inside a cell, in that of the noise, above which something else than noise is in it."""


@dataclass(frozen=True, slots=True)
class CellGrid:
    """How the surfaces are divided: about square cells of one size, rows along z, columns along the profile.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    size : float
        Edge of a cell in mm.
    rows : int
        Rows along the face width.
    flank, fillet, tip, root, ring : int
        Columns on a flank and a fillet (each side), on a tip and a root land, rings on an end face.
    fillet_radius : (fillet + 1,) float
        Radii in mm that divide a fillet into equal arcs.
    """

    gear: Gear
    size: float
    rows: int
    flank: int
    fillet: int
    tip: int
    root: int
    ring: int
    fillet_radius: Floats

    @classmethod
    def for_scan(cls, gear: Gear, points: int, size: float | None = None, planar: bool = False) -> CellGrid:
        """Grid that leaves about `POINTS_PER_CELL` points in a cell, not finer than `FINEST` modules.

        Parameters
        ----------
        gear : Gear
            The nominal gear.
        points : int
            Points of the scan.
        size : float or None
            Edge of a cell in mm, where the caller wants a certain one.
        planar : bool
            True for a planar section: one row.
        """
        arcs = cls._arcs(gear)
        around = 2 * (arcs[0] + arcs[1]) + arcs[2] + arcs[3]
        if size is None:
            if planar:
                size = around * gear.teeth * POINTS_PER_CELL / points
            else:
                size = math.sqrt(around * gear.teeth * gear.face_width * POINTS_PER_CELL / points)
            size = max(size, FINEST * gear.transverse_module)
        # At least three columns and rows, else slopes along the flank could not be seen at all.
        flank, fillet = (max(3, round(arc / size)) for arc in arcs[:2])
        tip = max(1, round(arcs[2] / size))
        root = 2 * max(1, round(arcs[3] / (2 * size)))  # even: a tooth owns two halves of different spaces
        rows = 1 if planar else max(3, round(gear.face_width / size))
        inner, outer = cls.rings(gear)
        ring = max(3, round((outer - inner) / (3 * size)))
        phi = np.linspace(0.0, gear.fillet_end, 200)
        radius, angle = gear.root_curve.polar(phi)
        way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(radius), radius[1:] * np.diff(angle)))])
        edges = np.interp(np.linspace(0.0, way[-1], fillet + 1), way, radius)
        return cls(gear, size, rows, flank, fillet, tip, root, ring, edges)

    @classmethod
    def for_located(cls, located: SurfacePoints, gear: Gear, points: int, planar: bool = False) -> CellGrid:
        """`for_scan` with as many points as there would be were all teeth seen, so that the cells of a few teeth are no coarser than in a scan of all.

        Parameters
        ----------
        located : SurfacePoints
            Of the scan, or a sample of it.
        gear : Gear
        points : int
            Of the scan, on the gear.
        planar : bool
        """
        on_tooth = np.bincount(located.tooth[located.surface == FLANK], minlength=gear.teeth)
        seen = int((on_tooth > LEAST_OF_TOOTH * on_tooth.max()).sum())
        return cls.for_scan(gear, points if seen == 0 else round(points * gear.teeth / seen), planar=planar)

    @staticmethod
    def _arcs(gear: Gear) -> tuple[float, float, float, float]:
        """Lengths in mm of flank, fillet, tip land and root land in the transverse section."""
        radius, angle = gear.root_curve.polar(np.linspace(0.0, gear.fillet_end, 100))
        fillet = float(np.hypot(np.diff(radius), radius[1:] * np.diff(angle)).sum())
        flank = abs(gear.tip_roll**2 - gear.form_roll**2) / (2.0 * gear.base_radius)
        return flank, fillet, 2.0 * gear.tip_radius * gear.tip_half_angle, 2.0 * gear.root_radius * gear.root_half_angle

    @staticmethod
    def rings(gear: Gear) -> tuple[float, float]:
        """Radii between which the end faces are divided, mm: from the bore to the tips; of a ring from its tips outwards."""
        if not gear.spec.internal:
            return gear.body_radius, gear.tip_radius
        return gear.tip_radius, gear.rim_radius

    def fillet_place(self, radius: Floats) -> Floats:
        """Place on a fillet of radii (mm), in columns from the root, straight between their edges."""
        way = self.gear.orientation
        return np.asarray(np.interp(way * radius, way * self.fillet_radius, np.arange(self.fillet + 1.0)), dtype=np.float64)

    @property
    def roll_edges(self) -> Floats:
        """(flank + 1,) lengths of roll, at the point's own radius, that divide a flank into equal arcs, mm."""
        return self.rolls(1)

    def flank_column(self, roll: Floats | float) -> Ints:
        """Column of the flank that lengths of roll (mm) lie in; the first or the last of those beyond."""
        way = self.gear.orientation  # edges run from the form circle to the tip
        column = np.searchsorted(way * self.roll_edges, way * np.asarray(roll)) - 1
        return np.clip(column, 0, self.flank - 1)

    def rolls(self, parts: int) -> Floats:
        """(parts · flank + 1,) the same with `parts` equal arcs to a column."""
        return np.sqrt(np.linspace(self.gear.form_roll**2, self.gear.tip_roll**2, parts * self.flank + 1))

    @property
    def z_edges(self) -> Floats:
        """(rows + 1,) heights in mm."""
        if not self.groove_rows:
            return np.linspace(0.0, self.gear.face_width, self.rows + 1)
        (_, low), (_, high) = self.zones
        half, groove = (self.rows - self.groove_rows) // 2, self.groove_rows
        zones = ((low.low, low.high, half), (low.high, high.low, groove), (high.low, high.high, half))
        return np.concatenate([[0.0], *(np.linspace(start, end, count + 1)[1:] for start, end, count in zones)])

    @property
    def row_middles(self) -> Floats:
        """(rows,) heights, mm."""
        return np.asarray(0.5 * (self.z_edges[1:] + self.z_edges[:-1]), dtype=np.float64)

    @property
    def column_middles(self) -> Floats:
        """(flank,) lengths of roll, mm."""
        return self.rolls(2)[1::2]

    @property
    def fillet_middles(self) -> Floats:
        """(fillet,) radii, mm."""
        return np.asarray(0.5 * (self.fillet_radius[1:] + self.fillet_radius[:-1]), dtype=np.float64)

    @property
    def side_shape(self) -> tuple[int, int, int, int]:
        """Of arrays over the cells of all tooth sides: teeth, sides, rows, fillet and flank columns."""
        return self.gear.teeth, 2, self.rows, self.fillet + self.flank

    @property
    def groove_rows(self) -> int:
        """Rows of the groove of a double helical gear, in the middle: the others divide its halves evenly, and these hold no cells of flanks."""
        gap = self.gear.spec.gap
        if gap == 0.0 or self.rows == 1:
            return 0
        half = max(round(0.5 * self.rows * (1.0 - gap / self.gear.face_width)), 1)
        return self.rows - 2 * min(half, (self.rows - 1) // 2)

    @property
    def zones(self) -> tuple[tuple[slice, Segment], ...]:
        """The rows of the whole face; of a double helical gear those of each half."""
        if not self.groove_rows:
            return ((slice(0, self.rows), Segment(0.0, self.gear.face_width, self.gear.twist)),)
        half = (self.rows - self.groove_rows) // 2
        low, high = segments(self.gear)
        return (slice(0, half), low), (slice(self.rows - half, self.rows), high)

    @property
    def toothed(self) -> Bools:
        """(rows,) rows that have teeth: all but those of a groove."""
        result = np.zeros(self.rows, dtype=bool)
        for rows, _ in self.zones:
            result[rows] = True
        return result

    @property
    def on_teeth(self) -> Bools:
        """(m,) cells that the gear has: all but those of flanks, fillets, tips and roots in the rows of a groove."""
        result = np.ones(self.count, dtype=bool)
        columns = {FLANK: self.flank, FILLET: self.fillet, TIP: self.tip, ROOT: self.root}
        for surface, (start, size) in self.blocks.items():
            if surface in columns:
                result[start : start + size].reshape(-1, self.rows, columns[surface])[:, ~self.toothed] = False
        return result

    @property
    def row_height(self) -> float:
        """Height of a row with teeth, mm."""
        return (self.gear.face_width - self.gear.spec.gap) / (self.rows - self.groove_rows)

    def place_of(self, z: Floats) -> Floats:
        """Heights `z` (mm) counted in rows from the lower end."""
        if not self.groove_rows:
            return z * (self.rows / self.gear.face_width)
        return np.interp(z, self.z_edges, np.arange(self.rows + 1))

    @property
    def blocks(self) -> dict[int, tuple[int, int]]:
        """First cell and number of cells of each surface."""
        z, rows = self.gear.teeth, self.rows
        sizes = {
            FLANK: z * 2 * rows * self.flank, FILLET: z * 2 * rows * self.fillet, TIP: z * rows * self.tip,
            ROOT: z * rows * self.root, END_LOW: z * 2 * self.ring, END_HIGH: z * 2 * self.ring, BORE: z * rows,
        }  # fmt: skip
        result, start = {}, 0
        for surface, size in sizes.items():
            result[surface] = (start, size)
            start += size
        return result

    @property
    def count(self) -> int:
        """Number of cells in all."""
        start, size = self.blocks[BORE]
        return start + size

    def index(self, points: SurfacePoints) -> Ints:
        """Cell of each point, (n,) int64; −1 where the surface is OTHER."""
        if compiled.pays(len(points)):
            from gearwear.placing.compiled_index import cells_at

            return cells_at(self, points)
        gear, foot = self.gear, points.position
        result = np.full(len(points), -1, dtype=np.int64)
        height = np.nan_to_num(points.own_height)
        row = np.clip(self.place_of(height).astype(np.int64), 0, self.rows - 1)
        half = np.where(points.side > 0, 0, 1)
        for surface, (start, _) in self.blocks.items():
            at = np.flatnonzero(points.surface == surface)
            if not len(at):
                continue
            tooth, x, y = points.tooth[at].astype(np.int64), foot[at, 0], foot[at, 1]
            if surface == FLANK:
                square = points.own_roll(gear)[at] ** 2
                column = _bin(square, gear.form_roll**2, gear.tip_roll**2, self.flank)
                cell = ((tooth * 2 + half[at]) * self.rows + row[at]) * self.flank + column
            elif surface == FILLET:
                way = gear.orientation  # edges run from the root to the flank
                column = np.clip(np.searchsorted(way * self.fillet_radius, way * np.hypot(x, y)) - 1, 0, self.fillet - 1)
                cell = ((tooth * 2 + half[at]) * self.rows + row[at]) * self.fillet + column
            elif surface in (TIP, ROOT):
                angle = section_angle(gear, x, y, height[at]) - tooth * gear.pitch_angle
                if surface == TIP:
                    columns, half_angle, centre = self.tip, gear.tip_half_angle, 0.0
                else:  # the space on the tooth's own two sides: −τ/2 … τ/2 folded about τ/2
                    columns, half_angle, centre = self.root, gear.root_half_angle, 0.5 * gear.pitch_angle
                within = np.mod(angle - centre + 0.5 * gear.pitch_angle, gear.pitch_angle) - 0.5 * gear.pitch_angle
                column = _bin(within, -half_angle, half_angle, columns)
                cell = (tooth * self.rows + row[at]) * columns + column
            elif surface == BORE:
                cell = tooth * self.rows + row[at]
            else:
                angle = np.mod(section_angle(gear, x, y, height[at]) - tooth * gear.pitch_angle + np.pi, 2 * np.pi) - np.pi
                ring = _bin(np.hypot(x, y), *self.rings(gear), self.ring)
                cell = (tooth * 2 + (angle > 0)) * self.ring + ring
            result[at] = start + cell
        return result

    def flank_shape(self, values: NDArray[Value]) -> NDArray[Value]:
        """The flank block of an array over cells as (teeth, 2, rows, flank)."""
        start, size = self.blocks[FLANK]
        return values[start : start + size].reshape(self.gear.teeth, 2, self.rows, self.flank)

    def on_flanks(self, flanks: NDArray[Value]) -> NDArray[Value]:
        """Values of whole flanks, (teeth, 2), on all of their cells, (m,); zero (or False) elsewhere."""
        result = np.zeros(self.count, dtype=flanks.dtype)
        self.flank_shape(result)[...] = flanks[:, :, None, None]
        return result

    def fillet_shape(self, values: NDArray[Value]) -> NDArray[Value]:
        """The fillet block of an array over cells as (teeth, 2, rows, fillet)."""
        start, size = self.blocks[FILLET]
        return values[start : start + size].reshape(self.gear.teeth, 2, self.rows, self.fillet)

    def sides(self, values: NDArray[Value]) -> NDArray[Value]:
        """Fillet and flank blocks of an array over cells side by side, (teeth, 2, rows, fillet + flank): from root to tip."""
        return np.concatenate([self.fillet_shape(values), self.flank_shape(values)], axis=-1)

    def side(self, values: NDArray[Value], tooth: int, half: int) -> NDArray[Value]:
        """The same of one tooth side, (rows, fillet + flank, …), of an array over cells, (m, …)."""
        parts = []
        for surface, columns in ((FILLET, self.fillet), (FLANK, self.flank)):
            start, size = self.blocks[surface][0] + (2 * tooth + half) * self.rows * columns, self.rows * columns
            parts.append(values[start : start + size].reshape(self.rows, columns, *values.shape[1:]))
        return np.concatenate(parts, axis=1)

    def on_cells(self, sides: NDArray[Value]) -> NDArray[Value]:
        """The way back from `sides`: an array over all cells, (m,), zero (or False) on other surfaces."""
        result = np.zeros(self.count, dtype=sides.dtype)
        for surface, part in ((FILLET, sides[..., : self.fillet]), (FLANK, sides[..., self.fillet :])):
            start, size = self.blocks[surface]
            result[start : start + size] = part.reshape(-1)
        return result


def _bin(value: Floats, low: float, high: float, count: int) -> Ints:
    return np.clip(((value - low) * (count / (high - low))).astype(np.int64), 0, count - 1)


@dataclass(frozen=True, slots=True)
class FarPoints:
    """Points of flanks that lie far off their surroundings, cell by cell.

    Parameters
    ----------
    hung : (m,) bool
        Cells with points far below that hang together: small pits and grooves.
    below, above : (m,) float
        Points far below and far above, strays and all.
    depth : float
        How far below those that hang together lie on average, mm; 0 without any.
    """

    hung: Bools
    below: Floats
    above: Floats
    depth: float


@dataclass(frozen=True, slots=True)
class Cells:
    """Means over the cells of a grid.

    Parameters
    ----------
    grid : CellGrid
        The division of the surfaces.
    count : (m,) float
        Points used in each cell.
    points : SurfacePoints
        Mean foot, normal and deviation of each cell (deviation nan where the cell is empty); `roll` is the foot's.
    lever : (m, 3) float
        Mean of position × normal: with `points.normal` the exact columns of a small motion.
    scatter : (m,) float
        Standard deviation of the deviations inside a cell, mm; nan below 2 points.
    far : FarPoints or None
        What lies far off its surroundings (`pits.find_far_points`); None where it was not looked for.
    highest : (m,) float or None
        How far the highest point of a cell lies above its mean, mm; 0 in an empty cell. None: not known.
    """

    grid: CellGrid
    count: Floats
    points: SurfacePoints
    lever: Floats
    scatter: Floats
    far: FarPoints | None = None
    highest: Floats | None = None

    @property
    def seen(self) -> Bools:
        """Cells with a deviation."""
        return self.count > 0

    @property
    def part(self) -> Ints:
        """(m,) number of the tooth's surface that a cell is of, flanks and fillets of either side apart: errors hang together on it."""
        p = self.points
        return (p.surface.astype(np.int64) * self.grid.gear.teeth + p.tooth) * 2 + (p.side > 0)

    @property
    def motion(self) -> Floats:
        """(m, 6) mean columns of a small motion (tx, ty, tz, wx, wy, wz)."""
        return np.hstack([self.points.normal, self.lever])

    @property
    def sums(self) -> CellSums:
        """What these are the means of."""
        count, p = self.count, self.points

        def total(values: Floats) -> Floats:
            known = count > 0.0
            weight = np.where(known, count, 0.0)
            return np.asarray(np.where((known if values.ndim == 1 else known[:, None]), values, 0.0).T * weight).T

        squares = np.where(count >= 2.0, np.nan_to_num(self.scatter) ** 2 * (count - 1.0), 0.0)
        above = np.zeros_like(count) if self.highest is None else self.highest
        return CellSums(
            count=count, position=total(p.position), normal=total(p.normal), lever=total(self.lever), roll=total(p.roll),
            deviation=total(p.deviation), squares=squares, highest=np.where(count > 0.0, p.deviation + above, -np.inf),
        )  # fmt: skip

    def without(self, where: Bools) -> Cells:
        """The same with some cells (m,) not seen."""
        rest = self.with_deviation(np.where(where, np.nan, self.points.deviation))
        return replace(rest, count=np.where(where, 0.0, self.count))

    def pooled(self, grid: CellGrid) -> Cells:
        """The points of each cell in that cell of a coarser grid in which their mean lies."""
        into = np.full(len(self.count), -1, dtype=np.int64)
        into[self.seen] = grid.index(self.points.take(self.seen))
        return cells_of(self.sums.gathered(into, grid.count), grid)

    @property
    def fillet_edges(self) -> Floats:
        """Radii in mm that divide the fillets into columns, (k + 1,), from the first to the last that was seen; (0,) where none was."""
        grid = self.grid
        number = grid.fillet_shape(self.seen & (self.points.surface == FILLET)).sum(axis=(0, 1, 2))
        columns = np.flatnonzero(number >= FEWEST_SEEN)
        return grid.fillet_radius[columns[0] : columns[-1] + 2] if len(columns) else grid.fillet_radius[:0]

    def with_deviation(self, deviation: Floats) -> Cells:
        """The same cells with other mean deviations (mm)."""
        return replace(self, points=self.points.with_deviation(deviation))


def bin_points(points: SurfacePoints, grid: CellGrid, clip: float | None = None) -> Cells:
    """Average a located scan over the cells of a grid.

    Parameters
    ----------
    points : SurfacePoints
        The located scan.
    grid : CellGrid
        The division.
    clip : float or None
        Points further than this (mm) from their cell's robust centre are left out as strays; None keeps all.

    Returns
    -------
    Cells
    """
    index = grid.index(points)
    if clip is not None:
        index = np.where(near_centre(points.deviation, index, grid, clip), index, -1)
    return cells_of(CellSums.of(points, index, grid.count), grid)


def cells_of(sums: CellSums, grid: CellGrid) -> Cells:
    """The means of all that was summed up over the cells of a grid."""
    count = sums.count
    with np.errstate(invalid="ignore", divide="ignore"):
        per = 1.0 / count
        deviation = sums.deviation * per
        spread = sums.squares * per
        scatter = np.where(count >= 2, np.sqrt(np.maximum(spread, 0.0) * count / np.maximum(count - 1, 1)), np.nan)
        highest = np.where(count > 0, np.maximum(sums.highest - deviation, 0.0), 0.0)
        surface, tooth, side = _labels(grid)
        means = SurfacePoints(
            surface, tooth, side, sums.roll * per, sums.position * per[:, None], sums.normal * per[:, None], deviation
        )
        return Cells(grid, count, means, sums.lever * per[:, None], scatter, highest=highest)


def _labels(grid: CellGrid) -> tuple[Ints, Ints, Ints]:
    """Surface, tooth and side of every cell."""
    surface = np.full(grid.count, OTHER, np.int8)
    tooth = np.zeros(grid.count, np.int32)
    side = np.zeros(grid.count, np.int8)
    for code, (start, size) in grid.blocks.items():
        block = slice(start, start + size)
        surface[block] = code
        per_tooth = size // grid.gear.teeth
        tooth[block] = np.arange(size) // per_tooth
        if code in (FLANK, FILLET):
            side[block] = np.where((np.arange(size) // (per_tooth // 2)) % 2 == 0, 1, -1)
    return surface, tooth, side


def usual_count(cells: Cells) -> Floats:
    """(m,) median number of points in the cells that hold any, on each surface of each tooth and side."""
    grid, result = cells.grid, np.zeros(cells.grid.count)
    for surface, (start, size) in grid.blocks.items():
        parts = grid.gear.teeth * (2 if surface in (FLANK, FILLET) else 1)
        counts = cells.count[start : start + size].reshape(parts, -1)
        typical = [float(np.median(part[part > 0])) if (part > 0).any() else 0.0 for part in counts]
        result[start : start + size] = np.repeat(typical, size // parts)
    return result


def noise(cells: Cells) -> float:
    """The scan's own noise in mm: scatter inside cells, pooled over those that are not torn by an edge of wear.

    Correlated texture longer than a cell is not in it.

    Notes
    -----
    A cell counts where its variance is below `MAX_VARIANCE_RATIO` times the noise's. Of normal scatter with ν degrees of freedom that leaves
    ``σ² P(χ²_{ν+2} < MAX_VARIANCE_RATIO ν) / P(χ²_ν < MAX_VARIANCE_RATIO ν)`` on average, so the sum is taken for as much less: cells of two points would
    otherwise make the noise a quarter too small.
    """
    from scipy.special import gammainc

    usable = np.isfinite(cells.scatter) & (cells.points.surface <= FILLET)
    if usable.sum() < 10:
        usable = np.isfinite(cells.scatter)
    if not usable.any():
        return math.nan
    square, freedom = cells.scatter[usable] ** 2, cells.count[usable] - 1.0
    share = gammainc(0.5 * freedom + 1.0, 0.5 * MAX_VARIANCE_RATIO * freedom) / gammainc(
        0.5 * freedom, 0.5 * MAX_VARIANCE_RATIO * freedom
    )
    level = float(np.median(square / (1.0 - 2.0 / (9.0 * freedom)) ** 3))  # the median of χ²_ν / ν (Wilson & Hilferty 1931)
    for _ in range(3):
        calm = square <= MAX_VARIANCE_RATIO * level
        level = float((square * freedom)[calm].sum() / (share * freedom)[calm].sum())
    return math.sqrt(level)

"""The sums of one pass over the points of a streamed scan: by numpy, or, where it is compiled and pays, point by point in one loop."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearwear import compiled
from gearwear.arrays import Bools, Floats
from gearwear.comparison.on_design import OnDesign, Places
from gearwear.comparison.pass_limits import PassLimits
from gearwear.design.compiled_locate import constants_of
from gearwear.design.surface import FLANK, OTHER, SurfacePoints
from gearwear.placing.cells import CellGrid
from gearwear.placing.compiled_index import division_of
from gearwear.placing.low_tips import highest_flank
from gearwear.placing.pits import DEEPEST, FarTally
from gearwear.placing.pose import Pose
from gearwear.placing.sums import CellSums
from gearwear.wear.section_sums import SectionBand, SectionSums

if TYPE_CHECKING:
    from gearwear.placing.kernel import Sieve

BESIDE = 0.2
"""Modules that a correction may move a point along the profile at most."""
ROUNDING = 1e-9
"""Modules that a length of roll may be off by rounding, at the base circle; the band itself is held exactly afterwards."""


@dataclass(frozen=True, slots=True)
class Cut:
    """What thickness follows from: sums over the points of flanks near a band, once what measurement added is taken off.

    Parameters
    ----------
    band : SectionBand
    correct : callable or None
        Gives the deviations that are left, mm; None: all of them.
    """

    band: SectionBand
    correct: Callable[[SurfacePoints], Floats] | None = None

    @property
    def half(self) -> float:
        """Half the width of what is looked at, in length of roll, mm: a hair more than the band, and as much as a correction may move a point."""
        beside = ROUNDING if self.correct is None else BESIDE
        return self.band.half + beside * self.band.gear.transverse_module

    def holds(self, points: SurfacePoints) -> Bools:
        """(n,) points of flanks that a correction may move into the band."""
        return np.asarray(np.abs(points.own_roll(self.band.gear) - self.band.reach) <= self.half)

    def of(self, near: SurfacePoints) -> SectionSums:
        """Of the points that are held."""
        return SectionSums.of(near if self.correct is None else near.with_deviation(self.correct(near)), self.band)


@dataclass(frozen=True, slots=True)
class Collection:
    """What a pass adds up.

    Parameters
    ----------
    sums : CellSums
        Of the points that are no strays.
    far : FarTally
        Points far off.
    sections : SectionSums
    located, other : int
        Points in all, and those on no surface.
    """

    sums: CellSums
    far: FarTally
    sections: SectionSums
    located: int
    other: int


def collected(points: Iterable[Floats], put: Places, grid: CellGrid, by: PassLimits, cut: Cut) -> Collection:
    """Sums over points.

    Parameters
    ----------
    points : iterable of (n, 3) float
        mm, in the frame that `put` takes.
    put : Places
        Puts them on the design.
    grid : CellGrid
    by : PassLimits
        Tells strays and pits.
    cut : Cut
        What sections are made of.
    """
    if isinstance(put, OnDesign) and compiled.pays(0):
        return _compiled(points, put, grid, by, cut)
    sums, far, across, count, other = CellSums.empty(grid.count), None, None, 0, 0
    for chunk in (put.located(part) for part in points):
        cell = grid.index(chunk)
        near = by.limits.hold(chunk.deviation, cell if by.grid is grid else by.grid.index(chunk)) & (cell >= 0)
        tally = by.reach.tally(chunk, cell)
        far = tally if far is None else far.plus(tally)
        kept = near if by.pits is None else near | (by.pits.hold(chunk, cell))
        sums.add(chunk, np.where(kept, cell, -1))
        part = cut.of(chunk.take(near & cut.holds(chunk)))
        across = part if across is None else across.plus(part)
        count += len(chunk)
        other += int((chunk.surface == OTHER).sum())
    assert across is not None and far is not None  # a scan has points
    return Collection(sums, far, across, count, other)


def _compiled(points: Iterable[Floats], put: OnDesign, grid: CellGrid, by: PassLimits, cut: Cut) -> Collection:
    from gearwear.placing.kernel import INNER, ROW, collect

    motion = put.motion or Pose.identity()
    rotation, translation = np.ascontiguousarray(motion.rotation), np.ascontiguousarray(motion.translation)
    constants, division = constants_of(put.gear, put.bands), division_of(grid)
    limits = division if by.grid is grid else division_of(by.grid)
    sieve, rows, far_off = _sieve(put, grid, by, cut), np.zeros((grid.count, ROW)), np.zeros((grid.count, 2))
    cells, offs, across, count, other = [], [], None, 0, 0
    cell, off, near = np.empty(0, np.int64), np.empty(0), SurfacePoints.room(0)
    for part in points:
        n = len(part)
        if n > len(near):  # room for a part, which those after it use again: new memory costs as much as a step of the loop
            cell, off, near = np.empty(n, np.int64), np.empty(n), SurfacePoints.room(n)
            near.surface[:] = FLANK
        lost, far, kept = collect(
            np.ascontiguousarray(part), rotation, translation, constants, division, limits, sieve, rows, far_off, cell, off,
            near.tooth, near.side, near.roll, near.position, near.normal, near.deviation,
        )  # fmt: skip
        cells.append(cell[:far].copy())
        offs.append(off[:far].copy())
        sections = cut.of(near.take(slice(kept)))
        across = sections if across is None else across.plus(sections)
        count += n
        other += lost
    assert across is not None  # a scan has points
    below, above = far_off.T.copy()
    far_points = FarTally(rows[:, INNER].copy(), below, above, np.concatenate(cells), np.concatenate(offs))
    return Collection(_sums(rows), far_points, across, count, other)


def _sieve(put: OnDesign, grid: CellGrid, by: PassLimits, cut: Cut) -> Sieve:
    from gearwear.placing.kernel import Sieve

    limits, reach = by.limits, by.reach
    pits = by.pits if by.pits is not None and by.pits.deepest.any() else None
    return Sieve(
        highest=highest_flank(put.gear, put.noise, put.shift),
        own_grid=by.grid is grid,
        limits=np.column_stack([limits.centre, np.where(limits.lone, -1.0, limits.limit)]),
        far=np.column_stack([reach.centre, reach.reach, reach.inner, reach.centre if pits is None else pits.centre]),
        depth=DEEPEST * grid.gear.transverse_module,
        deepest=np.empty(0) if pits is None else pits.deepest,
        middle=cut.band.reach,
        half=cut.half,
    )


def _sums(rows: Floats) -> CellSums:
    """What the rows of cells hold."""
    from gearwear.placing.kernel import COUNT, DEVIATIONS, FEET, HIGHEST, LEVERS, NORMALS, ROLLS, SQUARES

    one = {"count": COUNT, "roll": ROLLS, "deviation": DEVIATIONS, "squares": SQUARES}
    three = {"position": FEET, "normal": NORMALS, "lever": LEVERS}
    return CellSums(
        **{name: rows[:, at].copy() for name, at in one.items()},
        **{name: rows[:, at : at + 3].copy() for name, at in three.items()},
        highest=np.where(rows[:, COUNT] > 0.0, rows[:, HIGHEST], -np.inf),
    )

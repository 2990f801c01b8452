"""A streamed scan in cells: passes over all its points, placed and judged by what a sample, or the pass before, has told.

A sample of the scan is held in memory and goes the way of any scan: pose, root, fractures, bands. The cells, and the sums that the thickness of
sections follows from, are those of all points.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from gearwear import compiled
from gearwear.arrays import Floats
from gearwear.comparison.collecting import Cut, collected
from gearwear.comparison.on_design import OnDesign, Places
from gearwear.comparison.pass_limits import PassLimits
from gearwear.comparison.relocated import FinalMotion, Relocation
from gearwear.design.surface import OTHER, SurfacePoints
from gearwear.placing.cells import CellGrid, Cells, cells_of
from gearwear.placing.low_tips import below_tips, tip_shift
from gearwear.placing.pits import Pits, hanging_together
from gearwear.placing.pose import Pose
from gearwear.placing.registration import Registration, refit
from gearwear.placing.sums import CellSums
from gearwear.placing.views import PlacedScan
from gearwear.scan.pieces import Chunks
from gearwear.wear.breakage import Borders
from gearwear.wear.section_sums import SectionBand, SectionSums

MOST_REFITS = 3
"""Passes in which the pose of the sample may be moved to that of the whole scan. The first is enough where the sample is dense enough for the
cells; where it is thin, the second tells strays and pits by the cells of the first."""


@dataclass(frozen=True, slots=True)
class Source:
    """All points of a streamed scan in the design frame, without what is broken off.

    Parameters
    ----------
    chunks : Chunks
    pose : Pose
        design = rotation · scan + translation.
    borders : Borders
        Where something is broken off.
    shift : float
        How far the tips lie above those drawn, mm.
    """

    chunks: Chunks
    pose: Pose
    borders: Borders
    shift: float

    def __iter__(self) -> Iterator[Floats]:
        for chunk in self.chunks:
            for part in compiled.parts(chunk):
                points = self.pose.apply(part)
                broken = self.borders.hold(points)
                yield points[~broken] if broken.any() else points

    def with_pose(self, put: Places) -> tuple[Iterable[Floats], Places]:
        """Points, and what puts them on the design: a compiled loop takes the pose along, where nothing is broken off."""
        if self.borders.fractures or not isinstance(put, OnDesign) or not compiled.pays(0):
            return self, put
        return self.chunks, replace(put, motion=self.pose if put.motion is None else self.pose.then(put.motion))


@dataclass(frozen=True, slots=True, kw_only=True)
class Pass:
    """What a pass over all points found.

    Parameters
    ----------
    cells : Cells
    pits : Pits
    sections : SectionSums
    located : int
        Points gone through, without those of fractures.
    other : int
        Those of them on no surface of the design.
    """

    cells: Cells
    pits: Pits
    sections: SectionSums
    located: int
    other: int


@dataclass(frozen=True, slots=True)
class Streamed:
    """A streamed scan on its design before the loop.

    Parameters
    ----------
    source : Source
        All its points.
    first : Pass
        Over them.
    registration : Registration
        In whose pose and bands.
    again : Relocation or None
        How the points of a strongly distorted scan are located once the loop was closed.
    """

    source: Source
    first: Pass
    registration: Registration
    again: Relocation | None = None

    def located(self) -> Iterator[SurfacePoints]:
        """All points on the design, chunk by chunk, before the motion that the loop found."""
        gear, registration = self.first.cells.grid.gear, self.registration
        put = OnDesign(gear, registration.bands, registration.noise, self.source.shift)
        for points in self.source:
            with compiled.parts_of(len(self.source.chunks)):
                located = put.located(points) if self.again is None else self.again.located(points)[0]
            yield located

    @property
    def fracture_points(self) -> int:
        """Points of what is broken off, and beside it."""
        return len(self.source.chunks) - self.first.located


def go_through(source: Source, put: Places, grid: CellGrid, by: PassLimits, cut: Cut) -> Pass:
    """All points in cells; parameters as `collecting.collected`."""
    with compiled.parts_of(len(source.chunks)):
        whole = collected(*source.with_pose(put), grid, by, cut)
    pits = hanging_together(whole.far, by.reach)
    cells = replace(cells_of(whole.sums, grid), far=pits.far)
    return Pass(cells=cells, pits=pits, sections=whole.sections, located=whole.located, other=whole.other)


def first_pass(
    chunks: Chunks, placed: PlacedScan, borders: Borders, grid: CellGrid, clip: float, band: SectionBand, ignore: frozenset[int]
) -> tuple[PlacedScan, Streamed]:
    """All points of a streamed scan in the cells of a grid, and its pose from them.

    Parameters
    ----------
    chunks : Chunks
    placed : PlacedScan
        The sample, without what is broken off.
    borders : Borders
        Where something is broken off.
    grid : CellGrid
    clip : float
        How far a point may lie from the centre of a level cell, mm.
    band : SectionBand
        Where thickness is measured.
    ignore : frozenset of int
        Codes of surfaces that are no datum.
    """
    gear = grid.gear
    shift = tip_shift(placed.located)
    placed = replace(placed, located=below_tips(placed.located, gear, placed.registration.noise))
    by, noise = PassLimits.of_sample(placed.located, grid, clip), placed.registration.noise
    for number in range(MOST_REFITS):
        source, registration = Source(chunks, placed.registration.pose, borders, shift), placed.registration
        put = OnDesign(gear, registration.bands, registration.noise, shift)
        first = go_through(source, put, grid, by, Cut(band))
        refitted, cells, step = refit(registration, first.cells, ignore)
        located = replace(put, noise=refitted.noise).located(step.apply(placed.measured))
        placed = replace(placed, registration=refitted, located=located)
        if refitted.converged and (number > 0 or by.grid is grid):
            break
        by = PassLimits.of_cells(first.pits, cells, clip, noise)
    source = replace(source, pose=refitted.pose)
    return placed, Streamed(source, replace(first, cells=cells), refitted)


def moved(cells: Cells, motion: Floats) -> Cells:
    """The cells after a small motion (6,) of the points, to first order."""
    return cells.with_deviation(cells.points.deviation + cells.motion @ motion)


def relocated_pass(streamed: Streamed, again: Relocation) -> Streamed:
    """All points of a strongly distorted scan, located again, in cells; their scatter that of what the model leaves."""
    grid = streamed.first.cells.grid
    sums, left, across, other = CellSums.empty(grid.count), CellSums.empty(grid.count), None, 0
    with compiled.parts_of(len(streamed.source.chunks)):
        for points in streamed.source:
            located, rest = again.located(points)
            cell = grid.index(located)
            sums.add(located, cell)
            left.add(rest, cell)
            part = SectionSums.of(located, streamed.first.sections.band)
            across = part if across is None else across.plus(part)
            other += int((located.surface == OTHER).sum())
    assert across is not None  # a scan has points
    cells = replace(cells_of(sums, grid), scatter=cells_of(left, grid).scatter)
    return replace(streamed, first=replace(streamed.first, cells=cells, sections=across, other=other), again=again)


def last_pass(
    streamed: Streamed, cells: Cells, motion: FinalMotion, clip: float, noise: float, correct: Callable[[SurfacePoints], Floats]
) -> Pass:
    """All points where the loop left them.

    Parameters
    ----------
    streamed : Streamed
    cells : Cells
        Of the pass before, moved to where these will lie.
    motion : FinalMotion
    clip : float
        How far a point may lie from the centre of a level cell, mm.
    noise : float
        Scatter of points, mm.
    correct : callable
        Deviations of points without what measurement added, mm.
    """
    by = PassLimits.of_cells(streamed.first.pits, cells, clip, noise)
    return go_through(streamed.source, motion.put, cells.grid, by, Cut(streamed.first.sections.band, correct))

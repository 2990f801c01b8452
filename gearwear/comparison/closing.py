"""Closing the loop on a registered scan: on few cells first, located again where it is distorted, on as many cells as it needs, and moved along."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gearwear.arrays import Bools
from gearwear.comparison.measured_gear import FinalPlace, MeasuredGear, Progress, register
from gearwear.comparison.pass_limits import grid_of_sample
from gearwear.comparison.passes import last_pass, moved, relocated_pass
from gearwear.comparison.placed_notes import beside_smoothing, beside_views
from gearwear.comparison.relocated import FinalMotion, Relocation, clip_of, in_cells, is_far
from gearwear.comparison.which_gear import check_part
from gearwear.design.pair import Design
from gearwear.design.side import Side, sides_given
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.loop import Loop, close_loop
from gearwear.diagnose.no_datum import BESIDE, leaves_a_datum
from gearwear.diagnose.pooled import carried, left_out, loop_grid, rough_grid
from gearwear.diagnose.space_waves import SpaceWave
from gearwear.errors import InputError, check_kind
from gearwear.placing.cells import CellGrid, Cells, bin_points, cells_of, noise
from gearwear.placing.sums import CellSums
from gearwear.scan.reading import read_scan
from gearwear.scan.types import Scan
from gearwear.threads import on_one_thread


def measure(
    design: Design,
    files: Sequence[str | Path | Scan],
    part: str | None = None,
    units: str = "mm",
    loop: bool = True,
    progress: Progress = lambda station: None,
    stream: bool | None = False,
) -> MeasuredGear:
    """Read scans, put them on the design, and find what else than wear they show.

    Parameters
    ----------
    design : Design
        One gear or a pair.
    files : sequence of path or Scan
        One scan, or several views of one gear.
    part : {"pinion", "gear"} or None
        Which one was scanned; None: the one whose size fits.
    units : str
        Unit of the scans.
    loop : bool
        Whether to look for effects beyond registration.
    progress : callable
        Told each station.
    stream : bool or None
        Whether only a sample of the points is held in memory; None: where there are many.

    Returns
    -------
    MeasuredGear

    Raises
    ------
    InputError
        If a file or a value is wrong, or the scan is of something else.
    """
    check_part(design, part)
    progress("reading")
    scans = read_scan(files, units, stream)
    progress("registration")
    measured = register(design, scans, part)
    if not loop:
        return measured
    progress("closing the loop")
    return find_effects(measured)


@on_one_thread
def find_effects(measured: MeasuredGear, worn: frozenset[Side] | None = None) -> MeasuredGear:
    """Close the loop: find what scanner, mounting and maker added.

    Parameters
    ----------
    measured : MeasuredGear
        As `register` gives it; what is returned has its `loop`, and the points located again where the loop moved them.
    worn : frozenset of Side or None
        Sides that are known to be worn throughout; None: the scan decides.

    Raises
    ------
    InputError
        If `measured` or `worn` is something else, or the scan has nothing else than the flanks of these sides to be held by.
    """
    check_kind(measured, MeasuredGear, "measured", "what gw.register returns")
    worn = None if worn is None else sides_given(worn, "worn")
    if worn and not leaves_a_datum(measured.first, measured.context, worn - {face.side for face in measured.context.faces}):
        which = " and ".join(map(str, sorted(worn, reverse=True)))
        raise InputError(
            f"worn: without the {which} flanks nothing was seen that holds the gear; a scan with {BESIDE} would be right"
        )
    scan = _Scan(measured, measured.first, measured.placed.located, worn=worn)
    look = scan.looked_at()
    if look is not None:
        first = look[0]
        sure = first.worn_sides if first.sides_sure else worn
        pitch = first.context.pitch if first.sides_sure else measured.context.pitch
        known = replace(measured, context=measured.context.with_pitch(pitch))
        scan = replace(scan, measured=known, worn=sure, ruled_out=first.sides_ruled_out, in_space=first.in_space)
    far = look is not None and is_far(*look)
    likeliest = look[0] if look is not None and far else scan.explained(look)
    again = None
    if far or is_far(likeliest, scan.cells):
        scan, again = scan.located_again(likeliest)
        likeliest = scan.explained()
    likeliest, *others = beside_smoothing((likeliest, *likeliest.others), scan.cells)
    return replace(scan.closed(likeliest, again), undecided=tuple(scan.moved(other, again) for other in others))


Look = tuple[Loop, Cells]  # a loop, and the cells it was closed on


@dataclass(frozen=True, slots=True)
class _Scan:
    """A scan as the loop is closed on it.

    Parameters
    ----------
    measured : MeasuredGear
    cells : Cells
        Of all points.
    located : SurfacePoints
        The points held in memory.
    rest : SurfacePoints or None
        These with what the first loop leaves of their deviations, where they were located again.
    begun : Loop or None
        That loop.
    worn : frozenset of Side or None
        Sides that are known to be worn throughout.
    ruled_out : frozenset of frozenset of Side
        What the loop on few cells told not to be so (`Loop.sides_ruled_out`).
    in_space : tuple of SpaceWave or None
        Waves in space that a first look found; None: they are looked for.
    """

    measured: MeasuredGear
    cells: Cells
    located: SurfacePoints
    rest: SurfacePoints | None = None
    begun: Loop | None = None
    worn: frozenset[Side] | None = None
    ruled_out: frozenset[frozenset[Side]] = frozenset()
    in_space: tuple[SpaceWave, ...] | None = None

    @property
    def grid(self) -> CellGrid:
        return self.cells.grid

    def looked_at(self) -> Look | None:
        """The loop on few cells, which tell as well whether the scan must be located again, and by what; None where there are no more than these."""
        rough = rough_grid(self.grid)
        return None if rough is None else self._closed_on(rough, None, first=True)

    def explained(self, look: Look | None = None) -> Loop:
        """The loop closed on as many cells as it needs, by what a look at fewer left out."""
        coarse = loop_grid(self.grid)
        if coarse is self.grid:
            return self._loop(self.cells, self.measured.context)
        return carried(*self._closed_on(coarse, look), self.cells, self.measured.noise)

    def _closed_on(self, coarse: CellGrid, look: Look | None, first: bool = False) -> Look:
        measured = self.measured
        if measured.streamed is not None:
            pooled = self.cells.pooled(coarse)
        elif self.rest is None:
            pooled = bin_points(self.located, coarse, clip=clip_of(self.located))
        else:
            pooled = _with_scatter(self.located, self.rest, coarse)
        context = replace(measured.context, row_height=coarse.row_height, fillet_edges=tuple(pooled.fillet_edges.tolist()))
        return self._loop(pooled, context, None if look is None else left_out(*look, pooled), first), pooled

    def _loop(self, cells: Cells, context: Context, out: Bools | None = None, first: bool = False) -> Loop:
        measured = self.measured
        free = not measured.root.fits_design
        return close_loop(
            cells,
            measured.noise,
            context,
            root_free=free,
            worn=self.worn,
            out=out,
            begun=self.begun,
            ruled_out=self.ruled_out,
            look=first,
            in_space=self.in_space,
        )

    def located_again(self, loop: Loop) -> tuple[_Scan, Relocation]:
        """The scan without the distortion that a loop found. Bands and feet were set before anything was known of it; now each point can be judged by
        what is left."""
        measured, placed = self.measured, self.measured.placed
        sample_grid = self.grid if measured.streamed is None else grid_of_sample(placed.located, self.grid)
        again, located, rest = Relocation.of(placed, loop, sample_grid)
        if measured.streamed is None:
            cells = _with_scatter(located, rest, self.grid)
        else:
            streamed = relocated_pass(measured.streamed, again)
            measured, cells = replace(measured, streamed=streamed), streamed.first.cells
        registration = replace(placed.registration, noise=noise(cells))  # without what goes up and down within a cell
        measured = replace(measured, placed=replace(placed, registration=registration, located=located))
        return replace(
            self, measured=measured, cells=cells, located=located, rest=rest, begun=loop, in_space=loop.in_space
        ), again

    def moved(self, loop: Loop, again: Relocation | None) -> MeasuredGear:
        """With a loop; the cells of a streamed scan are moved along, not its points."""
        return self._with(loop, again)[0]

    def closed(self, loop: Loop, again: Relocation | None) -> MeasuredGear:
        """With the loop that was decided for: all points of a streamed scan are put where it leaves them."""
        result, motion = self._with(loop, again)
        if result.streamed is None:
            return result
        final, noise = result.final, self.measured.noise
        last = last_pass(result.streamed, final.cells, motion, clip_of(result.located), noise, result.straightened)
        return replace(result, final=replace(final, cells=last.cells, sections=last.sections))

    def _with(self, loop: Loop, again: Relocation | None) -> tuple[MeasuredGear, FinalMotion]:
        measured = self.measured
        motion, located = FinalMotion.of(measured.placed, loop, measured.gear, again)
        lying = in_cells(located, self.grid)
        cells = lying.means()[0] if measured.streamed is None else moved(self.cells, -loop.motion)
        named = beside_views(loop, measured.placed, self.cells, measured.noise)
        context = measured.context.with_pitch(named.context.pitch)
        return replace(
            measured, context=context, first=self.cells, loop=named, final=FinalPlace(lying, motion.pose, cells)
        ), motion


def _with_scatter(located: SurfacePoints, rest: SurfacePoints, grid: CellGrid) -> Cells:
    """Cells of points with the scatter of what a loop leaves of them: what goes up and down within a cell because the effects do is none."""
    index = grid.index(located)
    cells, left = (cells_of(CellSums.of(points, index, grid.count), grid) for points in (located, rest))
    return replace(cells, scatter=left.scatter)

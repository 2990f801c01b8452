"""From files to a gear on its design, with what the scanner and the maker added known apart: what `compare` and `inspect` share."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.artefact import calibrated
from gearwear.comparison.collecting import Cut
from gearwear.comparison.laying import laid_on, unstated_root
from gearwear.comparison.own_edges import on_its_ends, on_its_tips, on_tips_of
from gearwear.comparison.own_root import no_datum, on_its_root
from gearwear.comparison.passes import Streamed, first_pass
from gearwear.comparison.placed_notes import SMOOTHED, VIEWS_MAY_LIE_APART, doubts_of, said_of_scale, sample_note, was_smoothed
from gearwear.comparison.relocated import LEAST_NOISE, clip_of, in_cells
from gearwear.comparison.stated import at_20_degrees, check_streamed, tooth_1_of, without_ignored
from gearwear.comparison.which_gear import by_size, check_part, placed_as
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.side import Side, sides_of
from gearwear.design.surface import OTHER, SURFACE_NAMES, SurfacePoints
from gearwear.design.twist import Toothing, drawn_height, refuse
from gearwear.diagnose.active_face import ActiveFace
from gearwear.diagnose.effects.base import MADE, MEASURED, SCALE_LIMIT, Context, Kind
from gearwear.diagnose.loop import Loop, make_context
from gearwear.errors import check_kind
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.end_edge import EndEdge
from gearwear.placing.in_cells import InCells
from gearwear.placing.layers import how_far_apart, layers_apart, said_of_layers
from gearwear.placing.low_tips import below_tips
from gearwear.placing.mark import SeenMark
from gearwear.placing.pose import Pose
from gearwear.placing.proportion import common_ratio
from gearwear.placing.root import Root
from gearwear.placing.side_maps import common_fillet
from gearwear.placing.tip_edge import TipEdge
from gearwear.placing.views import PlacedScan, turned
from gearwear.scan.types import Scan
from gearwear.scan.views import views_of
from gearwear.threads import on_one_thread
from gearwear.wear.breakage import (
    Borders,
    Broken,
    broken_sentences,
    find_fractures,
    flanks_gone,
    measure_broken,
    on_stumps,
    with_borders,
)
from gearwear.wear.section_sums import SectionBand, SectionSums

Progress = Callable[[str], None]
"""Told the name of each station as it begins."""

LEAST_BROKEN_STDS = 3.0
"""Standard deviations that a piece must be large to be called broken off."""


@dataclass(frozen=True, slots=True)
class FinalPlace:
    """A scan where the loop left it.

    Parameters
    ----------
    lying : InCells
        All used points.
    pose : Pose
        design = rotation · scan + translation.
    cells : Cells
        As measured.
    sections : SectionSums or None
        Of a streamed scan: sums over all its points without what measurement added; `lying` is its sample.
    """

    lying: InCells
    pose: Pose
    cells: Cells
    sections: SectionSums | None = None


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class MeasuredGear(Card):
    """A scan on its design.

    Parameters
    ----------
    design : Design
        One gear or a pair.
    scans : tuple of Scan
        As read.
    part : str
        Which gear of the design was scanned, "pinion" or "gear".
    root : Root
        The root that the scan shows, and the gear that has it.
    tip_edge : TipEdge
        The edges between flanks and tips that it shows; the gear of `root` has them.
    end_edge : EndEdge
        Those between flanks and the ends of the face.
    placed : PlacedScan
        Before the loop.
    context : Context
        What effects need to know.
    first : Cells
        Before the loop.
    loop : Loop or None
        None where it was left out.
    final : FinalPlace
        After the loop.
    broken : tuple of Broken
        What is broken off, and teeth that were not seen; the points of fractures are not in `placed` nor `located`.
    fracture_points : int
        How many these are.
    undecided : tuple of MeasuredGear
        The same scan with other sides worn throughout, as far as the scan does not exclude them.
    streamed : Streamed or None
        All points of a scan of which `placed` and `final` hold a sample; their cells are of all.
    mark : SeenMark or None
        What told tooth 1, where the design states a mark.
    """

    design: Design
    scans: tuple[Scan, ...]
    part: str
    root: Root
    tip_edge: TipEdge
    end_edge: EndEdge
    placed: PlacedScan
    context: Context
    first: Cells
    loop: Loop | None
    final: FinalPlace
    broken: tuple[Broken, ...] = ()
    fracture_points: int = 0
    undecided: tuple[MeasuredGear, ...] = ()
    streamed: Streamed | None = None
    mark: SeenMark | None = None

    @property
    def gear(self) -> Gear:
        """The scanned gear's design, with the root, the tip edges and the face width that the scan shows."""
        return self.root.gear

    @property
    def located(self) -> SurfacePoints:
        """All used points in the final pose."""
        return self.final.lying.points

    @property
    def pose(self) -> Pose:
        """Final: design = rotation · scan + translation."""
        return self.final.pose

    @property
    def cells(self) -> Cells:
        """In the final pose, as measured."""
        return self.final.cells

    def headline(self) -> str:
        files = ", ".join(Path(file).name for scan in self.scans for file in scan.files)
        return f"{files} on the {self.part} of {self.gear.teeth} teeth, {len(self.located):,} points"

    def rows(self) -> list[CardRow]:
        loop = "not closed yet (find_effects)" if self.loop is None else self.loop.headline()
        return [("registration", self.placed.registration.headline()), ("loop", loop), *(("note", note) for note in self.notes)]

    @property
    def noise(self) -> float:
        """Scatter of points inside cells, mm."""
        return max(self.placed.registration.noise, LEAST_NOISE)

    @property
    def planar(self) -> bool:
        """True for a planar section."""
        return self.scans[0].planar

    @property
    def worn_sides(self) -> frozenset[Side]:
        """Sides worn throughout and left out as datum."""
        datum = self.placed.registration.datum
        return sides_of(datum.worn_side) if self.loop is None else self.loop.worn_sides

    @property
    def faces(self) -> tuple[ActiveFace, ...]:
        """Where the mate ran, of sides of which flanks stand beside it as they were made; none where no loop was closed."""
        return () if self.loop is None else self.loop.context.faces

    @property
    def scale(self) -> float:
        """By what ratio the scan was found to be too large; 0 where it was not, or no loop was closed."""
        return 0.0 if self.loop is None else self.loop.scale

    @property
    def gone(self) -> Bools:
        """Cells of the sides that are broken off, (teeth, 2, rows, columns)."""
        return flanks_gone(self.broken, self.cells.grid)

    @property
    def level_std(self) -> tuple[float, float]:
        """How well the level of all left and of all right flanks is known, mm; 0 where no loop was closed."""
        return (0.0, 0.0) if self.loop is None else self.loop.level_std

    @property
    def notes(self) -> tuple[str, ...]:
        """Doubts and assumptions, each a sentence; those that change what the numbers mean come first."""
        return (*self.doubts, *self.remarks)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Notes without which numbers would be taken for what they are not."""
        placed = doubts_of(self.gear, self.design.gears[self.part], self.placed, self.noise)
        return (
            *placed,
            *(said_of_scale(self.scale) if self.design.scanner.scale_limit is None else ()),
            *said_of_layers(self.first, self.layered),
            *broken_sentences(self.broken),
            *self.placed.registration.notes,
        )

    @property
    def layered(self) -> Bools:
        """Teeth on which views that were put together in one file lie apart, (teeth,)."""
        return layers_apart(self.first)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Notes on how the numbers came about."""
        smoothing = (SMOOTHED,) if self.context.smoothed else ()
        if self.context.views_apart > 0.0 and not self.layered.any():
            smoothing = (VIEWS_MAY_LIE_APART,)
        sample = () if self.streamed is None else (sample_note(len(self.streamed.source.chunks), len(self.scans[0].points)),)
        told = None if self.mark is None else self.mark.sentence
        edges = self.tip_edge.words(), self.end_edge.words()
        return (*sample, *smoothing, *filter(None, [*edges, self.root.words(), told]), *self.design.datum.words)

    @property
    def points(self) -> int:
        """Points read."""
        return sum(scan.read for scan in self.scans)

    @property
    def used(self) -> int:
        """Points in the cells."""
        return int(np.nansum(self.cells.count))

    @property
    def other(self) -> int:
        """Points on no surface of the design."""
        return int((self.placed.located.surface == OTHER).sum()) if self.streamed is None else self.streamed.first.other

    @property
    def rejected(self) -> dict[str, int]:
        """Points left out, by reason."""
        reasons: dict[str, int] = {}
        for scan in self.scans:
            for reason, count in scan.rejected.items():
                reasons[reason] = reasons.get(reason, 0) + count
        if self.placed.thinned:
            reasons["overlap_of_views"] = self.placed.thinned
        if self.fracture_points:
            reasons["fracture"] = self.fracture_points
        located = len(self.placed.located) if self.streamed is None else self.streamed.first.located
        strays = located - self.used - self.other
        return reasons | ({"stray": strays} if strays > 0 else {})

    @property
    def coverage(self) -> dict[str, float]:
        """Share of each surface that was seen, by its name; flanks also by side."""
        coverage, there = {}, self.cells.grid.on_teeth
        for code, (start, size) in self.cells.grid.blocks.items():
            name = SURFACE_NAMES[code]
            if name == "bore" and self.gear.body_radius <= 0.0:
                continue
            seen = self.cells.count[start : start + size][there[start : start + size]] > 0
            coverage[name] = float(seen.mean())
            if name == "flank":
                side = self.cells.points.side[start : start + size][there[start : start + size]]
                coverage |= {f"flank_{which}": float(seen[side == which].mean()) for which in Side}
        return coverage

    @property
    def flanks(self) -> SurfacePoints:
        """The points on flanks, without what measurement added and without strays."""
        flank = self.final.lying.flanks()
        return flank.with_deviation(self.straightened(flank))

    @property
    def section_band(self) -> SectionBand:
        """Where the thickness of sections is measured."""
        return SectionBand.of(self.gear, z=np.array([drawn_height(self.gear)]) if self.planar else None)

    @property
    def sections(self) -> SectionSums:
        """Sums over the points of sections, without what measurement added and without strays."""
        if self.final.sections is not None:
            return self.final.sections
        cut = Cut(self.section_band, self.straightened)
        return cut.of(self.final.lying.flanks(cut.holds(self.located)))

    @property
    def raw_sections(self) -> SectionSums:
        """The same as registration placed the points: what measurement added is in them."""
        if self.streamed is not None:
            return self.streamed.first.sections
        band, located = self.section_band, self.placed.located
        return SectionSums.of(in_cells(located, self.cells.grid).flanks(band.holds(located)), band)

    def straightened(self, points: SurfacePoints) -> Floats:
        """Deviations without what measurement added, mm."""
        return points.deviation if self.loop is None else points.deviation - self.loop.deviation(points, MEASURED)

    @property
    def corrected(self) -> Cells:
        """The cells without what measurement added."""
        return self.cells.with_deviation(self.cells.points.deviation - self._part_of(MEASURED))

    @property
    def manufacture(self) -> Floats:
        """Deviation of the as-made gear from the design by the effects found, cell by cell, (m,) mm."""
        return self._part_of(MADE)

    @property
    def raised(self) -> Floats:
        """By how much flanks that are no datum stand higher as made than the effects have it, cell by cell, (m,) mm (`UntoldFlanks`)."""
        untold = None if self.loop is None else self.loop.untold
        return np.zeros(len(self.cells.count)) if untold is None else untold.raised

    @property
    def as_made(self) -> Cells:
        """The cells without measurement, manufacture and unexplained structure: what is left is wear and noise."""
        unexplained = self.raised
        if self.loop is not None:
            unexplained = np.sum([*(pattern.field for pattern in self.loop.patterns), unexplained], axis=0)
        elif not self.root.fits_design:  # what all fillets have is how they were made, as the loop has it
            unexplained = common_fillet(self.cells)
        corrected = self.corrected
        return corrected.with_deviation(corrected.points.deviation - self.manufacture - unexplained)

    def _part_of(self, kinds: frozenset[Kind]) -> Floats:
        seen = self.cells.seen
        amount = np.zeros(len(seen))
        if self.loop is not None:
            amount[seen] = self.loop.deviation(self.cells.points.take(seen), kinds)
        return amount


@on_one_thread
def register(design: Design, scans: Scan | Sequence[Scan], part: str | None = None, grid: CellGrid | None = None) -> MeasuredGear:
    """Put scans on the design.

    Parameters
    ----------
    design : Design
        One gear or a pair.
    scans : Scan or sequence of Scan
        One scan, or several views of one gear.
    part : {"pinion", "gear"} or None
        Which one was scanned; None: the one whose size fits.
    grid : CellGrid or None
        Cells to bin in, of a gear that has the same tip edges; None: from the number of points.

    Returns
    -------
    MeasuredGear
        Without a loop: as measured.

    Raises
    ------
    InputError
        If there is no scan, or planar sections stand beside others, or the scan is of something else.
    """
    check_kind(grid, CellGrid | None, "grid", "a CellGrid, or None,")
    check_part(design, part)
    scans = views_of(scans)
    check_streamed(scans, design.datum)
    scans, design = calibrated(scans, design)
    scans = at_20_degrees(scans, design.datum)
    if scans[0].planar:
        for gear in design.gears.values():
            refuse(gear, "a planar section", Toothing.DOUBLE_HELICAL)
    name, drawn, placed = placed_as(design, scans, [part] if part else by_size(design, scans))
    smoothed = was_smoothed(placed.located, len(scans))
    if grid is None:
        placed, tip = on_its_tips(placed, scans, drawn, smoothed)
    else:
        placed, tip = on_tips_of(grid.gear, placed, scans, drawn)
    placed, end = on_its_ends(placed, scans, tip.gear, smoothed)
    placed, root = on_its_root(placed, scans, end.gear)
    motion, mark = tooth_1_of(design.datum, scans, placed, root.gear)
    if motion is not None:
        placed = _laid(placed, scans, root, motion)
    if design.datum.leaves_out:
        scans = without_ignored(scans, placed, root.gear, design.datum)
        placed = _laid(placed, scans, root, Pose.identity())
    return replace(_in_cells(design, scans, name, placed, root, (tip, end), grid, smoothed), mark=mark)


@on_one_thread
def laid(measured: MeasuredGear, motion: Pose) -> MeasuredGear:
    """A registered scan with its gear laid otherwise on the design: another tooth is tooth 1, or the other end is up.

    Parameters
    ----------
    measured : MeasuredGear
        As `register` gives it.
    motion : Pose
        A symmetry of the gear, in the design frame.
    """
    placed = _laid(measured.placed, measured.scans, measured.root, motion)
    edges = measured.tip_edge, measured.end_edge
    grid, smoothed = measured.first.grid, measured.context.smoothed
    again = _in_cells(measured.design, measured.scans, measured.part, placed, measured.root, edges, grid, smoothed)
    return replace(again, mark=measured.mark)


def _laid(placed: PlacedScan, scans: Sequence[Scan], root: Root, motion: Pose) -> PlacedScan:
    return laid_on(root.gear, scans, no_datum(root), turned(placed, motion))


def _in_cells(
    design: Design,
    scans: tuple[Scan, ...],
    name: str,
    placed: PlacedScan,
    root: Root,
    edges: tuple[TipEdge, EndEdge],
    grid: CellGrid | None,
    smoothed: bool,
) -> MeasuredGear:
    """A placed scan without what is broken off, in cells."""
    gear, planar = root.gear, scans[0].planar
    on = int((placed.located.surface != OTHER).sum())  # a table or a shaft does not make the gear denser
    chunks = scans[0].chunks
    if chunks is not None:
        on = round(on * len(chunks) / len(placed.located))
    grid = grid or CellGrid.for_located(placed.located, gear, on, planar)
    points = placed.measured
    fractures = find_fractures(points, gear, planar)
    border = with_borders(points, fractures, gear, placed.registration.noise)
    broken = measure_broken(points, grid.index(placed.located), fractures, border, grid, placed.registration.noise)
    broken = tuple(piece for piece in broken if not piece.seen or piece.volume > LEAST_BROKEN_STDS * piece.std)
    broken = tuple(piece for piece in broken if piece.tooth not in design.datum.ignore_teeth)
    border |= on_stumps(points, broken, grid)
    if border.any():
        placed = replace(placed, located=placed.located.take(~border))
    streamed = None
    if chunks is None:
        placed = replace(placed, located=below_tips(placed.located, gear, placed.registration.noise))
        lying = in_cells(placed.located, grid)
        first = lying.means()[0]
    else:
        borders = Borders(grid, placed.registration.noise, tuple((tooth, points[index]) for tooth, index in fractures), broken)
        placed, streamed = first_pass(
            chunks,
            placed,
            borders,
            grid,
            clip_of(placed.located),
            SectionBand.of(gear),
            no_datum(root) or unstated_root(design.gears[name]),
        )
        first, lying = streamed.first.cells, in_cells(placed.located, grid)
    context = _context(first, placed, design, name, planar)
    absent = frozenset(piece.tooth for piece in broken if piece.whole)
    stitched = design.scanner.stitched or len(scans) > 1
    apart = how_far_apart(first) if len(scans) == 1 and stitched else 0.0
    context = replace(
        context, fillets_told=root.told_by_levels(placed.registration.noise), absent=absent, views_apart=apart,
        turntable=design.scanner.turntable, stitched=stitched, smoothed=smoothed,
    )  # fmt: skip
    final = FinalPlace(lying, placed.registration.pose, first)
    return MeasuredGear(
        design=design, scans=scans, part=name, root=root, tip_edge=edges[0], end_edge=edges[1], placed=placed, context=context, first=first, loop=None, final=final,
        broken=broken, fracture_points=int(border.sum()) if streamed is None else streamed.fracture_points, streamed=streamed,
    )  # fmt: skip


def _context(cells: Cells, placed: PlacedScan, design: Design, part: str, planar: bool) -> Context:
    mate = design.mate_of(part)
    line = None
    if mate is not None:
        gear, centre = design.gears[part], design.centre_distance
        ring = gear.orientation * mate.orientation  # -1 where one of both is one
        length = math.sqrt(centre**2 - (gear.base_radius + ring * mate.base_radius) ** 2)
        line = (ring * mate.teeth / gear.teeth, mate.orientation * length)
    limit = design.scanner.scale_limit
    if limit is None and (ratio := common_ratio(placed.located, cells.grid.gear)) is not None:
        limit = max(SCALE_LIMIT, 2.0 * abs(ratio))  # what a calibrated scanner may do is no limit to one that is not
    return make_context(cells, placed.registration.pose.rotation, planar, line, limit)

"""The comparison, station by station: from scans and a design to `Results`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.comparison.before import grown_since, told_by_both, unworn_gear, what_changed
from gearwear.comparison.closing import measure
from gearwear.comparison.consequences import Change, meshing_changes, wear_changes
from gearwear.comparison.contact_readings import ContactNumbers, OtherReadings, ReadGear, contact_limits, other_readings
from gearwear.comparison.contributions import PutBack, SideFields, put_back, side_fields
from gearwear.comparison.measured_gear import MeasuredGear, Progress
from gearwear.comparison.notes import in_accord, notes_of
from gearwear.comparison.results import PairResult, Results, WearResult
from gearwear.comparison.same_teeth import SameTeeth, kept_patterns
from gearwear.comparison.thick import thickness_and_changes
from gearwear.comparison.worn_pair import RunningGear
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import SectionLoss, ToothProfiles
from gearwear.design.side import Side, sides_of
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.found import Loop
from gearwear.errors import InputError
from gearwear.inspection.halves import Half, inspect_half
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.settings import Settings
from gearwear.loaded.steel import Material
from gearwear.loaded.study import LoadedStudy
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing, exact_meshing
from gearwear.meshing.published import published_meshing
from gearwear.meshing.shafts import take_up
from gearwear.meshing.slices import common_width
from gearwear.meshing.spread import ContactSpread
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.pose import Pose
from gearwear.placing.refusal import seen_radii
from gearwear.placing.side_maps import common_fillet
from gearwear.processors import beside, each
from gearwear.running.forecast import run_on
from gearwear.running.found import SecondLoop
from gearwear.running.study import trace_running
from gearwear.scan.types import Scan
from gearwear.threads import on_one_thread
from gearwear.wear.breakage import without_broken
from gearwear.wear.profiles import ProfileNodes, without_added_metal, worn_profiles
from gearwear.wear.regions import Wear, find_wear
from gearwear.wear.smooth import WornSurface, smooth_surface
from gearwear.wear.solid import PlainBoolean, Solids, Triangles, gear_triangles, signed_difference, worn_volume
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.volume import StiffnessOf
from gearwear.wear_law.sides import fit_laws
from gearwear.wear_law.study import Ahead, WearStudy, as_made_points, study_wear

DRAWS = 64
"""Worn surfaces drawn to see how far their scatter moves the contact."""
NO_LOAD = "the design states no [load]"


@on_one_thread
def compare(
    design: Design,
    scans: Sequence[str | Path | Scan],
    part: str | None = None,
    before: Sequence[str | Path | Scan] = (),
    units: str = "mm",
    loop: bool = True,
    inspection: bool = True,
    ahead: Ahead | None = None,
    progress: Progress = lambda station: None,
    stream: bool | None = None,
) -> Results:
    """Compare a scan with its design.

    Parameters
    ----------
    design : Design
        One gear or a pair.
    scans : sequence of path or Scan
        One scan, or several views of one gear.
    part : {"pinion", "gear"} or None
        Which one was scanned; None: the one whose size fits.
    before : sequence of path or Scan
        Scan of the same gear unworn, or its views.
    units : str
        Unit of the files.
    loop : bool
        Whether to look for effects beyond registration.
    inspection : bool
        Whether to evaluate ISO 1328 deviations.
    ahead : Ahead or None
        What to forecast from the fitted wear law; None: nothing.
    progress : callable
        Told each station.
    stream : bool or None
        Whether only a sample of the points is held in memory, and all of them go into cells; None: where there are many. The scan before
        wear goes the same way.

    Returns
    -------
    Results

    Raises
    ------
    InputError
        If a file or a value is wrong, or the scan is of something else.
    """
    for name, drawn in design.gears.items():
        if name == part or len(design.gears) == 1:
            try:
                drawn.section_area()  # a ring without its outside has none: said before the work, not after it
            except InputError as error:
                raise InputError(f"{design.source}: {error}" if design.source else str(error)) from None
    scanned = _scanned(design, scans, part, before, units, loop, stream, progress)
    progress("wear")
    wearless: list[Callable[[], Any]] = [partial(_inspected, scanned.measured, inspection), partial(_remarks, scanned.measured)]
    # What needs no wear waits for the contact, beside which there is room; where there is none, it fills up what finding the wear leaves.
    early, late = (wearless, []) if design.pair is None else ([], wearless)
    calls: list[Callable[[], Any]] = [
        partial(scanned.find, scanned.as_made),
        partial(without_loop, scanned.measured, scanned.unworn),
    ]
    wear, wear_before, *before_contact = each([*calls, *early])
    progress("worn solid")
    lost = Lost.of(scanned, wear, wear_before, DRAWS if design.pair is not None else 0)
    exact = None
    if design.pair is not None:
        exact = exact_meshing(design.gears["pinion"], design.gears["gear"], design.centre_distance)
    run = Run.of(scanned, lost)
    with beside([*_apart_from_contact(scanned, lost, exact), *late]) as others:
        measured, points = scanned.measured, scanned.as_made_points
        met = None if design.pair is None else _against_mate(design, scanned, lost, run, points, ahead, progress)
        law = None if met is None else met.law
        laws = fit_laws(wear, points, scanned.as_made, measured.context, measured.loop, scanned.scatter, law)
        progress("thickness and inspection")
        (solids, boolean), (thickness, thicker), changes, (undecided, read), *beside_contact = others()
    inspected, remarks = (*before_contact, *beside_contact)
    most = thickness.below_drawing()
    thinner = None if most is None else SectionLoss(most.value, most.tooth, most.at_z)
    pair = None if met is None or exact is None else _pair(design, exact, met, thickness, thinner, read)
    measured = in_accord(measured, wear, scanned.unworn is not None)
    return Results(
        measured=measured,
        seen=seen_radii(measured.placed, measured.gear),
        wear=WearResult(
            found=wear, before_loop=wear_before, laws=laws, thickness=thickness, worn=lost.worn, present=replace(run.gear.present, lost=thinner),
            solids=solids, boolean=boolean, undecided=undecided,
        ),
        pair=pair,
        inspection=inspected[0] if len(inspected) == 1 else None,
        halves=inspected if len(inspected) == 2 else (),
        changes=(*changes, *thicker, *(() if met is None else met.changes)),
        notes=notes_of(design, measured, remarks, wear, scanned.same, pair, ahead, thickness.seam, scanned.grown),
        before_files=() if scanned.unworn is None else tuple(name for scan in scanned.unworn.scans for name in scan.files),
        same_teeth=scanned.same,
        patterns=kept_patterns(measured),
        before_sha256=() if scanned.unworn is None else tuple(digest for scan in scanned.unworn.scans for digest in scan.sha256),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Scanned:
    """What wear is found on.

    Parameters
    ----------
    measured : MeasuredGear
        The scanned gear.
    unworn : MeasuredGear or None
        Of the scan before wear.
    same : SameTeeth or None
        How its teeth were told.
    worn_sides : frozenset of Side
        Worn throughout.
    as_made : Cells
        Deviations from the gear as it was made: from that before wear where it was scanned.
    scatter : float
        Of the points of `as_made`, mm.
    """

    measured: MeasuredGear
    unworn: MeasuredGear | None
    same: SameTeeth | None
    worn_sides: frozenset[Side]
    as_made: Cells
    scatter: float

    def find(self, cells: Cells, limits: bool = True, errors: bool = True, as_stiff: StiffnessOf | None = None) -> Wear:
        """The wear in some cells of this scan; options as `find_wear` has them."""
        loop, gone = self.measured.loop, self.measured.gone
        return find_wear(cells, self.scatter, self.worn_sides, loop, limits=limits, gone=gone, errors=errors, as_stiff=as_stiff)

    @property
    def grown(self) -> Wear | None:
        """Where the scan has more metal than that before wear; None without one."""
        return None if self.unworn is None else grown_since(self.measured, self.unworn, self.as_made, self.scatter)

    @property
    def as_made_points(self) -> SurfacePoints:
        """Points of flanks, deviations from the gear as it was made."""
        lying = self.measured.final.lying
        return as_made_points(lying.points, lying.cell, self.measured.cells, self.as_made, self.measured.loop)


def _scanned(
    design: Design,
    scans: Sequence[str | Path | Scan],
    part: str | None,
    before: Sequence[str | Path | Scan],
    units: str,
    loop: bool,
    stream: bool | None,
    progress: Progress,
) -> Scanned:
    """Scan and scan before wear, measured; arguments as those of `compare`."""
    measured = measure(design, scans, part, units, loop, progress=progress, stream=stream)
    if not before:
        return Scanned(measured, None, None, measured.worn_sides, measured.as_made, measured.noise)
    progress("scan before wear")
    unworn, same = unworn_gear(design, measured, before, units, loop, stream)
    measured, worn_sides = told_by_both(measured, unworn)
    scatter = float(np.hypot(measured.noise, unworn.noise))
    return Scanned(measured, unworn, same, worn_sides, what_changed(measured, unworn), scatter)


@dataclass(frozen=True, slots=True)
class Lost:
    """The wear, and what goes on from it.

    Parameters
    ----------
    wear, before_loop : Wear
        With the effects taken out, and as the raw scan gives it.
    effects : tuple of PutBack
        Those effects.
    taken_out : bool
        Whether anything was taken out: effects, or patterns without a name.
    surface : WornSurface
        The worn surface, smooth.
    worn : ToothProfiles
        The gear with it.
    """

    wear: Wear
    before_loop: Wear
    effects: tuple[PutBack, ...]
    taken_out: bool
    surface: WornSurface
    worn: ToothProfiles

    @classmethod
    def of(cls, scanned: Scanned, wear: Wear, before_loop: Wear, draws: int) -> Lost:
        """With so many surfaces drawn from what is known of the worn one."""
        measured, grid = scanned.measured, scanned.measured.cells.grid
        effects, loop = put_back(measured), measured.loop
        surface = _smooth(measured, wear, scanned.scatter, draws)
        worn = worn_profiles(ProfileNodes.of(grid), without_added_metal(surface.depth, wear.side_maps.area))
        return cls(wear, before_loop, effects, loop is not None and bool(effects or loop.patterns), surface, worn)


def _apart_from_contact(scanned: Scanned, lost: Lost, exact: ExactMeshing | None) -> list[Callable[[], Any]]:
    """Calls that need neither the contact nor one another, the longest first: solids, thickness with what the effects change of it, what they change of
    the wear, and the wear with other sides worn throughout."""
    measured, unworn = scanned.measured, scanned.unworn
    left_in = lost.effects if lost.taken_out else None
    # As stiff as with the effects taken out: what differs is what an effect does, not which stiffness is a little likelier.
    quick = partial(scanned.find, limits=False, errors=False, as_stiff=lost.wear.as_stiff)
    return [
        partial(_solid, measured, lost.worn, lost.wear),
        partial(thickness_and_changes, measured, unworn, left_in, lost.wear),
        tuple
        if left_in is None
        else partial(
            wear_changes, measured, left_in, scanned.as_made, scanned.scatter, quick, lost.wear, lost.before_loop, unworn
        ),
        partial(_otherwise, scanned, lost, exact),
    ]


@dataclass(frozen=True, slots=True)
class Run:
    """The scanned gear for contact, and what the effects do to its tooth sides."""

    gear: RunningGear
    fields: SideFields

    @classmethod
    def of(cls, scanned: Scanned, lost: Lost) -> Run:
        """With the worn surface, less what is broken off it."""
        measured, grid, surface = scanned.measured, scanned.measured.cells.grid, lost.surface
        fields = side_fields(measured, lost.effects, lost.wear if scanned.unworn is None else None)
        there = WornSurface(*(without_broken(depths, measured.broken, grid) for depths in (surface.depth, surface.draws)))
        return cls(RunningGear.of(grid, there, lost.wear.side_maps.area, fields), fields)


@dataclass(frozen=True, slots=True)
class Met:
    """The scanned gear against its mate, rigid and under load, the wear law, how the pair ran, and what the effects change of it."""

    contact: ContactResult
    spread: ContactSpread
    loaded: LoadedStudy | None
    law: WearStudy
    ran: SecondLoop | str
    changes: tuple[Change, ...]


def _against_mate(
    design: Design, scanned: Scanned, lost: Lost, run: Run, points: SurfacePoints, ahead: Ahead | None, progress: Progress
) -> Met:
    """The gear in mesh; `points` are those of its flanks, with deviations from the gear as it was made."""
    progress("meshing")
    measured, wear = scanned.measured, lost.wear
    side, mate = wear.drive_side, design.mate_of(measured.part)
    assert mate is not None
    contact, spread = run.gear.against_mate(design, measured, side)
    study = partial(study_wear, wear, points, scanned.as_made)
    law = study(side, mate, design.centre_distance, measured.loop, scanned.scatter, ahead)
    progress("how the pair ran")
    both = design.load is not None and len({region.side for region in wear.regions}) == 2
    other = study(side.opposite, mate, design.centre_distance, measured.loop, scanned.scatter) if both else None
    law, ran = _running(design, law, other, scanned.as_made, mate, measured.loop, scanned.scatter)
    loaded = run.gear.under_load(design, measured, side)
    made = run.gear.as_made(design, measured, side) if contact.variants else None
    changes = meshing_changes(measured, lost.effects, run.fields, contact, made, design.centre_distance) if lost.taken_out else ()
    return Met(contact, spread, loaded, law, ran, changes)


def _otherwise(scanned: Scanned, lost: Lost, exact: ExactMeshing | None) -> tuple[tuple[tuple[float, float], ...], OtherReadings]:
    """Worn volume and its standard deviation with other sides worn throughout, mm³, and what the scan leaves open of the contact."""
    measured, unworn_seen = scanned.measured, scanned.unworn is not None
    gears = () if unworn_seen else measured.undecided
    wears = [find_wear(gear.as_made, gear.noise, gear.worn_sides, gear.loop, limits=False, gone=gear.gone) for gear in gears]
    read = OtherReadings()
    if exact is not None:
        told = ReadGear(measured, lost.wear, lost.surface.depth, unworn_seen)
        others = [ReadGear(gear, wear, _smooth(gear, wear, gear.noise).depth) for gear, wear in zip(gears, wears, strict=True)]
        read = other_readings(measured.design, told, others, exact.path)
    return tuple((wear.volume, wear.volume_std) for wear in wears), read


def _smooth(measured: MeasuredGear, wear: Wear, scatter: float, draws: int = 0) -> WornSurface:
    """The worn surface, smooth, and so many drawn from what is known of it."""
    covariance = None if measured.loop is None else measured.loop.covariance
    return smooth_surface(wear, measured.cells.grid, scatter, covariance, draws)


def _remarks(measured: MeasuredGear) -> tuple[str, ...]:
    """Remarks on the scan, for which neighbouring points are compared."""
    return measured.remarks


def _inspected(measured: MeasuredGear, wanted: bool) -> tuple[Inspection, ...]:
    """ISO 1328 deviations of the gear, or of each half of a double helical one; none of a planar section."""
    if not wanted or measured.planar:
        return ()
    settings = Settings(
        noise=measured.noise, pose_covariance=measured.placed.registration.covariance, scale_std=measured.design.scale_std
    )
    halves = tuple(Half) if measured.gear.spec.gap > 0.0 else (None,)
    flanks = measured.flanks
    return tuple(inspect_half(flanks, measured.gear, half, settings) for half in halves)


def without_loop(measured: MeasuredGear, unworn: MeasuredGear | None = None) -> Wear:
    """What the wear would have been without the loop."""
    noise, cells = measured.noise, measured.first
    if unworn is not None:
        noise = float(np.hypot(noise, unworn.noise))
        made = unworn.first.points.deviation
        cells = cells.with_deviation(cells.points.deviation - np.where(np.isfinite(made), made, 0.0))
    elif not measured.root.fits_design:
        cells = cells.with_deviation(cells.points.deviation - common_fillet(cells))
    registration = measured.placed.registration
    find = partial(find_wear, limits=False, gone=measured.gone)
    wear, known = find(cells, noise, sides_of(registration.datum.worn_side)), []
    for side, motion in registration.without:  # with the side worn throughout, and the pose that goes with it
        moved = cells.motion @ motion
        other = find(cells.with_deviation(cells.points.deviation + moved), noise, sides_of(side))
        known.append(math.hypot(other.volume_std, other.volume - wear.volume))
    return replace(wear, volume_std=max([wear.volume_std, *known]))


def _running(
    design: Design, law: WearStudy, other: WearStudy | None, as_made: Cells, mate: Gear, loop: Loop | None, noise: float
) -> tuple[WearStudy, SecondLoop | str]:
    """How the pair ran under the load that the design states, and the wear law with the forecast that follows from it."""
    load, pinion = design.load, design.gears["pinion"]
    if load is None:
        return law, NO_LOAD
    width, material = common_width(pinion, design.gears["gear"]), Material(load.elastic_modulus, load.poisson)
    per_width = load.force(pinion.base_radius, width) / width
    ran = trace_running(law, as_made, mate, design.centre_distance, per_width, material, loop, noise, other, load.misalignment)
    return (law if isinstance(ran, str) else run_on(law, ran, per_width, material)), ran


def _solid(measured: MeasuredGear, worn: ToothProfiles, wear: Wear) -> tuple[Solids | None, PlainBoolean | None]:
    """Worn gear and worn volume, and the boolean with the user's own triangles; neither of a planar section."""
    if measured.planar:
        return None, None
    triangles = gear_triangles(worn)
    bodies = worn_volume(worn, wear.least_seen)
    boolean = None
    if len(measured.scans) == 1:
        boolean = _plain_boolean(measured.scans, measured.pose, measured.gear, measured.cells.grid)
    return Solids(triangles, tuple(bodies)), boolean


def _plain_boolean(scans: Sequence[Scan], pose: Pose, gear: Gear, grid: CellGrid) -> PlainBoolean | None:
    """The boolean with the user's own triangles, where they are closed."""
    scan = scans[0]
    if scan.triangles is None or gear.body_radius > 0.0 or gear.spec.internal:
        return None
    nominal = gear_triangles(worn_profiles(ProfileNodes.of(grid), np.zeros(grid.side_shape)))
    user = Triangles(pose.apply(scan.points), scan.triangles)
    try:
        removed, _, pieces = signed_difference(nominal, user)
    except InputError:
        return None  # not closed: the usual case for a scan, and no fault of the user's
    # Against the exact volume: the chords of the nominal triangles cut some mm³ off the gear.
    return PlainBoolean(removed, gear.volume - user.volume, pieces)


def _pair(
    design: Design, exact: ExactMeshing, met: Met, thickness: SectionThickness, thinner: SectionLoss | None, read: OtherReadings
) -> PairResult:
    pair, contact = design.pair, met.contact
    assert pair is not None
    pinion, gear, centre = design.gears["pinion"], design.gears["gear"], design.centre_distance
    worst = max([0.0, *(tooth.greatest_loss for tooth in thickness.teeth() if tooth.seen)])
    play = contact.backlash_min.value, contact.backlash_max.value
    ring = gear.spec.internal
    return PairResult(
        design=exact,
        published=None if ring else published_meshing(pinion, gear, centre, worst, pair.backlash_allowance, pair.baseline),
        contact=contact,
        spread=met.spread,
        limits=contact_limits(ContactNumbers.of(contact, exact.path), read, met.spread),
        shafts=None if thinner is None or not thinner.value > 0.0 or ring else take_up(pinion, gear, centre, play, thinner.value),
        drive_side=met.law.side,
        law=met.law,
        loaded=met.loaded,
        running=met.ran,
    )

"""The comparison, station by station: from scans and a design to `Results`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.before import told_by_both, unworn_gear, what_changed
from gearwear.comparison.closing import measure
from gearwear.comparison.consequences import Change, meshing_changes, thickness_changes, wear_changes
from gearwear.comparison.contributions import PutBack, put_back, side_fields
from gearwear.comparison.measured_gear import MeasuredGear, Progress
from gearwear.comparison.open_volume import even_loss, level_open, thinning_open
from gearwear.comparison.placed_notes import THINNED, alone
from gearwear.comparison.results import PairResult, Results, WearResult
from gearwear.comparison.same_teeth import kept_patterns
from gearwear.comparison.worn_pair import RunningGear
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.profiles import ToothProfiles
from gearwear.design.quantity import counted, significant
from gearwear.design.side import Side, sides_of
from gearwear.design.spec import ScannerSpec
from gearwear.design.surface import FILLET, FLANK, TIP, SurfacePoints, flank_points
from gearwear.diagnose.effects.base import MADE
from gearwear.diagnose.found import Loop
from gearwear.errors import InputError
from gearwear.inspection.halves import Half, inspect_half
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.settings import Settings
from gearwear.loaded.steel import Material
from gearwear.loaded.study import load_left_out
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.published import published_meshing
from gearwear.meshing.shafts import take_up
from gearwear.meshing.slices import common_width
from gearwear.meshing.spread import ContactSpread
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.datum import LOW, Datum, bends_otherwise
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
from gearwear.wear.hollows import find_hollows
from gearwear.wear.profiles import ProfileNodes, without_added_metal, worn_profiles
from gearwear.wear.regions import UNIT, Wear, find_wear
from gearwear.wear.section_sums import SectionSums
from gearwear.wear.smooth import WornSurface, smooth_surface
from gearwear.wear.solid import PlainBoolean, Solids, Triangles, gear_triangles, signed_difference, worn_volume
from gearwear.wear.thickness import SectionThickness, thickness_of
from gearwear.wear.unmeasured import thinnest_unmeasured
from gearwear.wear_law.sides import fit_laws
from gearwear.wear_law.study import Ahead, WearStudy, as_made_points, study_wear

DRAWS = 64
"""Worn surfaces drawn to see how far their scatter moves the contact."""
HALVES = "double helical: taper, twist and feed marks are not looked for; the halves are inspected one by one"
NO_LOAD = "no load is stated: how the pair ran is traced with [load] in the design"
SECTION_WEIGHED = "[weighing] is left out: the gear was weighed, but a planar section has no volume"
"""Said of a weighed gear of which only a section was scanned."""
UNLIKE = 2.0
"""Factor between the noise found and the noise stated of the scanner from which it is said."""


@on_one_thread
def compare(
    design: Design,
    scans: Sequence[str | Path],
    part: str | None = None,
    before: Sequence[str | Path] = (),
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
    scans : sequence of path
        One scan, or several views of one gear.
    part : {"pinion", "gear"} or None
        Which one was scanned; None: the one whose size fits.
    before : sequence of path
        Scan of the same gear unworn, or its views.
    units : str
        Unit of the scans.
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
            drawn.section_area()  # a ring without its outside has none: said before the work, not after it
    measured, unworn, same = measure(design, scans, part, units, loop, progress=progress, stream=stream), None, None
    worn_sides = measured.worn_sides
    if before:
        progress("scan before wear")
        unworn, same = unworn_gear(design, measured, before, units, loop, stream)
        measured, worn_sides = told_by_both(measured, unworn)
    gear, noise, grid, planar = measured.gear, measured.noise, measured.cells.grid, measured.planar
    as_made, scatter = measured.as_made, noise
    if unworn is not None:
        as_made, scatter = what_changed(measured, unworn), float(np.hypot(noise, unworn.noise))

    progress("wear")
    find = partial(find_wear, noise=scatter, worn=worn_sides, loop=measured.loop, gone=measured.gone)
    wear, wear_before = each([partial(find, as_made), partial(without_loop, measured, unworn)])

    progress("worn solid")
    effects, changes = put_back(measured), tuple[Change, ...]()
    taken_out = measured.loop is not None and bool(effects or measured.loop.patterns)
    covariance = None if measured.loop is None else measured.loop.covariance
    surface = smooth_surface(wear, grid, scatter, covariance, DRAWS if design.pair is not None else 0)
    worn = worn_profiles(ProfileNodes.of(grid), without_added_metal(surface.depth, wear.side_maps.area))
    left_in, quick = effects if taken_out else None, partial(find, limits=False, errors=False)
    beyond: list[Callable[[], Any]] = [  # what needs neither the contact nor one another
        tuple
        if left_in is None
        else partial(wear_changes, measured, left_in, as_made, scatter, quick, wear, wear_before, unworn),
        partial(_thick, measured, unworn, left_in, wear),
        partial(_inspected, measured, inspection),
        partial(_solid, measured, worn, wear),
        partial(_undecided, measured.undecided if unworn is None else ()),
    ]
    with beside(beyond) as others:
        fields = side_fields(measured, effects)
        there = WornSurface(*(without_broken(depths, measured.broken, grid) for depths in (surface.depth, surface.draws)))
        running = RunningGear.of(grid, there, wear.side_maps.area, fields)
        points = as_made_points(measured.located, measured.cells, as_made, measured.loop)
        law: WearStudy | None = None
        if design.pair is not None:
            progress("meshing")
            side, mate = wear.drive_side, design.mate_of(measured.part)
            assert mate is not None
            contact, spread = running.against_mate(design, measured, side)
            study = partial(study_wear, wear, points, as_made)
            law = study(side, mate, design.centre_distance, measured.loop, scatter, ahead)
            progress("how the pair ran")
            both = design.load is not None and len({region.side for region in wear.regions}) == 2
            other = study(side.opposite, mate, design.centre_distance, measured.loop, scatter) if both else None
            law, ran = _running(design, law, other, as_made, mate, measured.loop, scatter)
            loaded = running.under_load(design, measured, side)
            made = running.as_made(design, measured, side) if contact.variants else None
            if taken_out:
                changes = meshing_changes(measured, effects, fields, contact, made, design.centre_distance)
        laws = fit_laws(wear, points, as_made, measured.context, measured.loop, scatter, law)
        progress("thickness and inspection")
        lost, (thickness, thicker), inspected, (solids, boolean), undecided = others()
    changes = (*lost, *thicker, *changes)
    pair = None
    if law is not None:
        pair = replace(_pair(design, contact, spread, law, thickness), loaded=loaded, running=ran)
    measured = in_accord(measured, wear, unworn is not None)
    return Results(
        measured=measured,
        seen=seen_radii(measured.placed, gear),
        wear=WearResult(
            found=wear, before_loop=wear_before, laws=laws, thickness=thickness, worn=worn, present=running.present,
            solids=solids, boolean=boolean, undecided=undecided,
        ),
        pair=pair,
        inspection=inspected[0] if len(inspected) == 1 else None,
        halves=inspected if len(inspected) == 2 else (),
        changes=changes,
        notes=(
            *measured.doubts,  # what changes the meaning of numbers first: a terminal shows the first few
            *((THINNED.format(thinning=gear.spec.thinning),) if thinning_open(measured, unworn is not None) else ()),
            *worn_notes(measured, wear, unworn is not None),
            *(() if same is None or same.sure else (same.sentence("the gear in the scan before wear"),)),
            *edge_notes(wear),
            *scanner_notes(design.scanner, measured.placed.registration.noise),
            *((SECTION_WEIGHED,) if design.weighing is not None and planar else ()),
            *load_left_out(design),
            *_no_forecast(pair, ahead),
            *_off_reference(gear),
            *dict.fromkeys((*measured.remarks, *design.warnings)),  # an assumed root is said by both
            *((HALVES,) if gear.spec.gap > 0.0 else ()),
            *(() if pair is not None else (alone(measured.context),)),
        ),
        before_files=tuple(str(path) for path in before),
        same_teeth=same,
        patterns=kept_patterns(measured),
        before_sha256=() if unworn is None else tuple(digest for scan in unworn.scans for digest in scan.sha256),
    )  # fmt: skip


def in_accord(measured: MeasuredGear, wear: Wear, before: bool = False) -> MeasuredGear:
    """The scan with its notes as the wear bears them out: a side that was left out as datum for its shape is said to look worn where
    it is worn throughout, and not where no wear stands out on it, nor is it open what thin teeth are where the scan `before` wear tells, or
    where what the loop found leaves none."""
    datum, loop = measured.placed.registration.datum, measured.loop
    if datum.low and (before or (loop is not None and (measured.faces or not _still_low(measured, loop)))):
        return _with_datum(measured, replace(datum, low=0.0))
    side = datum.worn_side
    # The other side is no datum either then: `worn_notes` says so.
    said = measured.faces or (loop is not None and len(loop.worn_sides) == 2)
    if side is None:
        return measured
    told = {region.tooth for region in wear.regions if region.side is side}
    worn, spared = len(told), sum(flank.side is side and flank.says and flank.tooth not in told for flank in wear.flanks)
    if worn and (loop is None or side in loop.worn_sides):
        looks = (
            f"wear stands out on {worn} of {worn + spared} {side} flanks and none of them is"
            if spared
            else f"all {side} flanks look worn and are not"
        )
        borne_out = f"{looks} used as datum; the {side.opposite} (coast) flanks are assumed unworn"
    else:
        borne_out = bends_otherwise(side, f"wear stands out on {worn} of them" if worn else "no wear stands out on them")
    return _with_datum(measured, replace(datum, borne_out="" if said else borne_out))


def _with_datum(measured: MeasuredGear, datum: Datum) -> MeasuredGear:
    registration = replace(measured.placed.registration, datum=datum)
    return replace(measured, placed=replace(measured.placed, registration=registration))


def _still_low(measured: MeasuredGear, loop: Loop) -> bool:
    """Whether flanks lie low against fillets and tips beside what the loop found, or that says itself that they are thin."""
    surface = measured.first.points.surface
    flank, *others = (loop.residual_after[loop.use & (surface == code)] for code in (FLANK, FILLET, TIP))
    known = [float(np.median(other)) for other in others if len(other)]
    if not known or not len(flank) or loop.thinner_by(measured.first.points.take(loop.use & (surface == FLANK))) > 0.0:
        return True
    return float(np.median(flank)) - min(known) < -LOW


def worn_notes(measured: MeasuredGear, wear: Wear, before: bool = False) -> tuple[str, ...]:
    """What the reader must know where a side is worn throughout, or may be; a scan `before` wear tells what was made so."""
    loop = measured.loop
    if loop is None:
        return ()
    notes = _where_the_mate_ran(measured)
    if len(level_open(measured)) == 2:
        plain = [
            side for side in sorted(loop.worn_sides, reverse=True) if not any(region.side is side for region in wear.regions)
        ]
        seen = f", though no wear stands out on the {' and '.join(map(str, plain))} ones" if plain else ""
        notes.append(
            f"the flanks of both sides look worn{seen}, and are not used as datum: where the teeth stand rests on tips, roots and fillets"
            + ("" if before else ", and an even loss of both sides could as well be thinner teeth")
        )
    for sides in loop.undecided:
        which = " and ".join(str(side) for side in sorted(sides, reverse=True))
        notes.append(
            f"the {which} flanks may be worn throughout, or all made so: the scan cannot tell"
            if sides
            else "what the worn flanks have in common may be how they were made: the scan cannot tell"
        )
    notes += [
        f"a burr of {significant(burr.volume, 2)} ± {significant(burr.std, 1)} mm³ stands on the tips of the {burr.side} flanks: it is not taken off what they lost"
        for burr in wear.burrs
    ]
    notes += [
        f"a ridge of {significant(1e3 * ridge.height, 2)} ± {significant(1e3 * ridge.std, 1)} µm stands at the pitch line of the worn {ridge.side} flanks: metal that was moved there by plastic flow; it is not"
        " taken off what they lost"
        for ridge in wear.ridges
    ]
    notes += [
        f"the worn {side} flanks stand {1e3 * height:.0f} µm proud of the design where they are highest: the teeth were cut thicker than drawn,"
        " and what is lost is counted from there"
        for side, height in zip(Side, wear.proud, strict=True)
        if height > 0.0
    ]
    if wear.unseen > wear.volume_std:
        notes.append(
            "no worn flank was seen whole: what is missing where nothing was seen is not in the volume, and would be up to"
            f" {significant(wear.unseen, 2)} {UNIT[wear.planar]} were it as deep there as anywhere else"
        )
    if wear.hidden_pits > 0.0:
        notes.append(
            f"on other flanks there may be pits or grooves as well, too few there to be told from strays: up to {significant(wear.hidden_pits, 2)} mm³"
        )
    open_ = even_loss(measured, wear)
    if open_ is not None and not before:
        low, high = max(wear.volume - open_, 0.0), wear.volume + open_
        notes.append(
            f"the tolerance of the tooth thickness leaves an even loss of whole flanks open: the volume may lie between {low:.3g} and {high:.3g} mm³;"
            " what has the shape of sliding does not hang on it"
        )
    return tuple(notes)


def _where_the_mate_ran(measured: MeasuredGear) -> list[str]:
    """What flanks beside where their mate ran tell, a sentence for each stretch."""
    faces, width, notes = measured.faces, measured.gear.face_width, list[str]()
    for low, high in dict.fromkeys((round(face.low, 1), round(face.high, 1)) for face in faces):
        sides = [str(face.side) for face in faces if (round(face.low, 1), round(face.high, 1)) == (low, high)]
        ends = " and ".join(end for end, there in (("below", low > 0.0), ("above", high < round(width, 1))) if there)
        notes.append(
            f"the {' and '.join(sides)} flanks are worn from z = {low:.1f} to {high:.1f} mm, where the mate ran: {ends} they stand as they were made, and tell how"
            " high they were cut"
        )
    return notes


def edge_notes(wear: Wear) -> tuple[str, ...]:
    """What is missing at the ends of flanks alone, and is not counted."""
    if not wear.edges:
        return ()
    return (
        f"{counted(wear.edges, 'flank')} with metal missing at an end of the face alone, {significant(1e3 * wear.edge_depth, 2)} µm at most: rounded or nicked"
        " edges, not counted as wear",
    )


def scanner_notes(stated: ScannerSpec, noise: float) -> tuple[str, ...]:
    """What the reader must know where something was stated of the scanner; `noise` is the scan's own, mm."""
    notes = []
    if stated.axis_offset is not None:
        notes.append(
            f"[scanner] axis_offset_mm = {stated.axis_offset:g} is not used: the effects of the table take its axis to be the gear's"
        )
    if stated.noise is not None and not 1.0 / UNLIKE < noise / stated.noise < UNLIKE:
        scatter = f"points scatter by {significant(1e3 * noise, 2)} µm, the scanner by {significant(1e3 * stated.noise, 2)} µm as stated"
        less = "the scan was smoothed or thinned, and neighbouring points share their errors"
        more = "look for glare, focus and strays"
        notes.append(f"{scatter}: {less if noise < stated.noise else more}")
    return tuple(notes)


def _off_reference(gear: Gear) -> tuple[str, ...]:
    """Where thickness is measured, if not at the reference circle."""
    if gear.thickness_radius == gear.reference_radius:
        return ()
    return (
        f"the reference circle, ⌀ {2.0 * gear.reference_radius:.4g} mm, lies off the involute: tooth thickness is that at ⌀ {2.0 * gear.thickness_radius:.4g} mm",
    )


def _no_forecast(pair: PairResult | None, ahead: Ahead | None) -> tuple[str, ...]:
    """Why there is no forecast, where one was asked for."""
    if ahead is None:
        return ()
    if pair is None or pair.law is None:
        return ("no forecast: the wear law needs a mate, and the design has one gear",)
    return () if pair.law.forecast is not None else (f"no forecast: {pair.law.why_not.removeprefix('no forecast: ')}",)


def _undecided(gears: Sequence[MeasuredGear]) -> tuple[tuple[float, float], ...]:
    """Worn volume and its standard deviation with other sides worn throughout, mm³."""
    wears = [find_wear(gear.as_made, gear.noise, gear.worn_sides, gear.loop, limits=False, gone=gear.gone) for gear in gears]
    return tuple((wear.volume, wear.volume_std) for wear in wears)


def _thick(
    measured: MeasuredGear, unworn: MeasuredGear | None, effects: Sequence[PutBack] | None, wear: Wear
) -> tuple[SectionThickness, tuple[Change, ...]]:
    """Section thickness, and what the effects change of it; nothing was taken out where they are None."""
    sections = measured.sections
    thickness = _with_hollows(_thickness(measured, sections), measured, wear, sections)
    if unworn is not None:
        made_arc = _thickness(unworn, unworn.sections).arc
        thickness = thickness.against(np.where(np.isfinite(made_arc), made_arc, thickness.as_made))
    if effects is None:
        return thickness, ()
    raw = replace(_thickness(measured, measured.raw_sections), hollows=thickness.hollows)
    return thickness, thickness_changes(measured, effects, thickness, raw)


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


def _thickness(measured: MeasuredGear, sections: SectionSums) -> SectionThickness:
    """Section thickness with measurement effects taken out; the loss against the as-made gear."""
    gear, loop = measured.gear, measured.loop
    result = thickness_of(sections, measured.noise).without(_sections_gone(measured, sections))
    if loop is None:
        return result
    turn = gear.arc_per_depth
    step = result.z[1] - result.z[0] if len(result.z) > 1 else 1.0
    grid = measured.cells.grid
    along = loop.covariance.row_step ** (step * (grid.rows - grid.groove_rows) / (gear.face_width - gear.spec.gap))
    common = np.hypot(turn * sum(measured.level_std), turn * _unexplained(measured))
    result = result.known_to(2.0 * turn**2 * loop.covariance.texture, float(along), float(common))
    tooth = np.repeat(np.arange(gear.teeth), len(result.z))
    z = np.tile(result.z, gear.teeth)
    roll = np.full(len(tooth), gear.thickness_roll)
    flanks = [flank_points(gear, tooth, np.full(len(tooth), side), roll, z) for side in (1, -1)]

    def arc(of: Callable[[SurfacePoints], Floats]) -> Floats:
        return np.asarray(gear.arc_per_depth * np.sum([of(flank) for flank in flanks], axis=0).reshape(gear.teeth, -1))

    other = [float(arc(partial(loop.as_other, effect)).mean()) for effect in loop.either]
    untold = 0.0 if loop.untold is None else gear.arc_per_depth * loop.untold.level.sum(axis=1, keepdims=True)
    # Between the places that were measured a tooth is as thin as it was made, and no thinner for what the scanner may have done.
    return replace(
        result.against(result.as_made + arc(partial(loop.deviation, kinds=MADE)) + untold).made_with(arc(loop.surely_made) + untold),
        otherwise=(sum(min(change, 0.0) for change in other), sum(max(change, 0.0) for change in other)),
    )  # fmt: skip


def _with_hollows(thickness: SectionThickness, measured: MeasuredGear, wear: Wear, sections: SectionSums) -> SectionThickness:
    """The same measurement with what pooled sections of worn teeth hide, and how well is known how thick each was made."""
    variance = np.tile(np.square(wear.apart), (len(thickness.arc), 1))
    if measured.loop is not None and measured.loop.untold is not None:
        variance += measured.loop.untold.level_std**2
    thickness = replace(thickness, made_std=thickness.turn * np.sqrt(variance.sum(axis=1)))
    if measured.planar:
        return thickness
    corrected = measured.corrected
    cells = corrected.with_deviation(corrected.points.deviation - measured.manufacture)
    told = thickness.as_made, measured.noise, measured.loop
    hollows = find_hollows(cells, wear.mask, measured.worn_sides, thickness.widths, sections, *told)
    return replace(thickness, hollows=hollows, unmeasured=thinnest_unmeasured(thickness, wear, cells.grid, sections.band.reach))


def _sections_gone(measured: MeasuredGear, sections: SectionSums) -> Bools:
    """(teeth, n_z) sections in which a tooth is broken off at the radius that is measured: what is left of its flank there is the edge of the fracture."""
    grid, heights = measured.cells.grid, sections.band.heights
    column = grid.fillet + int(grid.flank_column(sections.band.reach))
    row = np.clip(grid.place_of(heights).astype(np.int64), 0, grid.rows - 1)
    gone = np.asarray(measured.gone[:, :, :, column].any(axis=1), dtype=np.bool_)
    return gone[:, row]


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


def _unexplained(measured: MeasuredGear) -> float:
    """What the patterns that no effect explains add up to on both sides of a tooth where its thickness is measured, RMS over the gear, mm: whether they are
    the part's is not known."""
    grid, loop = measured.cells.grid, measured.loop
    if loop is None or not loop.patterns:
        return 0.0
    column = int(grid.flank_column(grid.gear.thickness_roll))
    field = np.sum([grid.flank_shape(pattern.field) for pattern in loop.patterns], axis=0)
    return float(np.sqrt(np.mean(field[..., column].sum(axis=1) ** 2)))


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
    nominal = gear_triangles(worn_profiles(ProfileNodes.of(grid), np.zeros((gear.teeth, 2, grid.rows, grid.fillet + grid.flank))))
    user = Triangles(pose.apply(scan.points), scan.triangles)
    try:
        removed, _, pieces = signed_difference(nominal, user)
    except InputError:
        return None  # not closed: the usual case for a scan, and no fault of the user's
    # Against the exact volume: the chords of the nominal triangles cut some mm³ off the gear.
    return PlainBoolean(removed, gear.volume - user.volume, pieces)


def _pair(
    design: Design, contact: ContactResult, spread: ContactSpread, law: WearStudy, thickness: SectionThickness
) -> PairResult:
    pair = design.pair
    assert pair is not None
    pinion, gear, centre = design.gears["pinion"], design.gears["gear"], design.centre_distance
    worst = max([0.0, *(tooth.greatest_loss for tooth in thickness.teeth() if tooth.seen)])
    play = contact.backlash_min.value, contact.backlash_max.value
    ring = gear.spec.internal
    return PairResult(
        design=exact_meshing(pinion, gear, centre),
        published=None if ring else published_meshing(pinion, gear, centre, worst, pair.backlash_allowance, pair.baseline),
        contact=contact,
        spread=spread,
        shafts=take_up(pinion, gear, centre, play, worst) if worst > 0.0 and not ring else None,
        drive_side=law.side,
        law=law,
    )

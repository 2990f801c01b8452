"""The whole inspection of a scanned gear, from located points to classes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.surface import SurfacePoints
from gearwear.errors import InputError
from gearwear.inspection.budget import MOTIONS, BudgetLine, budget_line, scaled_dimensions, with_scale
from gearwear.inspection.dimensions import (
    Dimensions,
    Pins,
    Span,
    chordal,
    constant_chord,
    measured_chordal,
    measured_constant_chord,
    measured_over_pins,
    measured_span,
    over_pins,
    pins_touching,
    span,
)
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.evaluation import CommonForm, Evaluation, common_form, evaluate
from gearwear.inspection.findings import Judge, limit_notes, radial_findings, worst_findings
from gearwear.inspection.grading import Finding, Verdict
from gearwear.inspection.k_band import KBands
from gearwear.inspection.laboratory import Laboratory, examine
from gearwear.inspection.pitch import PitchDeviations, Runout, measuring_roll, pitch_deviations, runout, tooth_thickness
from gearwear.inspection.positions import FlankPositions, seen_flanks
from gearwear.inspection.prepared import LEAST_COVERAGE, PreparedScan, prepare
from gearwear.inspection.ranges import profile_place
from gearwear.inspection.settings import DATUM_WORDS, Settings
from gearwear.inspection.stylus import ball_notes, felt
from gearwear.inspection.tolerances import FOOTNOTE, Size, check_validity, tolerances
from gearwear.inspection.traces import Topography, Traces, topography
from gearwear.threads import on_one_thread


@dataclass(frozen=True, slots=True, repr=False)
class Inspection(Card):
    """Everything inspected on one gear.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    settings : Settings
        What was asked, bands filled in.
    noise : float
        Scatter of a single point found on the flanks, mm.
    points, stray : int
        Flank points used and left out.
    coverage : (teeth, 2) float
        Share of each flank seen.
    profile, helix : Evaluation
    pitch : PitchDeviations
    runout : Runout or None
        None where no ball fits.
    dimensions : Dimensions
    topography : Topography
        A coarse map of every flank.
    laboratory : Laboratory or None
        Sections, surfaces, waves and rolling with a master; None where it was not asked for, and of a planar section.
    findings : tuple of Finding
        The worst of every deviation, graded.
    notes : tuple of str
        What a reader must know: what was not seen, what limits the numbers.
    foremost : tuple of str
        Those of them without which the numbers are read wrongly: over what range, of which flanks, felt by what.
    """

    gear: Gear
    settings: Settings
    noise: float
    points: int
    stray: int
    coverage: Floats
    profile: Evaluation
    helix: Evaluation
    pitch: PitchDeviations
    runout: Runout | None
    dimensions: Dimensions
    topography: Topography
    laboratory: Laboratory | None
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]
    foremost: tuple[str, ...] = ()

    def headline(self) -> str:
        graded = "no class as a whole" if self.iso_class is None else f"class {self.iso_class}"
        return f"{self.settings.edition}, {graded}, {self.points:,} points on flanks, noise {1e3 * self.noise:.2f} µm"

    def rows(self) -> list[CardRow]:
        by_symbol: dict[str, list[str]] = {}
        for finding in (*self.findings, *self.radial):
            side = "" if finding.side is None else f"{finding.side} "
            value = f"{1e3 * finding.value:.1f} µm, U {1e3 * finding.expanded:.1f}: " if np.isfinite(finding.value) else ""
            by_symbol.setdefault(finding.symbol, []).append(f"{side}{value}{finding.statement}")
        return [(symbol, "; ".join(said)) for symbol, said in by_symbol.items()]

    @property
    def radial(self) -> tuple[Finding, ...]:
        """F_i″ and f_i″ with a master gear, graded by ISO 1328-2:1997; empty where nothing was rolled. They enter no class of the gear."""
        return () if self.laboratory is None else radial_findings(self.size, self.laboratory.composite)

    @property
    def size(self) -> Size:
        """What the tolerances depend on."""
        return Size.of(self.gear)

    @property
    def budget(self) -> tuple[BudgetLine, ...]:
        """What the uncertainty of each quantity is made of (`budget`)."""
        pitch = {"single pitch": self.pitch.single, "index": self.pitch.index, "tooth thickness": self.dimensions.thickness}
        flanks = {
            f"{name} {part}": getattr(evaluation, part)
            for name, evaluation in (("profile", self.profile), ("helix", self.helix))
            for part in ("slope", "form", "total", "crowning")
        }
        causes = 0 if self.settings.pose_covariance is None else len(self.settings.pose_covariance)
        return tuple(
            budget_line(name, estimate, causes)
            for name, estimate in (flanks | pitch).items()
            if np.isfinite(estimate.value).any()
        )

    @property
    def iso_class(self) -> int | None:
        """Class of the gear: the coarsest of all findings; None unless every one of them was graded."""
        graded = [f.grade.iso_class for f in self.findings if f.grade.verdict is not Verdict.NO_TOLERANCE]
        sound = all(
            f.grade.verdict in (Verdict.GRADED, Verdict.WITHIN, Verdict.NEITHER, Verdict.NO_TOLERANCE) for f in self.findings
        )
        return max((c for c in graded if c is not None), default=None) if sound else None


RING = "A ring: no span fits."
"""What is not inspected on a ring."""
NO_CLASS = "no class"
"""How the note ends that says why nothing is graded."""
PITCH_ABOUT = "Pitch, index and runout are about"
"""How the note begins that says which axis."""


@on_one_thread
def inspect(points: SurfacePoints, gear: Gear, settings: Settings | None = None) -> Inspection:
    """Inspect a scanned gear, worn or new.

    Parameters
    ----------
    points : SurfacePoints
        The scan, located on `gear` (`gearwear.design.surface.locate`).
    gear : Gear
        The nominal gear.
    settings : Settings or None
        None: the defaults.

    Returns
    -------
    Inspection

    Raises
    ------
    InputError
        If a setting cannot be met (class, span, pin, empty band).

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> from gearwear.design.surface import flank_points
    >>> gear = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> tooth, side, roll, z = (a.ravel() for a in np.meshgrid(
    ...     np.arange(12), [1, -1], np.linspace(gear.form_roll, gear.tip_roll, 80), np.linspace(0, 15, 40)))
    >>> points = flank_points(gear, tooth.astype(int), side.astype(int), roll, z)
    >>> worn = points.with_deviation(np.where((points.tooth == 2) & (points.side == 1), -0.1, 0.0))
    >>> found = inspect(worn, gear)
    >>> float(np.round(found.dimensions.thickness.value[2] - gear.tooth_thickness, 6))
    -0.106418
    >>> found.findings[0].symbol, found.findings[0].statement
    ('f_Hα', 'class 1')
    >>> (1e3 * found.pitch.single.value[2:4, 0]).round(1)  # of the worn flank, tooth 3 left, and of the next
    array([-106.4,  106.4])
    """
    if gear.spec.gap > 0.0:
        raise InputError(
            f"[{gear.spec.name}] gap = {gear.spec.gap:g} mm: a double helical gear is inspected one half at a time (`inspection.halves`)"
        )
    given = settings or Settings()
    scale_std = given.scale_std or 0.0
    given = replace(
        given, axis=given.axis or "teeth", scale_std=scale_std, pose_covariance=with_scale(given.pose_covariance, scale_std)
    )
    asked = given.noise
    if asked is not None:
        given = replace(given, noise=asked / gear.base_helix_cosine)
    notes: list[str] = []
    graded = _is_graded(gear, given, notes)
    drawn = gear.spec.gauge
    gauge, pins = _gauges(gear, given, notes)
    scan = prepare(points, gear, given)
    notes += scan.notes
    if scan.samples.is_section:
        notes.append("A planar section: profile, pitch and dimensions are those at one height, and there is no helix.")
    over_face = scan.profiles(scan.profile_band)
    profile, helix, common = _evaluated(scan, over_face)
    over_pitch = over_face if scan.pitch_band == scan.profile_band else scan.profiles(scan.pitch_band)
    positions = FlankPositions.of(scan, over_pitch, profile, common)

    circle = measuring_roll(gear) if given.pitch_roll is None else given.pitch_roll
    at_reference, carried = positions.at(profile_place(gear, gear.reference_roll))
    at_circle, carried_pitch = positions.at(profile_place(gear, circle))
    notes += _carried_notes(carried, "reference circle", "tooth thickness")
    notes += _carried_notes(carried_pitch, "circle of the pitch", "pitch")
    pitch = pitch_deviations(at_circle, gear, circle, given.sector, edition=given.edition)
    if pins is not None and given.pin_diameter is None and (drawn is None or drawn.pin_diameter is None):
        at_pins, _ = positions.at(profile_place(gear, pins.roll))
        if seen_flanks(at_pins) < seen_flanks(at_circle):
            pins = pins_touching(gear, circle) or pins
    dimensions, balls = _dimensions(positions, tooth_thickness(at_reference, gear), gauge, pins)

    laboratory = None
    if given.laboratory:
        laboratory = examine(scan.seen, profile, helix, circle, scan.point_noise, scan.sample_factor, given.pose_covariance)
    judge = Judge(Size.of(gear), given.edition, given.required_class, pitch.sector, graded)
    limits = limit_notes(scan.coverage, LEAST_COVERAGE, profile, helix, scan.samples.is_section)
    felt_by = ball_notes(given.stylus_radius)
    notes += [*felt_by, *(limit.text for limit in limits)]
    notes += _notes_on_uncertainty(scan)
    return Inspection(
        gear=gear, settings=replace(scan.settings, noise=asked), noise=scan.samples.noise, points=len(scan.samples), stray=scan.samples.stray,
        coverage=scan.coverage, profile=profile, helix=helix, pitch=pitch, runout=balls,
        dimensions=scaled_dimensions(dimensions, gear, scale_std), topography=topography(scan.samples, 16, 24),
        laboratory=laboratory, findings=worst_findings(judge, profile, helix, pitch, balls), notes=(*notes, FOOTNOTE),
        foremost=(*scan.notes, *felt_by, *(limit.text for limit in limits if limit.foremost)),
    )  # fmt: skip


def _evaluated(scan: PreparedScan, over_face: Traces) -> tuple[Evaluation, Evaluation, CommonForm | None]:
    """Profile and helix, of a thin scan once more with what the flanks of a side have in common; that of the profiles."""
    gear, bands = scan.gear, scan.settings.k_bands or KBands()
    profiles, helices = (felt(traces, scan.settings.stylus_radius, gear) for traces in (over_face, scan.helices()))

    def evaluated(in_profiles: CommonForm | None, in_helices: CommonForm | None) -> tuple[Evaluation, Evaluation]:
        return (
            evaluate(profiles, scan.profile, bands=bands.profile, shared=profile_errors, common=in_profiles),
            evaluate(helices, scan.helix, bands=bands.helix, shared=helix_errors, common=in_helices, hand=scan.samples.hand),
        )

    profile_errors, helix_errors = scan.errors(profiles), scan.errors(helices)
    profile, helix = evaluated(None, None)
    if scan.form is None:
        return profile, helix, None
    common = common_form(profiles, profile)
    return *evaluated(common, common_form(helices, helix)), common


def _dimensions(
    positions: FlankPositions, thickness: Estimate, gauge: Span | None, pins: Pins | None
) -> tuple[Dimensions, Runout | None]:
    """Tooth thickness in all its forms, and runout; span, pins and runout where there is something to measure them with."""
    gear = positions.scan.gear
    span_lengths = pin_lengths = Estimate.empty((gear.teeth,))
    balls = None
    if gauge is not None:
        span_lengths = measured_span(positions.at_plates(gauge), gear, gauge)
    if pins is not None:
        at_pins, _ = positions.at(profile_place(gear, pins.roll))
        pin_lengths, balls = measured_over_pins(at_pins, gear, pins), runout(at_pins, gear, pins)
    dimensions = Dimensions(
        thickness=thickness,
        span=gauge,
        span_lengths=span_lengths,
        pins=pins,
        pin_lengths=pin_lengths,
        chord=chordal(gear),
        chord_thickness=measured_chordal(thickness, gear),
        constant_chord=constant_chord(gear),
        constant_chord_thickness=measured_constant_chord(thickness, gear),
    )
    return dimensions, balls


def _carried_notes(flanks: int, circle: str, result: str) -> list[str]:
    """That some flanks hardly reach a circle."""
    return [
        f"On {flanks} flanks the {circle} was hardly seen: {result} is there from the flanks' mean lines, carried on."
    ] * bool(flanks)


def _notes_on_uncertainty(scan: PreparedScan) -> list[str]:
    """What pitch and runout are about, and what U holds."""
    axis, factor, pose = scan.settings.axis, scan.sample_factor, scan.settings.pose_covariance
    notes = [
        f"{PITCH_ABOUT} the axis of the {'outside' if axis == 'bore' and scan.gear.spec.internal else DATUM_WORDS[axis]}."
        if axis in DATUM_WORDS
        else f"{PITCH_ABOUT} the axis the scan was registered on; without a bore or another datum that axis "
        "comes from the flanks themselves and takes their common eccentricity with it."
    ]
    if factor > 1.0:
        notes.append(
            f"{factor:.1f} of the scan's points are worth one independent point: its errors, or the surface's texture, are correlated; "
            f"every U is {np.sqrt(factor):.1f} times what the scatter of the points alone would say."
        )
    known = (
        ", and the registration. "
        if pose is not None and pose[:MOTIONS, :MOTIONS].any()
        else "; the uncertainty of the registration is not in them. "
    )
    notes.append(
        f"Uncertainties are from the scatter of the scan's points, how far that is correlated{known}"
        "Systematic errors of the scanner are not in them."
    )
    return notes


def _is_graded(gear: Gear, settings: Settings, notes: list[str]) -> bool:
    """Whether the standard covers the gear; a required class that does not exist is refused."""
    size = Size.of(gear)
    try:
        check_validity(size, settings.edition)
    except InputError as error:
        notes.append(f"{error}: {NO_CLASS}")
        return False
    if settings.required_class is not None:
        tolerances(size, settings.required_class, settings.edition)
    return True


def _gauges(gear: Gear, settings: Settings, notes: list[str]) -> tuple[Span | None, Pins | None]:
    """Span and pins, the drawing's where it states them; one that was asked for must fit, one that would have been chosen may be missing."""
    gauge, pins, drawn = None, None, gear.spec.gauge
    if gear.spec.internal:
        notes.append(RING)
    try:
        teeth = settings.span_teeth or (None if drawn is None else drawn.teeth)
        gauge = None if gear.spec.internal and teeth is None else span(gear, teeth)
    except InputError as error:
        if settings.span_teeth is not None:
            raise
        notes.append(str(error))
    try:
        pins = over_pins(gear, settings.pin_diameter or (None if drawn is None else drawn.pin_diameter))
    except InputError as error:
        if settings.pin_diameter is not None:
            raise
        notes.append(str(error))
    return gauge, pins

"""The whole inspection of a scanned gear, from located points to classes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.errors import InputError
from gearwear.inspection.additive import additive_form, clipped, is_thin, levelled, levelling_errors, thin_scatter, without_strays
from gearwear.inspection.budget import BudgetLine, budget_line, scaled_dimensions, with_scale
from gearwear.inspection.correlation import points_per_independent
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
    plate_bands,
    span,
)
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.evaluation import Evaluation, common_form, evaluate
from gearwear.inspection.findings import Judge, limit_notes, worst_findings
from gearwear.inspection.grading import Finding, Verdict
from gearwear.inspection.k_band import KBands
from gearwear.inspection.laboratory import Laboratory, examine
from gearwear.inspection.pitch import (
    WINDOW_SHARE,
    PitchDeviations,
    Runout,
    flank_positions,
    line_positions,
    measuring_roll,
    pitch_deviations,
    runout,
    tooth_thickness,
)
from gearwear.inspection.ranges import helix_range, profile_ends, profile_place, profile_places, profile_range
from gearwear.inspection.registered import motion_errors, shared_errors
from gearwear.inspection.stylus import ball_notes, felt
from gearwear.inspection.tolerances import FOOTNOTE, Edition, Size, check_validity, tolerances
from gearwear.inspection.traces import (
    FlankSamples,
    Topography,
    Traces,
    flank_coverage,
    flank_samples,
    helix_traces,
    profile_traces,
    seen_face,
    seen_from,
    topography,
)
from gearwear.threads import on_one_thread

LEAST_COVERAGE = 0.5
"""A flank with less than this share of its cells seen is "not seen"."""

BINS_PER_CUTOFF = 8
"""Bins of a trace per cut-off wavelength; their width takes 2.6 % off a wave at the cut-off."""

DATUM_WORDS = {
    "bore": "bore", "bands": "stated diameter bands", "ends": "end faces, through the middle of the teeth",
}  # fmt: skip
"""What an axis other than the teeth's rests on."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What an inspector may choose.

    Parameters
    ----------
    edition : Edition
        Standard for ranges and tolerances.
    required_class : int or None
        Class the drawing asks for; None: find it.
    noise : float or None
        Standard deviation of one scanned point, mm; None: from the scatter in the traces' bins.
    sample_factor : float or None
        Points per independent point (≥ 1), where the scan's errors are correlated: all uncertainties grow by its square root. None:
        found from the scan (`correlation.points_per_independent`).
    control_roll : float or None
        L of the profile control circle, mm; None: the form circle, or where the scan begins on most flanks.
    profile_end : float or None
        L where the profile evaluation ends, mm; None: by the edition.
    slope_length : float or None
        Length that the profile slope is stated over, mm; None: the evaluation range.
    helix_between : (float, float) or None
        Evaluation range of the helix, z to z, mm; None: by the standard.
    profile_cutoff, helix_cutoff : float or None
        Cut-off wavelengths, mm; None: by the standard.
    profile_band : (float, float) or None
        z to z averaged in profile traces, mm; None: the helix evaluation range.
    helix_band : (float, float) or None
        L to L averaged in helix traces, mm; None: the profile evaluation range.
    pitch_roll : float or None
        L of the circle where pitch is measured, mm; None: `pitch.measuring_roll`.
    pitch_band : (float, float) or None
        z to z averaged for pitch, runout and dimensions, mm; None: the helix evaluation range.
    pose_covariance : (6, 6) float or None
        Of the registration (tx, ty, tz in mm; wx, wy, wz in rad); None: the pose is taken as known.
    span_teeth : int or None
        k of the span; None: chosen.
    pin_diameter : float or None
        mm; None: chosen.
    sector : int or None
        Pitches of the sector deviation; None: about z / 8 (`tolerances.sector_teeth`).
    k_bands : KBands or None
        Limits of the drawing's own that profiles and helices must run between.
    laboratory : bool
        Whether to examine what is not graded too: traces along lines, surfaces, waves, rolling with a master. It takes three times as long.
    scale_std : float
        Relative standard uncertainty of the scan's scale: instrument and temperature.
    stylus_radius : float or None
        Of a ball by which profiles and helices are closed, mm; None: as the scan shows them.
    axis : str
        What the points and `pose_covariance` are about: "teeth", as registered, or a datum of `DATUM_WORDS`. Only the notes depend on it.
    """

    edition: Edition = Edition.ISO_2013
    required_class: int | None = None
    noise: float | None = None
    sample_factor: float | None = None
    control_roll: float | None = None
    profile_end: float | None = None
    slope_length: float | None = None
    helix_between: tuple[float, float] | None = None
    profile_cutoff: float | None = None
    helix_cutoff: float | None = None
    profile_band: tuple[float, float] | None = None
    helix_band: tuple[float, float] | None = None
    pitch_roll: float | None = None
    pitch_band: tuple[float, float] | None = None
    pose_covariance: Floats | None = None
    scale_std: float = 0.0
    stylus_radius: float | None = None
    span_teeth: int | None = None
    pin_diameter: float | None = None
    sector: int | None = None
    k_bands: KBands | None = None
    laboratory: bool = False
    axis: str = "teeth"


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

    def headline(self) -> str:
        graded = "no class as a whole" if self.iso_class is None else f"class {self.iso_class}"
        return f"{self.settings.edition}, {graded}, {self.points:,} points on flanks, noise {1e3 * self.noise:.2f} µm"

    def rows(self) -> list[CardRow]:
        found: dict[str, list[str]] = {}
        for one in self.findings:
            side = "" if one.side is None else f"{one.side} "
            value = f"{1e3 * one.value:.1f} µm, U {1e3 * one.expanded:.1f}: " if np.isfinite(one.value) else ""
            found.setdefault(one.symbol, []).append(f"{side}{value}{one.statement}")
        return [(symbol, "; ".join(said)) for symbol, said in found.items()]

    @property
    def size(self) -> Size:
        """What the tolerances depend on."""
        return gear_size(self.gear)

    @property
    def budget(self) -> tuple[BudgetLine, ...]:
        """What the uncertainty of each quantity is made of (`budget`)."""
        pitch = {"single pitch": self.pitch.single, "index": self.pitch.index, "tooth thickness": self.dimensions.thickness}
        flanks = {
            f"{name} {part}": getattr(one, part)
            for name, one in (("profile", self.profile), ("helix", self.helix))
            for part in ("slope", "form", "total", "crowning")
        }
        causes = 0 if self.settings.pose_covariance is None else len(self.settings.pose_covariance)
        return tuple(budget_line(name, one, causes) for name, one in (flanks | pitch).items() if np.isfinite(one.value).any())

    @property
    def iso_class(self) -> int | None:
        """Class of the gear: the coarsest of all findings; None unless every one of them was graded."""
        graded = [f.grade.iso_class for f in self.findings if f.grade.verdict is not Verdict.NO_TOLERANCE]
        sound = all(f.grade.verdict in (Verdict.GRADED, Verdict.WITHIN, Verdict.NO_TOLERANCE) for f in self.findings)
        return max((c for c in graded if c is not None), default=None) if sound else None


RING = "A ring: no span fits."
"""What is not inspected on a ring."""


def gear_size(gear: Gear) -> Size:
    """What the tolerances of a gear depend on."""
    return Size(2.0 * gear.reference_radius, gear.spec.normal_module, gear.face_width, gear.teeth)


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
    given = replace(given, pose_covariance=with_scale(given.pose_covariance, given.scale_std))
    if given.noise is not None:
        given = replace(given, noise=given.noise / gear.base_helix_cosine)
    hand = -1.0 if gear.helix_angle < 0.0 else 1.0
    notes: list[str] = []
    graded = _is_graded(gear, given, notes)
    gauge, pins = _gauges(gear, given, notes)
    helix_where = helix_range(gear, given.helix_between, given.helix_cutoff)
    samples = flank_samples(points, gear)
    form_place, tip_place = profile_ends(gear)
    start = None if given.control_roll is None else profile_place(gear, given.control_roll)
    end = None if given.profile_end is None else profile_place(gear, given.profile_end)
    if start is None and not samples.is_section and is_thin(samples):
        start = seen_from(samples, (helix_where.start, helix_where.end))
        if start is not None:
            notes.append(
                f"The profile is evaluated from a diameter of {2.0 * math.hypot(gear.base_radius, start):.3f} mm: {'beyond' if gear.spec.internal else 'below'} it most flanks were not seen."
            )
    profile_where = profile_range(gear, given.edition, start, end, given.profile_cutoff, given.slope_length)
    if given.helix_between is None and not samples.is_section:
        whole = seen_face(samples, (start or form_place, tip_place), (helix_where.start, helix_where.end))
        if whole is not None:
            helix_where = helix_range(gear, whole, given.helix_cutoff)
            notes.append(
                f"The helix is evaluated from z {whole[0]:.3f} to {whole[1]:.3f} mm: beyond, the flanks were not seen or are rounded off."
            )
    face = (helix_where.start, helix_where.end)
    if samples.is_section:
        face = (float(samples.z.min()) - 0.1, float(samples.z.max()) + 0.1)
        notes.append("A planar section: profile, pitch and dimensions are those at one height, and there is no helix.")
    given = replace(
        given,
        profile_band=given.profile_band or face,
        helix_band=profile_places(gear, given.helix_band) or (profile_where.start, profile_where.end),
        pitch_band=given.pitch_band or face,
    )
    profile_band, helix_band, pitch_band = given.profile_band, given.helix_band, given.pitch_band
    assert profile_band is not None and helix_band is not None and pitch_band is not None
    for name, (low, high) in (("profile", profile_band), ("helix", helix_band), ("pitch", pitch_band)):
        if not low < high:
            raise InputError(
                f"the band of the {name} traces, {low:g} to {high:g} mm, is empty: the first value must be the smaller"
            )

    area = ((profile_where.start, profile_where.end), (helix_where.start, helix_where.end))
    coverage = flank_coverage(samples, area)
    seen = samples.on_flanks(coverage >= LEAST_COVERAGE)
    noise, form, textured, thin = given.noise, None, seen, False
    if not samples.is_section and len(seen):
        form = additive_form(seen, *area)
        scatter = thin_scatter(seen, form)
        if scatter is not None:
            thin = True
            samples = replace(samples, noise=scatter)
            kept = without_strays(seen, form, scatter)
            samples = replace(samples, stray=samples.stray + len(seen) - len(kept))
            seen = kept
            noise = scatter if noise is None else max(noise, scatter)
            textured = clipped(seen, form, scatter)
    factor = given.sample_factor
    if factor is None:
        factor = points_per_independent(textured, samples.noise if noise is None else noise, area)
        given = replace(given, sample_factor=factor)
    bins = (noise, factor)

    def level(along: str, band: tuple[float, float]) -> FlankSamples:
        """The samples that make the traces; of a thin scan none from beyond the range, where edges are rounded and a filter must be wide."""
        if form is None or not thin:
            return seen
        return levelled(seen.inside((form_place, profile_where.outer), area[1] if along == "z" else band), form, along, band)

    step = profile_where.cutoff / BINS_PER_CUTOFF
    profiles = profile_traces(level("roll", profile_band), profile_band, step, *bins)
    helices = helix_traces(level("z", helix_band), helix_band, helix_where.cutoff / BINS_PER_CUTOFF, *bins)
    flanks = profiles
    if pitch_band != profile_band:
        flanks = profile_traces(level("roll", pitch_band), pitch_band, step, *bins)
    profiles, helices = (felt(traces, given.stylus_radius, gear) for traces in (profiles, helices))
    bands = given.k_bands or KBands()

    def shared(traces: Traces) -> Floats | None:
        return None if given.pose_covariance is None else shared_errors(traces, gear, given.pose_covariance)

    def own(traces: Traces) -> Floats | None:
        return (
            levelling_errors(form, traces, noise * math.sqrt(factor)) if thin and form is not None and noise is not None else None
        )

    errors = [_together(shared(traces), own(traces)) for traces in (profiles, helices)]
    profile = evaluate(profiles, profile_where, bands=bands.profile, shared=errors[0])
    helix = evaluate(helices, helix_where, bands=bands.helix, shared=errors[1], hand=hand)
    usual = None
    if thin:
        usual = common_form(profiles, profile)
        profile = evaluate(profiles, profile_where, 0, bands.profile, errors[0], usual)
        helix = evaluate(helices, helix_where, 0, bands.helix, errors[1], common_form(helices, helix), hand)

    window = WINDOW_SHARE * (tip_place - form_place)
    moved, single = shared(flanks), own(flanks)

    def positions(circle: float) -> tuple[Estimate, int]:
        """At a circle, and of how many flanks from their mean lines: where a thin scan hardly saw it."""
        found = flank_positions(flanks, circle, window, moved, single, usual)
        if not thin or _seen(found) == found.value.size:
            return found, 0
        lines = line_positions(profile, circle, usual, found.shared if moved is None else _at_circle(gear, face, given, circle))
        carried = np.isnan(found.value) & np.isfinite(lines.value)
        return found.where(~carried, lines), int(carried.sum())

    circle = measuring_roll(gear) if given.pitch_roll is None else given.pitch_roll
    (at_reference, carried), (at_circle, carried_pitch) = (
        positions(profile_place(gear, roll)) for roll in (gear.reference_roll, circle)
    )
    for number, what, result in (
        (carried, "reference circle", "tooth thickness"),
        (carried_pitch, "circle of the pitch", "pitch"),
    ):
        if number:
            notes.append(
                f"On {number} flanks the {what} was hardly seen: {result} is there from the flanks' mean lines, carried on."
            )
    pitch = pitch_deviations(at_circle, gear, circle, given.sector, edition=given.edition)
    if pins is not None and given.pin_diameter is None and _seen(positions(profile_place(gear, pins.roll))[0]) < _seen(at_circle):
        pins = pins_touching(gear, circle) or pins
    span_lengths = pin_lengths = Estimate.empty((gear.teeth,))
    balls = None
    if gauge is not None:
        touching, _ = positions(gauge.roll)
        if gauge.rise != 0.0 and not samples.is_section:  # the plates touch right and left flanks at heights of their own
            parts = {
                side: profile_traces(level("roll", band), band, step, *bins)
                for side, band in plate_bands(gear, gauge, face).items()
            }
            right, left = (
                flank_positions(parts[side], gauge.roll, window, shared(parts[side]), own(parts[side]), usual)
                for side in (Side.RIGHT, Side.LEFT)
            )
            touching = left.where(np.broadcast_to(np.arange(2) == Side.LEFT.index, (gear.teeth, 2)), right)
        span_lengths = measured_span(touching, gauge)
    if pins is not None:
        touched, _ = positions(profile_place(gear, pins.roll))
        pin_lengths, balls = measured_over_pins(touched, gear, pins), runout(touched, gear, pins)
    thickness = tooth_thickness(at_reference, gear)
    dimensions = Dimensions(
        thickness,
        gauge,
        span_lengths,
        pins,
        pin_lengths,
        chordal(gear),
        measured_chordal(thickness, gear),
        constant_chord(gear),
        measured_constant_chord(thickness, gear),
    )
    dimensions = scaled_dimensions(dimensions, given.scale_std)
    laboratory = (
        None
        if not given.laboratory
        else examine(seen, gear, profile, helix, circle, samples.noise if noise is None else noise, factor, given.pose_covariance)
    )
    judge = Judge(gear_size(gear), given.edition, given.required_class, pitch.sector, graded)
    findings = worst_findings(judge, profile, helix, pitch, balls)
    notes += ball_notes(given.stylus_radius) + limit_notes(coverage, LEAST_COVERAGE, profile, helix, samples.is_section)
    notes.append(
        f"Pitch, index and runout are about the axis of the {'outside' if given.axis == 'bore' and gear.spec.internal else DATUM_WORDS[given.axis]}."
        if given.axis in DATUM_WORDS
        else "Pitch, index and runout are about the axis the scan was registered on; without a bore or another datum that axis "
        "comes from the flanks themselves and takes their common eccentricity with it."
    )
    if factor > 1.0:
        notes.append(
            f"{factor:.1f} of the scan's points are worth one independent point: its errors, or the surface's texture, hang together; "
            f"every U is {np.sqrt(factor):.1f} times what the scatter of the points alone would say."
        )
    notes.append(
        "Uncertainties are from the scatter of the scan's points, how far it hangs together"
        + (
            ", and the registration. "
            if given.pose_covariance is not None
            else "; the uncertainty of the registration is not in them. "
        )
        + "Systematic errors of the scanner are not in them."
    )
    notes.append(FOOTNOTE)
    return Inspection(
        gear,
        given,
        samples.noise,
        len(samples),
        samples.stray,
        coverage,
        profile,
        helix,
        pitch,
        balls,
        dimensions,
        topography(samples, 16, 24),
        laboratory,
        findings,
        tuple(notes),
    )


def _at_circle(gear: Gear, face: tuple[float, float], given: Settings, roll: float) -> Floats:
    """What the registration's uncertainty does to the flanks' positions at a circle, (teeth, 2, 6) mm; `roll` its L, mm."""
    assert given.pose_covariance is not None
    middle = np.full((gear.teeth, 2), 0.5 * (face[0] + face[1]))
    return motion_errors(gear, np.full_like(middle, roll), middle, given.pose_covariance)


def _together(shared: Floats | None, own: Floats | None) -> Floats | None:
    """Errors of bins with one more cause, (teeth, 2, n, m + 1)."""
    if own is None:
        return shared
    return own[..., None] if shared is None else np.concatenate([shared, own[..., None]], axis=-1)


def _seen(positions: Estimate) -> int:
    """Flanks with a position."""
    return int(np.isfinite(positions.value).sum())


def _is_graded(gear: Gear, given: Settings, notes: list[str]) -> bool:
    """Whether the standard covers the gear; a required class that does not exist is refused."""
    size = gear_size(gear)
    try:
        check_validity(size, given.edition)
    except InputError as error:
        notes.append(f"{error}: no class is given")
        return False
    if given.required_class is not None:
        tolerances(size, given.required_class, given.edition)
    return True


def _gauges(gear: Gear, given: Settings, notes: list[str]) -> tuple[Span | None, Pins | None]:
    """Span and pins; one that was asked for must fit, one that would have been chosen may be missing."""
    gauge, pins = None, None
    if gear.spec.internal:
        notes.append(RING)
    try:
        gauge = None if gear.spec.internal and given.span_teeth is None else span(gear, given.span_teeth)
    except InputError as error:
        if given.span_teeth is not None:
            raise
        notes.append(str(error))
    try:
        pins = over_pins(gear, given.pin_diameter)
    except InputError as error:
        if given.pin_diameter is not None:
            raise
        notes.append(str(error))
    return gauge, pins

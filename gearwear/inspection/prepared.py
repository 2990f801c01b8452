"""A scan made ready for its traces: what is evaluated, over which bands, from which points, with which noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.quantity import as_given, at_least, at_most
from gearwear.design.surface import SurfacePoints
from gearwear.errors import InputError
from gearwear.inspection.additive import (
    AdditiveForm,
    additive_form,
    clipped,
    is_thin,
    levelled,
    levelling_errors,
    thin_scatter,
    without_strays,
)
from gearwear.inspection.correlation import points_per_independent
from gearwear.inspection.ranges import Range, helix_range, profile_ends, profile_place, profile_places, profile_range
from gearwear.inspection.registered import shared_errors
from gearwear.inspection.settings import Settings
from gearwear.inspection.traces import (
    FlankSamples,
    Traces,
    flank_coverage,
    flank_samples,
    helix_traces,
    profile_traces,
    seen_face,
    seen_from,
)

LEAST_COVERAGE = 0.5
"""A flank with less than this share of its cells seen is "not seen"."""

FINEST_CUTOFF = 1.0 / 500.0
"""Of the evaluation range: a finer filter needs more time and memory with its square, and no scan has points for it."""
LONGEST_STATED = 10.0
"""Involutes that the slope may be stated over."""
ON_INVOLUTE = 1e-6
"""mm; rounding of a length of roll that came from a diameter."""

Band = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedScan:
    """What all traces of an inspection are made from; lengths in mm.

    Parameters
    ----------
    gear : Gear
    settings : Settings
        Bands and sample factor filled in.
    profile, helix : Range
        Evaluation ranges.
    face : (float, float)
        z to z that the helix is evaluated over; of a planar section, its height.
    profile_band, helix_band, pitch_band : (float, float)
        What the traces are averaged over: z to z, of the helix place to place along the profile.
    samples : FlankSamples
        All flank points but strays.
    seen : FlankSamples
        Those on flanks of which enough was seen.
    coverage : (teeth, 2) float
        Share of each flank seen.
    noise : float or None
        Standard deviation of a point that the traces reckon with; None: from the scatter in their bins.
    sample_factor : float
        Points per independent point.
    form : AdditiveForm or None
        Smooth form of every flank; None of a dense scan, which needs none.
    notes : tuple of str
        Where evaluation ranges are shorter than the standard's.
    """

    gear: Gear
    settings: Settings
    profile: Range
    helix: Range
    face: Band
    profile_band: Band
    helix_band: Band
    pitch_band: Band
    samples: FlankSamples
    seen: FlankSamples
    coverage: Floats
    noise: float | None
    sample_factor: float
    form: AdditiveForm | None
    notes: tuple[str, ...]

    @property
    def point_noise(self) -> float:
        """Standard deviation of a point, mm: as stated, else as found."""
        return self.samples.noise if self.noise is None else self.noise

    def profiles(self, band: Band) -> Traces:
        """Profile traces, averaged over a band of z."""
        return profile_traces(self._levelled("roll", band), band, self.profile.bin_width, self.noise, self.sample_factor)

    def helices(self) -> Traces:
        """Helix traces, averaged over `helix_band`."""
        samples = self._levelled("z", self.helix_band)
        return helix_traces(samples, self.helix_band, self.helix.bin_width, self.noise, self.sample_factor)

    def _levelled(self, along: str, band: Band) -> FlankSamples:
        """The points of traces; of a thin scan none from beyond the range, where edges are rounded and a filter must be wide."""
        if self.form is None:
            return self.seen
        form_place, _ = profile_ends(self.gear)
        z = self.helix.ends if along == "z" else band
        return levelled(self.seen.inside((form_place, self.profile.outer), z), self.form, along, band)

    def shared_errors(self, traces: Traces) -> Floats | None:
        """What the registration adds to the errors of bins, (teeth, 2, n, m) mm; None where the pose is taken as known."""
        covariance = self.settings.pose_covariance
        return None if covariance is None else shared_errors(traces, self.gear, covariance)

    def own_errors(self, traces: Traces) -> Floats | None:
        """What levelling a thin scan adds to them, (teeth, 2, n) mm, a flank's together; None of a dense scan."""
        if self.form is None or self.noise is None:
            return None
        return levelling_errors(self.form, traces, self.noise * math.sqrt(self.sample_factor))

    def errors(self, traces: Traces) -> Floats | None:
        """Both, each cause by itself, (teeth, 2, n, m or m + 1) mm."""
        shared, own_errors = self.shared_errors(traces), self.own_errors(traces)
        if own_errors is None:
            return shared
        return own_errors[..., None] if shared is None else np.concatenate([shared, own_errors[..., None]], axis=-1)


def check_settings(settings: Settings, gear: Gear) -> None:
    """Refuse what lies off a gear: ranges and bands that hold nothing of it, filters that suit no range on it.

    Parameters
    ----------
    settings : Settings
    gear : Gear
        The nominal gear, of one helix.

    Raises
    ------
    InputError
        With what the gear has in its place.
    """
    form, tip = gear.form_roll, gear.tip_roll
    involute, face = (min(form, tip), max(form, tip)), (0.0, gear.face_width)
    first, last = (
        given if given is not None else own for given, own in ((settings.control_roll, form), (settings.profile_end, tip))
    )
    if not profile_place(gear, first) < profile_place(gear, last):
        raise InputError(
            f"the profile evaluation from {first:g} to {last:g} mm of roll is empty: from root to tip would be right, which are at {form:.3f} and {tip:.3f} mm"
        )
    for name, band, (low, high), of, whole in (
        ("profile evaluation", (first, last), involute, "of roll: the involute", False),
        ("band of the helix traces", settings.helix_band, involute, "of roll: the involute", False),
        ("helix evaluation", settings.helix_between, face, "of height: the face", True),
        ("band of the profile traces", settings.profile_band, face, "of height: the face", False),
        ("band of the pitch", settings.pitch_band, face, "of height: the face", False),
    ):
        if band is None:
            continue
        if not (low <= min(band) and max(band) <= high if whole else min(band) < high and max(band) > low):
            raise InputError(
                f"the {name} from {as_given(band[0])} to {as_given(band[1])} mm {of} goes from {at_least(low, 3)} to {at_most(high, 3)} mm"
            )
    low, high = involute
    if settings.pitch_roll is not None and not low - ON_INVOLUTE <= settings.pitch_roll <= high + ON_INVOLUTE:
        raise InputError(
            f"the circle of the pitch at {as_given(settings.pitch_roll)} mm of roll: the involute goes from {at_least(low, 3)} to {at_most(high, 3)} mm"
        )
    if settings.slope_length is not None and settings.slope_length > LONGEST_STATED * (high - low):
        raise InputError(
            f"slope stated over {as_given(settings.slope_length)} mm: at most {at_most(LONGEST_STATED * (high - low), 0)} mm would be right, {LONGEST_STATED:g} involutes"
        )
    if settings.sector is not None and settings.sector >= gear.teeth:
        raise InputError(f"sector of {settings.sector} pitches: 1 to {gear.teeth - 1} would be right for {gear.teeth} teeth")
    start, end = (
        None if given is None else profile_place(gear, given) for given in (settings.control_roll, settings.profile_end)
    )
    profile = profile_range(gear, settings.edition, start, end)
    helix = helix_range(gear, settings.helix_between)
    for name, cutoff, where in (("profile", settings.profile_cutoff, profile), ("helix", settings.helix_cutoff, helix)):
        if cutoff is not None and not FINEST_CUTOFF * where.length <= cutoff <= where.length:
            raise InputError(
                f"cut-off of the {name}'s filter, {as_given(cutoff)} mm: {at_least(FINEST_CUTOFF * where.length)} to {at_most(where.length)} mm would be right for that range"
            )


def prepare(points: SurfacePoints, gear: Gear, settings: Settings) -> PreparedScan:
    """Choose ranges and bands, and take strays out.

    Parameters
    ----------
    points : SurfacePoints
        The scan, located on `gear`.
    gear : Gear
    settings : Settings

    Raises
    ------
    InputError
        If a setting suits no gear of these dimensions (`check_settings`).
    """
    check_settings(settings, gear)
    samples = flank_samples(points, gear)
    profile, helix, notes = _ranges(samples, settings)
    face = helix.ends
    if samples.is_section:
        face = (float(samples.z.min()) - 0.1, float(samples.z.max()) + 0.1)
    profile_band, pitch_band = settings.profile_band or face, settings.pitch_band or face
    helix_band = profile_places(gear, settings.helix_band) or profile.ends
    area = (profile.ends, helix.ends)
    coverage = flank_coverage(samples, area)
    seen = samples.on_flanks(coverage >= LEAST_COVERAGE)
    noise, form, textured = settings.noise, None, seen
    if not samples.is_section and len(seen):
        smooth = additive_form(seen, *area)
        scatter = thin_scatter(seen, smooth)
        if scatter is not None:
            form, kept = smooth, without_strays(seen, smooth, scatter)
            samples = replace(samples, noise=scatter, stray=samples.stray + len(seen) - len(kept))
            noise = scatter if noise is None else max(noise, scatter)
            seen, textured = kept, clipped(kept, smooth, scatter)
    factor = settings.sample_factor
    if factor is None:
        factor = points_per_independent(textured, samples.noise if noise is None else noise, area)
    filled = replace(
        settings, profile_band=profile_band, helix_band=helix_band, pitch_band=pitch_band, sample_factor=factor
    )  # fmt: skip
    return PreparedScan(
        gear=gear, settings=filled, profile=profile, helix=helix, face=face, profile_band=profile_band, helix_band=helix_band,
        pitch_band=pitch_band, samples=samples, seen=seen, coverage=coverage, noise=noise, sample_factor=factor, form=form,
        notes=tuple(notes),
    )  # fmt: skip


def _ranges(samples: FlankSamples, settings: Settings) -> tuple[Range, Range, list[str]]:
    """Evaluation ranges of profile and helix, and what to say where they are shorter because flanks were not seen whole."""
    gear, notes = samples.gear, list[str]()
    form_place, tip_place = profile_ends(gear)
    helix = helix_range(gear, settings.helix_between, settings.helix_cutoff)
    start = None if settings.control_roll is None else profile_place(gear, settings.control_roll)
    end = None if settings.profile_end is None else profile_place(gear, settings.profile_end)
    if start is None and not samples.is_section and is_thin(samples):
        start = seen_from(samples, helix.ends)
        if start is not None:
            notes.append(
                f"The profile is evaluated from a diameter of {2.0 * math.hypot(gear.base_radius, start):.3f} mm: {'beyond' if gear.spec.internal else 'below'} it most flanks were not seen."
            )
    profile = profile_range(gear, settings.edition, start, end, settings.profile_cutoff, settings.slope_length)
    if settings.helix_between is None and not samples.is_section:
        whole = seen_face(samples, (start or form_place, tip_place), helix.ends)
        if whole is not None:
            helix = helix_range(gear, whole, settings.helix_cutoff)
            notes.append(
                f"The helix is evaluated from z {whole[0]:.3f} to {whole[1]:.3f} mm: beyond, the flanks were not seen or are rounded off."
            )
    return profile, helix, notes

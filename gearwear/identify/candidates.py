"""A scan without a design: gears it could be of, each fitted to it, best first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.card import Card, CardRow, few
from gearwear.design.gear import Gear
from gearwear.design.quantity import as_given, at_most
from gearwear.design.standards import FRACTION, MM_PER_INCH, diametral_pitch
from gearwear.design.surface import END_LOW, FILLET, FLANK, OTHER, ROOT, SURFACE_NAMES, SurfacePoints, locate
from gearwear.errors import InputError
from gearwear.identify.gauges import SPUR, Gauge, Helix, Measured
from gearwear.identify.proposal import Proposal, check_known, propose, spec_of
from gearwear.identify.survey import PROFILE_SLOPE, Survey, survey
from gearwear.placing.coarse import Sample, take_sample
from gearwear.placing.registration import Registration, refine, rough_pose
from gearwear.robust import median_scale, scale_about
from gearwear.threads import on_one_thread

FITTED = 40000
"""Points each candidate is fitted to."""
HOPELESS = 15.0
"""Cost above the best from which a proposal is not fitted."""
SCALE = 0.002
"""Relative standard deviation of an unknown scanner's scale; a scan that is stretched one way is as uncertain as half the stretch."""
SCALE_DOUBT, BASE_PITCH_DOUBT, THICKNESS_DOUBT = 0.001, 0.003, 0.004
"""Relative standard deviations of what an unknown scanner shows: diameters, base pitch (profile slope), thickness (coat, zero)."""
FACE_DOUBT = 0.01
"""mm; standard deviation of a length between two surfaces, as a scanner's coat and zero leave it."""
WHOLE = 2.0
"""Standard deviations of a length within which it is a whole number of mm: face width and bore then gauge the scale."""
HELIX_SLOPE = 0.012
"""mm; helix slope deviation of usual gears: over the face width it cannot be told from another helix angle."""
RIM_TOLERANCE = 0.012, 0.02
"""mm; standard deviations of tip and root diameters as they are made, whatever their size."""
THICKNESS_FLOOR = 0.02
"""mm; a coat on both flanks."""
WORN_LOSS = 2.0
"""Standard deviation of the mean loss of a side that is worn, in robust standard deviations of its points."""
RACK_TIP_RADII = (0.2, 0.25, 0.3, 0.38)
"""Tip radii of racks in use, in modules: 0.25, 0.3 and 0.38 are those of ISO 53 (agree with one independent implementation)."""
OBSERVATIONS = 12
"""How many independent observations the scatter of the flanks counts as."""
LEAST_GROOVE = 0.1
"""mm; groove written of a gear whose halves meet: a design has one."""
NEAR_GEAR = 0.05
"""Modules; what is farther off a gear is not of it, whatever is worn."""
UNKNOWN_WIDTH = 10.0
"""mm; face width written for a planar section, where any value does."""


@dataclass(frozen=True, slots=True)
class SurfaceLeft:
    """What a fit leaves on one surface: median and robust standard deviation of the deviations, mm, and how many points."""

    surface: str
    median: float
    scatter: float
    points: int


@dataclass(frozen=True, slots=True, repr=False)
class CandidateGear(Card):
    """A gear the scan could be of.

    Parameters
    ----------
    proposal : Proposal
        Standard numbers and what they leave of the measured dimensions.
    gear : Gear
        Made from it, with the face width and bore that were seen.
    registration : Registration or None
        The scan on it; None where it was not fitted or does not fit.
    scatter : float
        Robust standard deviation of the deviations of the better side's flanks, mm; nan where it was not fitted.
    left : tuple of SurfaceLeft
        Surface by surface.
    """

    proposal: Proposal
    gear: Gear
    registration: Registration | None
    scatter: float
    left: tuple[SurfaceLeft, ...]

    def headline(self) -> str:
        fit = f"flanks scatter by {1e3 * self.scatter:.2f} µm" if math.isfinite(self.scatter) else "not fitted"
        return f"{self.proposal.name}; {fit}"

    def rows(self) -> list[CardRow]:
        return [(left.surface, f"{1e3 * left.median:+z.1f} ± {1e3 * left.scatter:.1f} µm") for left in self.left]


@dataclass(frozen=True, slots=True, repr=False)
class Candidates(Card):
    """What a scan shows and the gears it could be of.

    Parameters
    ----------
    survey : Survey
        Measured without a design.
    gauges : tuple of Gauge
        What of it was held against the standards.
    ranked : tuple of CandidateGear
        Best first; at least one.
    """

    survey: Survey
    gauges: tuple[Gauge, ...]
    ranked: tuple[CandidateGear, ...]

    def headline(self) -> str:
        return f"{self.survey.teeth} teeth; best: {self.ranked[0].headline()}"

    def rows(self) -> list[CardRow]:
        return few([(f"cost {candidate.proposal.cost:.1f}", candidate.headline()) for candidate in self.ranked])


@on_one_thread
def find_candidates(
    points: Floats,
    normals: Floats | None = None,
    planar: bool = False,
    module: float | None = None,
    pressure_angle: float | None = None,
    teeth: int | None = None,
    face_width: float | None = None,
    name: str = "gear",
    helix: Helix | None = None,
    bore: float | None = None,
) -> Candidates:
    """Find the gears a scan could be of.

    Parameters
    ----------
    points : (n, 3) float
        The scan in its own frame, mm.
    normals : (n, 3) float or None
        Of the file, if any.
    planar : bool
        True for a planar section.
    module, pressure_angle : float or None
        mm and rad, where they are known.
    teeth : int or None
        Where it is known: refused if the scan shows another number.
    face_width : float or None
        mm, where it is known; None: as seen.
    name : str
        "pinion" or "gear".
    helix : Helix or None
        Where it is known; None: as seen.
    bore : float or None
        Diameter, mm, 0 for none, where it is known; None: as seen. A ring has none.

    Returns
    -------
    Candidates

    Raises
    ------
    InputError
        If what is known is impossible, no gear is seen, or a double helical ring, the tooth count is another one, or no gear that can be cut
        has its dimensions.

    Notes
    -----
    Proposals are ranked by their cost plus 2 n ln (scatter / least scatter) with n = 12: what tool and scanner do is common to all flanks,
    so many points are no many observations.
    """
    check_known(module, pressure_angle)
    if face_width is not None and not 0.0 < face_width < math.inf:
        raise InputError(f"face width {face_width:g} mm: above 0 would be right")
    if bore is not None and not 0.0 <= bore < math.inf:
        raise InputError(f"bore {bore:g} mm: a diameter, or 0 for none, would be right")
    seen = survey(points, normals, planar)
    if seen.internal and bore:
        raise InputError(f"bore {bore:g} mm: the scan is of a ring, which has none; to leave it out would be right")
    if bore is not None and not seen.internal and not bore < 2.0 * seen.root_radius:
        raise InputError(
            f"bore {as_given(bore)} mm: below the root diameter of the scan, {at_most(2.0 * seen.root_radius, 3)} mm, would be right"
        )
    if seen.internal and len(seen.halves) > 1:
        raise InputError(f"the scan looks like {seen.what}; double helical rings are out of scope")
    if seen.internal and planar:
        raise InputError("a planar section of a ring is out of scope; a scan of its teeth in space would be right")
    if helix is not None and len(seen.halves) > 1:  # either half may be called the one at z = 0: as the scan lies
        helix = replace(helix, angle=math.copysign(helix.angle, seen.base_helix[0]))
    if teeth is not None and teeth != seen.teeth:
        raise InputError(f"teeth = {teeth}: the scan shows {seen.teeth} teeth")
    gauges = _gauges(seen)
    candidates = []
    # A known scale is no unknown: what is left of its doubt is in the dimensions.
    doubt = max(SCALE, 0.5 * seen.oval) if math.isinf(_gauged_scale(seen)) else 0.0
    for proposal in propose(
        seen.teeth, gauges, module, pressure_angle, doubt, helix=helix or _helix(seen), internal=seen.internal
    ):
        # A root seen beside no flanks is no bore, nor a rim.
        beside = 0.0 < seen.bore_diameter < proposal.root_diameter or seen.rim_diameter > proposal.root_diameter
        body = _known_length(seen.bore_diameter) + _rounded_length(seen.rim_diameter, 2) if beside else 0.0
        body = body if bore is None or seen.internal else bore
        width = face_width or _rounded_width(seen, diametral_pitch(proposal.module.mm) is not None)
        try:
            gear = Gear.from_spec(spec_of(proposal, width, body, name, _groove(seen)))
        except InputError:
            continue  # not a gear that can be cut
        candidates.append(CandidateGear(proposal, gear, None, math.nan, ()))
    if not candidates:
        raise InputError(
            "no gear that can be cut has the dimensions of the scan; the number of teeth and two diameters, stated without it, may tell why"
        )
    pick = np.random.default_rng(0).choice(len(points), min(FITTED, len(points)), replace=False)
    thin, thin_normals = points[pick], None if normals is None else normals[pick]
    if seen.oval:
        thin = _rounded(seen, thin)
    least = min(candidate.proposal.cost for candidate in candidates)
    samples: dict[float, Sample] = {}
    fitted = [
        _fitted(candidate, thin, thin_normals, planar, seen, samples) if candidate.proposal.cost < least + HOPELESS else candidate
        for candidate in candidates
    ]
    return Candidates(seen, gauges, _ranked(fitted, thin))


def _helix(seen: Survey) -> Helix:
    """Of the flanks as they were seen: with a helix slope of usual size, and heights no surer than other lengths."""
    if not seen.helical:
        return SPUR
    angle, std = seen.base_helix
    stretched = SCALE_DOUBT * math.sin(angle) * math.cos(angle)
    toothed = (seen.face_width - seen.gap) / len(seen.halves)
    sloped = HELIX_SLOPE / toothed * math.cos(angle) ** 2
    return Helix(angle, math.hypot(std, stretched, sloped), at_base=True)


def _groove(seen: Survey) -> float:
    """Width of the groove between two halves as a drawing would have it, mm: as the face width; 0 of a gear of one part."""
    if len(seen.halves) < 2:
        return 0.0
    return max(_rounded_length(seen.gap, seen.faces), LEAST_GROOVE)


def _gauged_scale(seen: Survey) -> float:
    """Relative standard deviation of the scale by face width and bore; infinite where they are not both whole numbers of mm.

    One length alone is a whole number by chance on one scan in twenty-five, and a coat makes the width larger and the bore smaller.
    """
    lengths = (seen.face_width, seen.bore_diameter)
    whole = all(length > 1.0 and abs(length - round(length)) < WHOLE * FACE_DOUBT for length in lengths)
    known = FACE_DOUBT / math.hypot(*lengths) if whole else math.inf
    return known if seen.faces == 2 and not seen.oval and known < 0.5 * SCALE_DOUBT else math.inf


def base_pitch_doubt(seen: Survey) -> float:
    """Standard deviation of the base pitch of the design by what the flanks show, mm: the scanner's, and a profile slope of usual size."""
    return seen.base_pitch * math.hypot(BASE_PITCH_DOUBT, PROFILE_SLOPE / seen.flank.roll)


def _gauges(seen: Survey) -> tuple[Gauge, ...]:
    """The survey as dimensions with what an unknown scanner may do to them."""
    flank = seen.flank
    least, lost = flank.scatter, max(half.worn_scatter for half in seen.halves)
    scale = min(SCALE_DOUBT, _gauged_scale(seen))

    def length(value: float, relative: float, floor: float) -> Measured:
        return Measured(value, math.hypot(relative * value, floor), relative)

    root = Gauge("root_diameter", length(2.0 * seen.root_radius, scale, math.hypot(RIM_TOLERANCE[1], 2.0 * seen.root_scatter)))
    return (
        Gauge("tip_diameter", length(2.0 * seen.tip_radius, scale, max(least, RIM_TOLERANCE[0]))),
        *([root] if math.isfinite(seen.root_scatter) else []),
        Gauge("base_pitch", Measured(seen.base_pitch, base_pitch_doubt(seen))),
        # What a worn side lost on average is missing from the thickness, and not known: about what it scatters by.
        Gauge(
            "thickness",
            length(seen.thickness, THICKNESS_DOUBT, math.hypot(THICKNESS_FLOOR, WORN_LOSS * lost)),
            2.0 * flank.middle,
        ),
    )


def _rounded_width(seen: Survey, inches: bool) -> float:
    """Face width as a drawing would have it, mm; of a gear in `inches` a number of 1/64 in where that is nearer, and within what is known."""
    if not math.isfinite(seen.face_width):
        return UNKNOWN_WIDTH
    metric = _rounded_length(seen.face_width, seen.faces)
    if not inches or seen.faces < 2:
        return metric
    step = MM_PER_INCH / FRACTION
    drawn = step * round(seen.face_width / step)
    known = 2.0 * math.hypot(SCALE_DOUBT * seen.face_width, FACE_DOUBT)
    tenth = round(seen.face_width, 1)
    nearer = abs(drawn - seen.face_width) <= abs(tenth - seen.face_width)
    return round(drawn, 6) if nearer and abs(drawn - seen.face_width) < known else metric


def _known_length(length: float) -> float:
    """A diameter without digits that an unknown scanner does not tell, mm: to the power of ten below its standard deviation."""
    if length == 0.0:
        return 0.0
    return round(length, -math.floor(math.log10(math.hypot(SCALE_DOUBT * length, FACE_DOUBT))))


def _rounded_length(length: float, faces: int) -> float:
    """As a drawing would have it, mm: to 0.1 where two faces were seen and that is within 0.05, else to 0.01."""
    tenth = round(length, 1)
    return tenth if faces == 2 and abs(tenth - length) < 0.05 and tenth > 1.0 else round(length, 2)


def _rounded(seen: Survey, points: Floats) -> Floats:
    """A scan that lies on an oval, made round about the gear's axis."""
    placed = seen.pose.apply(points)
    placed[:, :2] = seen.circle.rounded(placed[:, :2])
    return seen.pose.inverse().apply(placed)


def _fitted(
    candidate: CandidateGear,
    points: Floats,
    normals: Floats | None,
    planar: bool,
    seen: Survey,
    samples: dict[float, Sample],
) -> CandidateGear:
    """The scan registered to the candidate, and what that leaves; `samples` are kept by scale, which many candidates have in common."""
    points, scale = _scaled(candidate, points), candidate.proposal.scale
    if not planar and scale not in samples:
        samples[scale] = take_sample(points, normals)
    try:
        pose = rough_pose(points, candidate.gear, normals, planar, seen.pose, samples.get(scale))
        placed = refine(points, candidate.gear, pose, planar)[0]
    except InputError:
        return candidate
    located = locate(placed.pose.apply(points), candidate.gear, placed.bands)
    return replace(candidate, registration=placed, scatter=_flank_scatter(located), left=_left(located))


def share_on(candidate: CandidateGear, points: Floats) -> float:
    """Share of points that lie on a candidate's gear as it was fitted; nan where it was not."""
    if candidate.registration is None:
        return math.nan
    placed = locate(candidate.registration.pose.apply(_scaled(candidate, points)), candidate.gear, candidate.registration.bands)
    near = np.abs(placed.deviation) < NEAR_GEAR * candidate.gear.normal_module
    return float(np.mean((placed.surface != OTHER) & near))


def _left(located: SurfacePoints) -> tuple[SurfaceLeft, ...]:
    """What is left on each round surface that was seen."""
    surfaces = []
    for code in range(END_LOW):
        deviation = located.deviation[located.surface == code]
        if len(deviation) >= 30:
            surfaces.append(SurfaceLeft(SURFACE_NAMES[code], *median_scale(deviation), len(deviation)))
    return tuple(surfaces)


def _scaled(candidate: CandidateGear, points: Floats) -> Floats:
    """The scan with the scale taken out that the candidate supposes; about its middle, where the pose stays good."""
    middle = points.mean(axis=0)
    return np.asarray(middle + (points - middle) / (1.0 + candidate.proposal.scale), dtype=np.float64)


def _flank_scatter(located: SurfacePoints) -> float:
    """Robust standard deviation on the flanks of the better side without their common slope, mm.

    The other side may be worn throughout; and a slope along the profile is another base circle, which the base pitch has judged.
    """
    sides = [_scatter(located.take((located.surface == FLANK) & (located.side == side))) for side in (1, -1)]
    return float(np.nanmin(sides)) if np.isfinite(sides).any() else math.nan


def _scatter(flank: SurfacePoints) -> float:
    """Robust standard deviation about a line over the roll, mm."""
    centre, scale = median_scale(flank.deviation)
    near = np.abs(flank.deviation - centre) < 4.0 * scale
    if near.sum() < 30:
        return scale
    line = np.polynomial.Polynomial.fit(flank.roll[near], flank.deviation[near], 1)
    return median_scale(flank.deviation - line(flank.roll))[1]


def _root_scatter(located: SurfacePoints, offset: float) -> float:
    """Of fillets and roots about the common offset, mm."""
    return scale_about(located.deviation[np.isin(located.surface, (FILLET, ROOT))] - offset)


def _ranked(fitted: Sequence[CandidateGear], points: Floats) -> tuple[CandidateGear, ...]:
    scatters = [candidate.scatter for candidate in fitted if math.isfinite(candidate.scatter)]
    if not scatters:
        raise InputError(
            "a gear is seen, but the scan fits none of the proposed ones; a stated module or pressure angle may help"
        )
    least = min(scatters)

    def rank(candidate: CandidateGear) -> float:
        if not math.isfinite(candidate.scatter):
            return candidate.proposal.cost + 1e6
        return candidate.proposal.cost + 2.0 * OBSERVATIONS * math.log(candidate.scatter / least)

    best, *others = sorted(fitted, key=rank)
    return (best if best.proposal.internal else _with_rack(best, points), *others)


def _with_rack(candidate: CandidateGear, points: Floats) -> CandidateGear:
    """The rack tip radius in use whose fillet fits the scan best."""
    placed = candidate.registration
    assert placed is not None
    measured = placed.pose.apply(_scaled(candidate, points))
    best, least = candidate, math.inf
    for radius in RACK_TIP_RADII:
        try:
            gear = Gear.from_spec(replace(candidate.gear.spec, rack_tip_radius=radius))
        except InputError:
            continue
        located = locate(measured, gear, placed.bands)
        if (located.surface == FILLET).sum() < 100:
            return candidate
        scatter = _root_scatter(located, placed.offset)
        if scatter < least:
            best, least = replace(candidate, gear=gear, left=_left(located)), scatter
    return best

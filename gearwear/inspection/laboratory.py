"""What a laboratory looks at beside the deviations that are graded: sections, surfaces, waves, rolling with a master."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.arrays import Floats
from gearwear.inspection.areal import Areal, evaluate_areal
from gearwear.inspection.composite import Composite, evaluate_composite
from gearwear.inspection.evaluation import Evaluation
from gearwear.inspection.ranges import profile_place
from gearwear.inspection.sections import Sections, take_sections
from gearwear.inspection.traces import FlankSamples
from gearwear.inspection.waviness import Waviness, wave_spectrum


@dataclass(frozen=True, slots=True)
class Laboratory:
    """Ungraded results of an inspection.

    Parameters
    ----------
    spacing : float
        Mean distance of the scan's points on the flanks, mm: what is narrower than twice that was not resolved, whatever a trace shows.
    sections : Sections
        Traces along lines.
    areal : Areal
        Flanks as surfaces, and the mean flank.
    waviness : Waviness
        Orders over all teeth.
    composite : Composite or None
        Rolling with a master gear; None where a flank was not seen.
    """

    spacing: float
    sections: Sections
    areal: Areal
    waviness: Waviness
    composite: Composite | None


def examine(
    samples: FlankSamples,
    profile: Evaluation,
    helix: Evaluation,
    circle: float,
    noise: float,
    factor: float = 1.0,
    covariance: Floats | None = None,
) -> Laboratory | None:
    """Examine the flanks.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    profile, helix : Evaluation
        Traces of the whole flank.
    circle : float
        L of the measuring circle, mm.
    noise : float
        Standard deviation of one point, mm.
    factor : float
        Points per independent point.
    covariance : (6, 6) float or None
        Of the registration; None: the pose is taken as known.

    Returns
    -------
    Laboratory or None
        None of a planar section, or where nothing was seen.
    """
    if samples.is_section or not len(samples) or not math.isfinite(noise):
        return None
    gear, where, face = samples.gear, profile.range, helix.range
    inside = samples.inside(where.ends, face.ends)
    if not len(inside):
        return None
    spacing = math.sqrt(where.length * face.length / inside.per_flank)
    together = noise * math.sqrt(factor)
    areal = evaluate_areal(samples, where, face, together, covariance)
    return Laboratory(
        spacing,
        take_sections(samples, where, face, profile_place(gear, circle), noise, factor, covariance),
        areal,
        wave_spectrum(samples, where, face, together),
        evaluate_composite(gear, profile, areal, covariance),
    )

"""Traces as a laboratory takes them: profiles at mid-face and near both ends, helices at the measuring circle and near tip and root.

A scan seldom has a point on the line itself. The points of a strip round it are led to it along the surface: what the flank does across the strip, a slope
that may change along the trace and a bend, is fitted on them and taken off. The trace is that of the line then, and not the mean of the strip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.evaluation import Evaluation, evaluate
from gearwear.inspection.ranges import Range
from gearwear.inspection.registered import covariance_root, shared_errors
from gearwear.inspection.traces import FlankSamples, Traces, helix_traces, profile_traces

NEAR_END = 0.1
"""Share of the evaluation range that the outer traces lie inside of its ends."""

HALF_WIDTHS = (0.02, 0.1)
"""Least and most half width of the strip, in shares of the range across the trace."""

POINTS_PER_CUTOFF = 30.0
"""Points that a strip holds in a cut-off wavelength, if that does not make it wider than it may be."""

LED = 3
"""Errors of leading points to the line, the last of those that a trace's bins share: of each line alone."""

PLACES = ("low", "middle", "high")
"""Of profiles: near z = 0, at mid-face, near the other end; of helices: near the root, at the measuring circle, near the tip."""


@dataclass(frozen=True, slots=True)
class LineTraces:
    """The traces of all flanks along one line.

    Parameters
    ----------
    place : str
        One of `PLACES`.
    at : float
        z of profiles, place along the profile (`ranges.profile_place`) of helices, mm.
    half_width : float
        The strip whose points were led to the line, mm of z or of L to either side.
    evaluation : Evaluation
        What was found; its band is the strip.
    """

    place: str
    at: float
    half_width: float
    evaluation: Evaluation


@dataclass(frozen=True, slots=True)
class Sections:
    """Profiles and helices along three lines each, in the order of `PLACES`.

    Parameters
    ----------
    profiles, helices : tuple of LineTraces
    hand : float
        Sign of helix slopes (`evaluation`).
    """

    profiles: tuple[LineTraces, ...]
    helices: tuple[LineTraces, ...]
    hand: float = 1.0

    @property
    def profile_twist(self) -> Estimate:
        """Profile slope near the upper end less that near the lower one, over the distance of the two, carried to the whole helix range; (teeth, 2) mm."""
        low, high = self.profiles[0], self.profiles[-1]
        return _difference(high, low, self.helices[0].evaluation.range.length)

    @property
    def helix_twist(self) -> Estimate:
        """The same from the helices: their rise near the tip less that near the root; in a surface of second order both are one number."""
        low, high = self.helices[0], self.helices[-1]
        return _difference(high, low, self.profiles[0].evaluation.range.length, self.hand * np.array(Side, dtype=np.float64))


def _difference(high: LineTraces, low: LineTraces, over: float, sign: Floats | float = 1.0) -> Estimate:
    """Of slopes: what the registration does to both lines is in it by its difference, the rest by both."""
    scale = np.asarray(sign) * over / (high.at - low.at) * high.evaluation.range.length / high.evaluation.range.stated
    slopes = [line.evaluation.slope for line in (high, low)]
    moved = [np.zeros((*one.value.shape, 0)) if one.shared is None else one.shared[..., :-LED] for one in slopes]
    own = [one.standard**2 - (by**2).sum(axis=-1) for one, by in zip(slopes, moved, strict=True)]
    return Estimate.plain(
        scale * (slopes[0].value - slopes[1].value),
        np.abs(scale) * np.sqrt(np.maximum(own[0] + own[1], 0.0)),
        scale[..., None] * (moved[0] - moved[1]),
    )


def take_sections(
    samples: FlankSamples,
    profile: Range,
    helix: Range,
    circle: float,
    noise: float,
    factor: float = 1.0,
    covariance: Floats | None = None,
) -> Sections:
    """Take the traces.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    profile, helix : Range
        Evaluation ranges.
    circle : float
        Place along the profile of the measuring circle, mm.
    noise : float
        Standard deviation of one point, mm.
    factor : float
        Points per independent point.
    covariance : (6, 6) float or None
        Of the registration; None: the pose is taken as known.
    """
    density = samples.inside(profile.ends, helix.ends).per_flank / (profile.length * helix.length)

    def cut(along: str, place: str, at: float) -> LineTraces:
        where, across = (profile, helix) if along == "roll" else (helix, profile)
        wanted = 0.5 * POINTS_PER_CUTOFF / (density * where.cutoff) if density > 0.0 else math.inf
        half = across.length * min(max(wanted / across.length, HALF_WIDTHS[0]), HALF_WIDTHS[1])
        strip = (at - half, at + half)
        make = profile_traces if along == "roll" else helix_traces
        traces = make(samples, strip, where.bin_width, noise, factor)
        led, errors = led_to_line(traces, samples, at, where, noise * math.sqrt(factor))
        if covariance is not None:
            errors = np.concatenate([shared_errors(led, samples.gear, covariance), errors], axis=-1)
        return LineTraces(place, at, half, evaluate(led, where, shared=errors, hand=samples.hand))

    def places(where: Range, middle: float) -> list[float]:
        less = NEAR_END * where.length
        return [where.start + less, middle, where.end - less]

    return Sections(
        tuple(cut("roll", place, at) for place, at in zip(PLACES, places(helix, helix.middle), strict=True)),
        tuple(cut("z", place, at) for place, at in zip(PLACES, places(profile, circle), strict=True)),
        samples.hand,
    )


def led_to_line(traces: Traces, samples: FlankSamples, at: float, where: Range, noise: float) -> tuple[Traces, Floats]:
    """Traces of a strip led to the line at its middle, and what that adds to the errors of the bins.

    Parameters
    ----------
    traces : Traces
        Means of the strip.
    samples : FlankSamples
        The points they are of.
    at : float
        The line: z of a profile, L of a helix, mm.
    where : Range
        Of the traces; the slope across may change along it.
    noise : float
        Standard deviation of one point with what hangs together, mm.

    Returns
    -------
    Traces, (teeth, 2, n, `LED`) float
        The errors per standard deviation of the three independent ones of the fit, mm.

    Notes
    -----
    ``δ = trace(bin) + (x − at) (b0 + b1 t) + c (x − at)²``, x across the strip and t along it, by least squares with every bin's level free (partitioned
    regression: all is taken about the bins' means).
    """
    along, across = samples.along(traces.along)
    teeth, _, n = traces.deviation.shape
    low = float(traces.centre[0]) - 0.5 * traces.step
    inside = (across >= traces.band[0]) & (across <= traces.band[1]) & (along >= low) & (along <= low + n * traces.step)
    place = np.minimum(((along[inside] - low) / traces.step).astype(np.int64), n - 1)
    part = samples.take(inside)
    cell, number = part.flank * n + place, 2 * teeth * n
    half = 0.5 * (traces.band[1] - traces.band[0])
    x, t = (across[inside] - at) / half, where.from_middle(along[inside])
    columns = np.column_stack([x, x * t, x * x])
    count = np.maximum(np.bincount(cell, minlength=number), 1)
    mean = np.column_stack([np.bincount(cell, column, number) / count for column in columns.T])
    level = np.bincount(cell, part.deviation, number) / count
    off, remainder = columns - mean[cell], part.deviation - level[cell]
    led, errors = traces.deviation.reshape(-1, n).copy(), np.zeros((2 * teeth, n, LED))
    for index, mine in enumerate(part.by_flank()):
        if len(mine) < 2:
            continue
        inverse = np.linalg.pinv(off[mine].T @ off[mine], rcond=1e-6, hermitian=True)
        rows = mean[index * n : (index + 1) * n]
        led[index] -= rows @ (inverse @ (off[mine].T @ remainder[mine]))
        errors[index] = noise * (rows @ covariance_root(inverse))
    moved = replace(traces, deviation=led.reshape(traces.deviation.shape), across=np.where(traces.count > 0, at, np.nan))
    return moved, errors.reshape(teeth, 2, n, LED)

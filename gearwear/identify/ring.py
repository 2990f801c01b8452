"""The toothed ring of an unknown gear in its plane of rotation: tip circle, where the teeth end inwards, how many there are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.twist import wrapped_angle
from gearwear.placing.tooth_count import tooth_harmonics
from gearwear.robust import median_scale

MOST_TEETH = 400
BANDS = (0.015, 0.012, 0.008, 0.006, 0.004, 0.004, 0.004, 0.004)
"""Share of the radius round the tip circle whose points are fitted, pass by pass."""
BATCH = 64
"""Circles tried at a time, numerical: their distances from the points stay near the processor."""


@dataclass(frozen=True, slots=True)
class TipCircle:
    """The circle the tips lie on, and how far the scan is out of round.

    Parameters
    ----------
    centre : (2,) float
        mm.
    radius : float
        mm.
    oval : float
        Greatest less smallest diameter over the mean one; what stretches a scan along one direction.
    direction : float
        Of the greatest diameter, rad.
    """

    centre: Floats
    radius: float
    oval: float
    direction: float

    def polar(self, points: Floats) -> tuple[Floats, Floats]:
        """Radius (mm) and angle (rad) of points (n, 2) about the centre."""
        offset = points - self.centre
        return np.hypot(offset[:, 0], offset[:, 1]), np.arctan2(offset[:, 1], offset[:, 0])

    def rounded(self, points: Floats) -> Floats:
        """Points (n, 2) with the stretch taken out, mean size kept."""
        along = np.array([math.cos(self.direction), math.sin(self.direction)])
        offset = points - self.centre
        stretch = np.outer(offset @ along, along)
        return np.asarray(self.centre + (1.0 + 0.5 * self.oval) * offset - self.oval * stretch, dtype=np.float64)


def tip_circle(points: Floats) -> TipCircle | None:
    """Circle through the tips of a gear seen wholly or in part.

    Parameters
    ----------
    points : (n, 2) float
        In the plane of rotation, mm.

    Returns
    -------
    TipCircle or None
        None where the points have no hull or no circle is near it.

    Notes
    -----
    Of circles through three points of the hull the one with most points near it and fewest outside, then a robust fit of radius,
    centre and second harmonic to ever narrower bands.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = points[ConvexHull(points).vertices]
    except (QhullError, ValueError):
        return None
    rng = np.random.default_rng(0)
    centre, radius = _circles(hull[rng.integers(0, len(hull), (2000, 3))], float(np.ptp(points, axis=0).max()))
    if not len(radius):
        return None
    tested = points[rng.choice(len(points), min(2000, len(points)), replace=False)]
    worth = [_worth(tested, centre[at : at + BATCH], radius[at : at + BATCH]) for at in range(0, len(radius), BATCH)]
    best = int(np.argmax(np.concatenate(worth)))
    return _polish(points, centre[best], float(radius[best]))


def _worth(points: Floats, centre: Floats, radius: Floats) -> Floats:
    """(n,) of each circle: the share of points near it, less three times that of those outside.

    Few points lie near any of them, so distances are compared by their squares, less that of the middle of the band: one product of matrices.
    """
    inner, outer = (((1.0 + sign * BANDS[0]) * radius) ** 2 for sign in (-1.0, 1.0))
    middle, half = 0.5 * (outer + inner), 0.5 * (outer - inner)
    of_points = np.column_stack([points, (points**2).sum(axis=1), np.ones(len(points))])
    of_circles = np.column_stack([-2.0 * centre, np.ones(len(centre)), (centre**2).sum(axis=1) - middle])
    beyond = of_circles @ of_points.T
    near = np.flatnonzero(np.abs(beyond) < half[:, None])
    circle = near // len(points)
    gap = (np.sqrt(beyond.ravel()[near] + middle[circle]) / radius[circle] - 1.0) / BANDS[0]
    worth = np.bincount(circle, 1.0 - gap**2, minlength=len(radius))
    return np.asarray((worth - 3.0 * (beyond >= half[:, None]).sum(axis=1)) / len(points), dtype=np.float64)


def _circles(triples: Floats, size: float) -> tuple[Floats, Floats]:
    """Centres (n, 2) and radii (n,) of the circles through triples (m, 3, 2) of points that are well spread."""
    first, b, c = triples[:, 0], triples[:, 1] - triples[:, 0], triples[:, 2] - triples[:, 0]
    twice_area = b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]
    spread = np.abs(twice_area) > 0.01 * size**2
    first, b, c, twice_area = first[spread], b[spread], c[spread], twice_area[spread]
    bb, cc = (b**2).sum(axis=1), (c**2).sum(axis=1)
    lift = np.column_stack([c[:, 1] * bb - b[:, 1] * cc, b[:, 0] * cc - c[:, 0] * bb]) / (2.0 * twice_area[:, None])
    radius = np.hypot(lift[:, 0], lift[:, 1])
    sane = radius < 2.0 * size
    return (first + lift)[sane], radius[sane]


def _polish(points: Floats, centre: Floats, radius: float) -> TipCircle | None:
    wave = np.zeros(2)
    for band in BANDS:
        offset = points - centre
        r = np.hypot(offset[:, 0], offset[:, 1])
        perhaps = np.abs(r - radius) < band * radius + 2.0 * float(np.hypot(*wave))  # of the others the angle is not asked
        r, angle = r[perhaps], np.arctan2(offset[perhaps, 1], offset[perhaps, 0])
        gap = r - radius - wave[0] * np.cos(2.0 * angle) - wave[1] * np.sin(2.0 * angle)
        near = np.abs(gap) < band * radius
        if near.sum() < 20:
            return None
        gap, angle = gap[near], angle[near]
        columns = np.column_stack([np.ones_like(angle), np.cos(angle), np.sin(angle), np.cos(2.0 * angle), np.sin(2.0 * angle)])
        middle, scale = median_scale(gap)
        good = np.abs(gap - middle) <= 2.5 * max(scale, 1e-12)
        few = len(np.unique(np.floor(angle[good] * (12.0 / math.pi)))) < 20  # part of a turn says nothing on the oval
        used = columns[good, :3] if few else columns[good]
        step = np.linalg.lstsq(used, gap[good], rcond=None)[0]
        radius, centre = radius + float(step[0]), centre + step[1:3]
        if not radius > 0.0:
            return None
        wave = wave + step[3:] if not few else np.zeros(2)
    return TipCircle(centre, radius, 2.0 * float(np.hypot(*wave)) / radius, 0.5 * math.atan2(wave[1], wave[0]))


EMPTY_RING = 0.02
"""Width of an empty ring in tip radii: a narrower one is where the feet of the flanks were seen thinly."""


def innermost(radius: Floats, tip: float) -> float:
    """Radius (mm) where the surface of the teeth ends inwards: above the first empty ring below the tips."""
    edges = np.linspace(0.2 * tip, 0.985 * tip, 801)
    wide = math.ceil(EMPTY_RING * tip / (edges[1] - edges[0]))
    count = np.histogram(radius, edges)[0]
    if not count.any():
        return 0.2 * tip
    thin = count < 0.03 * np.median(count[count > 0])
    empty = 0
    for i in range(len(count) - 1, -1, -1):
        empty = empty + 1 if thin[i] else 0
        if empty == wide:
            return float(edges[i + wide])
    return float(edges[0])


@dataclass(frozen=True, slots=True)
class ToothCount:
    """How many teeth, where one of them is, and how sure that is.

    Parameters
    ----------
    teeth : int
    phase : float
        Polar angle of a tooth's centre line, rad.
    share : float
        Share of the angular pattern that repeats from tooth to tooth, 0 … 1; about 0.1 for a view of part of a gear.
    """

    teeth: int
    phase: float
    share: float


def count_teeth(
    radius: Floats, angle: Floats, root: float, tip: float, turn: Floats | float = 0.0, known: int | None = None
) -> ToothCount | None:
    """Number of teeth from the pattern of points in rings between root and tip.

    Parameters
    ----------
    radius, angle : (n,) float
        mm and rad about the axis.
    root, tip : float
        Ends of the teeth, mm.
    turn : (n,) float
        What the helix of the teeth turned each point by, rad.
    known : int or None
        The tooth count, where it is known and only the place of a tooth is sought.

    Returns
    -------
    ToothCount or None
        None where nothing repeats.

    Notes
    -----
    The outer rings count +, the inner ones −, so teeth and spaces add up in the harmonics z, 3z, 5z … Every number is judged by what its
    multiples hold together; divisors of z hold as much, multiples less, so the greatest number that holds nearly all is z.
    """
    rings = 16
    ring = np.clip(((radius - root) * (rings / (tip - root))).astype(np.int64), -1, rings - 1)
    moment = tooth_harmonics(wrapped_angle(angle - turn), ring, rings, 20)
    power = np.abs(moment) ** 2
    power[:4] = 0.0
    power = np.maximum(power - 2.0 * np.median(power[4:2000]), 0.0)
    if not power.any():
        return None
    held = np.array([power[n::n][:9].sum() if n >= 5 else 0.0 for n in range(MOST_TEETH + 1)])
    teeth = int(np.flatnonzero(held > 0.75 * held.max())[-1]) if known is None else known
    # Of exp(−i n (θ + π)).
    phase = -math.pi - float(np.angle(moment[teeth])) / teeth
    return ToothCount(teeth, phase, float(held[teeth] / power.sum()))

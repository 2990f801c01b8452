"""What a stylus ball feels of a trace: the morphological closing with a ball (ISO 16610-41), for comparison with a gear measuring machine."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.quantity import as_given, at_most
from gearwear.errors import InputError
from gearwear.inspection.traces import Traces

SMALLEST, LARGEST = 0.01, 100.0
"""mm; radii of a stylus ball that make sense."""
LEAST_CURVATURE = 1e-3
"""1/mm; the ball beyond a ring's tip, where traces reach past the flank, is no flatter."""


def check_ball(radius: float | None, gear: Gear) -> None:
    """Refuse a stylus ball of no sensible radius, or one that does not fit a hollow flank.

    Parameters
    ----------
    radius : float or None
        mm; None is no ball.
    gear : Gear

    Raises
    ------
    InputError
        If it is not within `SMALLEST` and `LARGEST`, or on a ring not below the flank's least radius of curvature, L / cos β_b at the tip.
    """
    if radius is None:
        return
    if not SMALLEST <= radius <= LARGEST:
        raise InputError(f"stylus radius {radius:g} mm: a ball of {SMALLEST:g} to {LARGEST:g} mm would be right")
    hollow = gear.tip_roll / gear.base_helix_cosine
    if gear.spec.internal and not radius < hollow:
        raise InputError(
            f"stylus radius {as_given(radius)} mm: does not fit the ring's hollow flanks; below {at_most(hollow, 3)} mm would"
        )


def ball_notes(radius: float | None) -> list[str]:
    """That traces are as a ball feels them."""
    if radius is None:
        return []
    return [f"Profiles and helices are as a stylus ball of {radius:g} mm radius feels them; pitch and thickness are as scanned."]


def closed(place: Floats, value: Floats, radius: Floats | float) -> Floats:
    """The trace that a ball rolling over it touches or bridges.

    Parameters
    ----------
    place : (n,) float
        Along the surface, rising, mm.
    value : (n,) float
        Height, + is more material, mm.
    radius : (n,) float or float
        Of the ball, mm; where it varies, that against the surface at each place.

    Returns
    -------
    (n,) float
        Nowhere lower than `value`. Pits that the ball cannot reach the ground of are bridged by its arc; peaks stay.

    Notes
    -----
    Dilation by the ball gives the locus of its centre, erosion by the same ball what its underside passes. On samples h apart the result is
    low by at most the ball's sag over half a step, h² / (8 R).

    >>> pit = np.where(np.abs(np.linspace(-1.0, 1.0, 201)) < 0.195, -1.0, 0.0)
    >>> float(np.round(closed(np.linspace(-1.0, 1.0, 201), pit, 0.5).min(), 4))  # R − √(R² − 0.2²)
    -0.0417
    """
    ball = np.broadcast_to(np.asarray(radius, dtype=np.float64), place.shape)
    across = place[:, None] - place[None, :]
    square = ball[None, :] ** 2 - across**2
    sag = np.where(square >= 0.0, ball[None, :] - np.sqrt(np.maximum(square, 0.0)), np.inf)
    centre = (value[None, :] - sag).max(axis=1)
    return np.asarray((centre[None, :] + sag.T).min(axis=1), dtype=np.float64)


def felt(traces: Traces, radius: float | None, gear: Gear) -> Traces:
    """Traces as a stylus of a given radius feels them; as they are where none is given.

    Notes
    -----
    Places are along the surface: a profile's arc is L² / (2 r_b), a helix's z / cos β_r at the middle of its band. Heights are along the
    normal, in which the ball is round: cos β_b of a deviation along the transverse base tangent. The flank is straight along
    its generators and square to them curved by cos β_b / L: the transverse involute by 1 / L, its normal inclined by β_b (Meusnier). A ball
    of radius R lies on it as one of radius R' on a plane: 1 / R' = 1 / R + ι cos β_b / L, ι −1 on a ring, which is hollow. A helix trace lies
    within degrees of the generator: there the flank is taken as straight.
    """
    check_ball(radius, gear)
    if radius is None:
        return traces
    at = math.hypot(gear.base_radius, 0.5 * (traces.band[0] + traces.band[1])) if traces.along == "z" else gear.base_radius
    along_helix = math.hypot(1.0, at / gear.base_radius * math.tan(math.acos(gear.base_helix_cosine)))  # 1 / cos β_r
    height = gear.base_helix_cosine * traces.deviation
    for flank in np.ndindex(*height.shape[:2]):
        seen = np.flatnonzero((traces.count[flank] > 0) & np.isfinite(traces.station[flank]))
        if len(seen) < 3:
            continue
        order = seen[np.argsort(traces.station[flank][seen], kind="stable")]
        station = traces.station[flank][order]
        ball: Floats | float = radius
        if traces.along == "roll":
            roll = np.maximum(np.abs(station), 1e-3)
            station = gear.orientation * roll**2 / (2.0 * gear.base_radius)
            curved = gear.orientation * gear.base_helix_cosine / roll
            ball = 1.0 / np.maximum(1.0 / radius + curved, LEAST_CURVATURE)
        else:
            station = station * along_helix
        height[flank][order] = closed(station, height[flank][order], ball)
    return replace(traces, deviation=height / gear.base_helix_cosine)

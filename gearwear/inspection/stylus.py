"""What a stylus ball feels of a trace: the morphological closing with a ball (ISO 16610-41), for comparison with a gear measuring machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.inspection.traces import Traces


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
    Places are along the surface: a profile's arc is L² / (2 r_b), a helix's z / cos β_b. On an involute, which is curved with the radius L,
    a ball of radius R lies as one of radius R' does on a plane: 1 / R' = 1 / R + 1 / L, of a ring, which is hollow, 1 / R − 1 / L.
    """
    if radius is None:
        return traces
    deviation = traces.deviation.copy()
    for flank in np.ndindex(*deviation.shape[:2]):
        seen = np.flatnonzero((traces.count[flank] > 0) & np.isfinite(traces.station[flank]))
        if len(seen) < 3:
            continue
        order = seen[np.argsort(traces.station[flank][seen], kind="stable")]
        station = traces.station[flank][order]
        ball: Floats | float = radius
        if traces.along == "roll":
            roll = np.maximum(np.abs(station), 1e-3)
            station = gear.orientation * roll**2 / (2.0 * gear.base_radius)
            ball = 1.0 / np.maximum(1.0 / radius + gear.orientation / roll, 1e-3)
        else:
            station = station / gear.base_helix_cosine
        deviation[flank][order] = closed(station, deviation[flank][order], ball)
    return replace(traces, deviation=deviation)

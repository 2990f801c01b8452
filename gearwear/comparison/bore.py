"""The flanks about the axis of the bore, of a ring of its outside, in place of that of the teeth: what runs out when the gear is mounted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.surface import BORE, SurfacePoints
from gearwear.diagnose.effects.base import Kind
from gearwear.errors import InputError
from gearwear.placing.pose import motion_columns

LEAST_POINTS = 60
"""On the bore."""

LEAST_SECTORS = 9
"""Of 12 in which the bore must be seen."""

CLIPPED = 4.0
"""Robust standard deviations beyond which a point of the bore is none: a keyway, a chamfer."""

PASSES = 6
"""Of least squares without the points beyond that."""

FREE = [0, 1, 3, 4]
"""Motions (tx, ty, tz, wx, wy, wz) that a cylinder tells of."""


@dataclass(frozen=True, slots=True)
class BoreAxis:
    """Where the bore, or the outside of a ring, lies in the design frame.

    Parameters
    ----------
    motion : (6,) float
        By which the bore is off the design's axis (tx, ty, 0 in mm; wx, wy, 0 in rad), as a motion of the whole.
    covariance : (6, 6) float
        Of that; 0 for the motions that a bore does not tell of.
    smaller : float
        By how much its radius is less than the design's, mm.
    points : int
        In use.
    """

    motion: Floats
    covariance: Floats
    smaller: float
    points: int


def bore_axis(measured: MeasuredGear) -> BoreAxis:
    """Fit the bore as a cylinder: axis, tilt and radius by least squares on its points, those of a keyway left out.

    Raises
    ------
    InputError
        If the design has no bore, or the scan shows too little of it.
    """
    body, key = ("bore", "bore_diameter") if measured.gear.orientation > 0 else ("outside", "rim_diameter")
    if measured.gear.body_radius == 0.0:
        raise InputError(f"an axis from the {body} needs {key} in the design")
    points = _straightened(measured, measured.located.take(measured.located.surface == BORE))
    angle = np.arctan2(points.position[:, 1], points.position[:, 0])
    sectors = len(np.unique(np.floor(angle / (math.pi / 6.0)))) if len(points) else 0
    if len(points) < LEAST_POINTS or sectors < LEAST_SECTORS:
        raise InputError(
            f"an axis from the {body}: {len(points)} points in {sectors} of 12 sectors were seen of it, at least {LEAST_POINTS} in {LEAST_SECTORS} are needed"
        )
    columns = np.column_stack([motion_columns(points.position, points.normal)[:, FREE], np.ones(len(points))])
    use = np.ones(len(points), dtype=bool)
    solution = np.zeros(columns.shape[1])
    for _ in range(PASSES):
        solution = np.linalg.lstsq(columns[use], points.deviation[use], rcond=None)[0]
        left = points.deviation - columns @ solution
        spread = 1.4826 * float(np.median(np.abs(left[use] - np.median(left[use]))))
        use = np.abs(left - np.median(left[use])) <= CLIPPED * max(spread, 1e-6)
    variance = float((left[use] ** 2).sum() / max(int(use.sum()) - columns.shape[1], 1))
    motion, covariance = np.zeros(6), np.zeros((6, 6))
    motion[FREE] = solution[:-1]
    covariance[np.ix_(FREE, FREE)] = variance * np.linalg.pinv(columns[use].T @ columns[use])[:-1, :-1]
    return BoreAxis(motion, covariance, measured.gear.orientation * float(solution[-1]), int(use.sum()))


def flanks_about_bore(measured: MeasuredGear, axis: BoreAxis) -> tuple[SurfacePoints, Floats]:
    """The flanks about the axis of the bore, and the covariance (6, 6) of the motion that they are then unsure by.

    Notes
    -----
    Measurement effects are taken out, how the teeth sit on the bore is not: it is what is looked for. In first order ``δ − n · (t + w × p)``; 50 µm of eccentricity
    change that by 0.3 µm at most. Height and rotation stay those of the registration.
    """
    flanks = measured.flanks
    if measured.loop is not None:
        flanks = flanks.with_deviation(flanks.deviation + measured.loop.deviation(flanks, frozenset({Kind.MOUNTING})))
    about = flanks.with_deviation(flanks.deviation - motion_columns(flanks.position, flanks.normal) @ axis.motion)
    covariance = measured.placed.registration.covariance.copy()
    covariance[FREE, :] = 0.0
    covariance[:, FREE] = 0.0
    return about, covariance + axis.covariance


def _straightened(measured: MeasuredGear, points: SurfacePoints) -> SurfacePoints:
    """Without what the scanner added."""
    if measured.loop is None or not len(points):
        return points
    return points.with_deviation(points.deviation - measured.loop.deviation(points, frozenset({Kind.MEASUREMENT})))

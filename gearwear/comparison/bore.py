"""The flanks about the axis of a datum (bore, diameter bands, end faces), in place of that of the teeth: what runs out when the gear is mounted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.quantity import at_most
from gearwear.design.surface import BORE, END_HIGH, END_LOW, OTHER, SurfacePoints
from gearwear.diagnose.effects.base import Kind
from gearwear.errors import InputError
from gearwear.inspection.settings import Settings
from gearwear.placing.pose import motion_columns
from gearwear.robust import median_scale

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
TILTS = [3, 4]
"""Those that a plane across the axis tells of, beside its height."""
BAND_REACH = 0.02
"""Of the diameter: how far a point of a band may lie off it."""
LEAST_SPAN = 1.0
"""Modules of height over which bands must be seen."""
STRAY_PERCENTILES = (2.0, 98.0)
"""Of the heights of a band's points: between them it was seen, a stray aside."""


@dataclass(frozen=True, slots=True)
class BoreAxis:
    """Where the bore lies in the design frame.

    Parameters
    ----------
    motion : (6,) float
        By which the bore is off the design's axis (tx, ty, 0 in mm; wx, wy, 0 in rad), as a motion of the whole.
    covariance : (6, 6) float
        Of that; 0 for the motions that a bore does not tell of.
    smaller : float
        By how much its radius is less than the design's, mm; of bands and ends the level of the first.
    points : int
        In use.
    freedoms : tuple of int
        Which motions it tells of; the others stay those of the registration.
    """

    motion: Floats
    covariance: Floats
    smaller: float
    points: int
    freedoms: tuple[int, ...] = (0, 1, 3, 4)


def datum_axis(measured: MeasuredGear, axis: str) -> BoreAxis:
    """The axis that the drawing's datum gives.

    Parameters
    ----------
    measured : MeasuredGear
    axis : str
        "bore"; "bands": what the design's ``[[datum.band]]`` says is round about the axis; "ends": square to the end faces, through the middle
        of the teeth.

    Raises
    ------
    InputError
        If the design does not have it, or the scan shows too little of it.
    """
    return {"bore": bore_axis, "bands": band_axis, "ends": end_axis}[axis](measured)


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
    _check_seen(f"an axis from the {body}", points.position)
    axis = _fitted([points], FREE)
    return replace(axis, smaller=measured.gear.orientation * axis.smaller)


def band_axis(measured: MeasuredGear) -> BoreAxis:
    """Fit the stated diameter bands as cylinders about one axis: seats of bearings, a shoulder, a hub; each with a radius of its own.

    Raises
    ------
    InputError
        If none is stated, the scan shows too little of one, or they are seen over too little height to tell a tilt.
    """
    if not measured.design.datum.bands:
        raise InputError("an axis from diameter bands: the design names none; [[datum.band]] with diameter_mm and z_mm would")
    place = measured.located.measured
    radius, groups, heights = np.hypot(place[:, 0], place[:, 1]), [], []
    for band in measured.design.datum.bands:
        on = np.abs(radius - 0.5 * band.diameter) < BAND_REACH * band.diameter
        on &= (place[:, 2] >= band.low) & (place[:, 2] <= band.high)
        points = place[on]
        _check_seen(f"an axis from the band of {band.diameter:g} mm, z {band.low:g} … {band.high:g}", points)
        heights += np.percentile(points[:, 2], STRAY_PERCENTILES).tolist()
        outward = np.column_stack([points[:, :2] / radius[on, None], np.zeros(len(points))])
        foot = points - (radius[on] - 0.5 * band.diameter)[:, None] * outward
        nothing = np.zeros(len(points), dtype=np.int32)
        surface = SurfacePoints(
            np.full(len(points), OTHER, np.int8), nothing, nothing.astype(np.int8), np.full(len(points), np.nan), foot, outward,
            radius[on] - 0.5 * band.diameter,
        )  # fmt: skip
        groups.append(_straightened(measured, surface))
    least, wide = LEAST_SPAN * measured.gear.normal_module, max(heights) - min(heights)
    if wide < least:
        raise InputError(
            f"an axis from diameter bands: they were seen over {at_most(wide, 2)} mm of height, whatever was stated; at least {least:g} mm tell a tilt"
        )
    return _fitted(groups, FREE)


def end_axis(measured: MeasuredGear) -> BoreAxis:
    """The axis square to the end faces, as they lie together; where it passes is told by the teeth, at mid-face.

    Raises
    ------
    InputError
        If the scan shows too little of both faces.
    """
    groups = []
    for code in (END_LOW, END_HIGH):
        points = _straightened(measured, measured.located.take(measured.located.surface == code))
        if len(points) >= LEAST_POINTS and _sectors(points.position) >= LEAST_SECTORS:
            groups.append(points)
    if not groups:
        raise InputError(
            f"an axis from the end faces: neither was seen all round; {LEAST_POINTS} points in {LEAST_SECTORS} of 12 sectors are needed"
        )
    axis = _fitted(groups, TILTS)
    # A tilt about z = 0 moves the middle of the teeth, where the axis is to stay.
    about = np.eye(6)
    about[0, 4] = about[1, 3] = 0.5 * measured.gear.face_width
    about[0, 4] *= -1.0
    return replace(axis, motion=about @ axis.motion, covariance=about @ axis.covariance @ about.T)


def _sectors(places: Floats) -> int:
    """In how many of 12 sectors points lie."""
    angle = np.arctan2(places[:, 1], places[:, 0])
    return len(np.unique(np.floor(angle / (math.pi / 6.0)))) if len(places) else 0


def _check_seen(wanted: str, places: Floats) -> None:
    if len(places) < LEAST_POINTS or _sectors(places) < LEAST_SECTORS:
        raise InputError(
            f"{wanted}: {len(places)} points in {_sectors(places)} of 12 sectors were seen of it, at least {LEAST_POINTS} in {LEAST_SECTORS} are needed"
        )


def _fitted(groups: Sequence[SurfacePoints], free: list[int]) -> BoreAxis:
    """Least squares for the motions that are free and a level of each group."""
    position, normal, deviation = (
        np.concatenate([getattr(group, name) for group in groups]) for name in ("position", "normal", "deviation")
    )
    member = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    levels = (member[:, None] == np.arange(len(groups))).astype(np.float64)
    columns = np.column_stack([motion_columns(position, normal)[:, free], levels])
    use = np.ones(len(columns), dtype=bool)
    solution = np.zeros(columns.shape[1])
    for _ in range(PASSES):
        solution = np.linalg.lstsq(columns[use], deviation[use], rcond=None)[0]
        left = deviation - columns @ solution
        middle, spread = median_scale(left[use])
        use = np.abs(left - middle) <= CLIPPED * max(spread, 1e-6)
    variance = float((left[use] ** 2).sum() / max(int(use.sum()) - columns.shape[1], 1))
    count = len(free)
    motion, covariance = np.zeros(6), np.zeros((6, 6))
    motion[free] = solution[:count]
    covariance[np.ix_(free, free)] = variance * np.linalg.pinv(columns[use].T @ columns[use])[:count, :count]
    return BoreAxis(motion, covariance, float(solution[count]), int(use.sum()), tuple(free))


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
    freedoms = list(axis.freedoms)
    covariance[freedoms, :] = 0.0
    covariance[:, freedoms] = 0.0
    return about, covariance + axis.covariance


def filled_in(measured: MeasuredGear, settings: Settings) -> tuple[SurfacePoints, Settings]:
    """The flanks about the axis that pitch and runout are asked about, and the settings with what they leave out.

    Parameters
    ----------
    measured : MeasuredGear
    settings : Settings
        Where `axis` is None, it is that of the design's ``[datum]``; `noise` that of the scan, `pose_covariance` that of the registration and
        the datum, `scale_std` that of the design.

    Raises
    ------
    InputError
        If the design does not have the datum, or the scan shows too little of it.
    """
    axis = settings.axis or measured.design.datum.axis
    if axis == "teeth":
        flanks, covariance = measured.flanks, measured.placed.registration.covariance
    else:
        flanks, covariance = flanks_about_bore(measured, datum_axis(measured, axis))
    return flanks, replace(
        settings,
        axis=axis,
        noise=measured.noise if settings.noise is None else settings.noise,
        pose_covariance=covariance if settings.pose_covariance is None else settings.pose_covariance,
        scale_std=measured.design.scale_std if settings.scale_std is None else settings.scale_std,
    )


def _straightened(measured: MeasuredGear, points: SurfacePoints) -> SurfacePoints:
    """Without what the scanner added."""
    if measured.loop is None or not len(points):
        return points
    return points.with_deviation(points.deviation - measured.loop.deviation(points, frozenset({Kind.MEASUREMENT})))

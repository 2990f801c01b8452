"""A half of a double helical gear by itself: ISO 1328-1 evaluates each helix as the gear of one helix that it is."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import SurfacePoints
from gearwear.design.twist import Segment, segments
from gearwear.errors import InputError
from gearwear.inspection.inspection import Inspection, inspect
from gearwear.inspection.settings import Settings


class Half(StrEnum):
    """A half of the face; the lower one begins at z = 0."""

    LOWER = "lower"
    UPPER = "upper"


def half_gear(gear: Gear, half: Half) -> Gear:
    """A half of a double helical gear as a gear of one helix; its z begins at the half's own lower end.

    Raises
    ------
    InputError
        If the gear has no halves.
    """
    part, spec = _segment(gear, half), gear.spec
    angle = spec.helix_angle if half is Half.LOWER else -spec.helix_angle
    return Gear.from_spec(replace(spec, face_width=part.high - part.low, gap=0.0, helix_angle=angle))


def half_points(points: SurfacePoints, gear: Gear, half: Half) -> SurfacePoints:
    """Those located points of a double helical gear that lie on a half, in the frame of `half_gear`."""
    part = _segment(gear, half)
    z = points.position[:, 2]
    of_half = points.take((z >= part.low) & (z <= part.high))
    return replace(of_half, position=of_half.position - np.array([0.0, 0.0, part.low]))


def half_covariance(covariance: Floats, gear: Gear, half: Half) -> Floats:
    """Covariance (6, 6) of a motion (tx, ty, tz in mm; wx, wy, wz in rad) about the origin of `half_gear`'s frame: t' = t + w × (0, 0, low).
    A seventh cause, the scale, stays."""
    moved, low = np.eye(len(covariance)), _segment(gear, half).low
    moved[0, 4], moved[1, 3] = low, -low
    return np.asarray(moved @ covariance @ moved.T)


def inspect_half(points: SurfacePoints, gear: Gear, half: Half | None, settings: Settings) -> Inspection:
    """The inspection of a half; of a gear of one helix, where `half` is None, of the whole.

    Parameters
    ----------
    points : SurfacePoints
        Located on `gear`.
    gear : Gear
    half : Half or None
    settings : Settings
        Places in the frame of `half_gear`, the pose's covariance in that of the gear.
    """
    if half is None:
        return inspect(points, gear, settings)
    known = settings.pose_covariance
    moved = None if known is None else half_covariance(known, gear, half)
    return inspect(half_points(points, gear, half), half_gear(gear, half), replace(settings, pose_covariance=moved))


def _segment(gear: Gear, half: Half) -> Segment:
    if gear.spec.gap == 0.0:
        raise InputError(f"[{gear.spec.name}] the {half} half: the gear has one helix and no halves (gap = 0); leave it out")
    return segments(gear)[0 if half is Half.LOWER else 1]

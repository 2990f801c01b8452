"""Rigid motions: from the scan's frame to the design's."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.twist import has_screw


@dataclass(frozen=True, slots=True)
class Pose:
    """design = rotation · scan + translation.

    Parameters
    ----------
    rotation : (3, 3) float
        Proper rotation matrix.
    translation : (3,) float
        mm.
    """

    rotation: Floats
    translation: Floats

    @classmethod
    def identity(cls) -> Pose:
        return cls(np.eye(3), np.zeros(3))

    def apply(self, points: Floats) -> Floats:
        """Points (n, 3) of the scan in the design frame, mm."""
        return points @ self.rotation.T + self.translation

    def turn(self, vectors: Floats) -> Floats:
        """Directions (n, 3) of the scan in the design frame."""
        return vectors @ self.rotation.T

    def then(self, after: Pose) -> Pose:
        """This motion, and `after` behind it."""
        return Pose(after.rotation @ self.rotation, after.rotation @ self.translation + after.translation)

    def inverse(self) -> Pose:
        return Pose(self.rotation.T, -self.rotation.T @ self.translation)

    @property
    def angle(self) -> float:
        """Angle of the rotation, rad; well conditioned at 0 and π."""
        skew = self.rotation - self.rotation.T
        sine = 0.5 * math.sqrt(skew[2, 1] ** 2 + skew[0, 2] ** 2 + skew[1, 0] ** 2)
        return math.atan2(sine, 0.5 * (float(np.trace(self.rotation)) - 1.0))


def small_motion(motion: Floats) -> Pose:
    """Pose of a motion (tx, ty, tz, wx, wy, wz): translation in mm, rotation vector in rad (Rodrigues)."""
    t, w = np.asarray(motion[:3], dtype=np.float64), np.asarray(motion[3:], dtype=np.float64)
    angle = float(np.linalg.norm(w))
    cross = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
    if angle < 1e-12:
        return Pose(np.eye(3) + cross, t)
    rotation = np.eye(3) + math.sin(angle) / angle * cross + (1.0 - math.cos(angle)) / angle**2 * (cross @ cross)
    return Pose(rotation, t)


def size_of_motion(motion: Floats, radius: float) -> float:
    """How far a small motion, or the standard deviations of one (tx, ty, tz in mm, wx, wy, wz in rad), carries points at a radius at most, mm."""
    return float(np.linalg.norm(motion[:3]) + radius * np.linalg.norm(motion[3:]))


def about_z(angle: float) -> Pose:
    """Rotation about the axis by `angle` rad."""
    return small_motion(np.array([0.0, 0.0, 0.0, 0.0, 0.0, angle]))


def along_screw(pose: Pose, gear: Gear, height: float) -> Pose:
    """`pose` moved up by `height` (mm) along the teeth: on the flanks everything stays as it was, but for those of double helical gears, which
    no screw carries into themselves."""
    lifted = Pose(pose.rotation, pose.translation + np.array([0.0, 0.0, height]))
    return lifted.then(about_z(gear.twist * height)) if has_screw(gear) else lifted


def flip(face_width: float) -> Pose:
    """Half a turn about x and back up: swaps the ends of a gear of this face width (mm), and left and right; keeps tooth 1 on +x."""
    return Pose(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, face_width]))


def motion_columns(position: Floats, normal: Floats) -> Floats:
    """Change of deviation per unit of motion of the points, (n, 6): n · (t + w × p).

    Parameters
    ----------
    position, normal : (n, 3) float
        In the design frame, mm and unit.
    """
    columns = np.empty((len(position), 6))
    columns[:, :3] = normal
    for axis in range(3):  # `np.cross` takes several times as long
        after, last = (axis + 1) % 3, (axis + 2) % 3
        columns[:, 3 + axis] = position[:, after] * normal[:, last] - position[:, last] * normal[:, after]
    return columns


def least_turn(pose: Pose, gear: Gear, reference: Pose, way_up_told: bool = False) -> Pose:
    """Of the 2 z poses a gear's symmetry leaves, the one that turns least from `reference`; of the z where the way up is told, as by the hands of a
    double helical gear."""
    best, least = pose, _turn_between(pose, reference)
    ends = (pose,) if way_up_told or gear.spec.gap > 0.0 else (pose, pose.then(flip(gear.face_width)))
    for upside in ends:
        # The trace of R_z(a) R is cos a (Rxx + Ryy) + sin a (Rxy − Ryx) + Rzz: greatest at this angle.
        r = upside.rotation @ reference.rotation.T
        ideal = np.arctan2(r[0, 1] - r[1, 0], r[0, 0] + r[1, 1])
        turned = upside.then(about_z(round(ideal / gear.pitch_angle) * gear.pitch_angle))
        angle = _turn_between(turned, reference)
        if angle < least - 1e-9:
            best, least = turned, angle
    return best


def tooth_at(pose: Pose, gear: Gear, angle: float) -> Pose:
    """Turn by whole teeth that makes the tooth in a direction of the scan tooth 1.

    Parameters
    ----------
    pose : Pose
        Of the scan on its design.
    gear : Gear
    angle : float
        From the scan's own +x towards its +y, rad.
    """
    x, y, _ = pose.rotation @ np.array([math.cos(angle), math.sin(angle), 0.0])
    return about_z(-round(math.atan2(y, x) / gear.pitch_angle) * gear.pitch_angle)


def _turn_between(pose: Pose, reference: Pose) -> float:
    return Pose(pose.rotation @ reference.rotation.T, pose.translation).angle

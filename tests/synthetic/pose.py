"""Rigid motions: where the gear stood when it was scanned, and how far a found pose is from that."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tests.synthetic.outline import Floats, Outline


@dataclass(frozen=True)
class Rigid:
    """image = rotation · point + translation; for a scan's pose: scan = R · design + t."""

    rotation: Floats  # (3, 3)
    translation: Floats  # (3,) mm

    def apply(self, points: Floats) -> Floats:
        """Move (n, 3) points."""
        return points @ self.rotation.T + self.translation

    def inverse(self) -> Rigid:
        return Rigid(self.rotation.T, -self.rotation.T @ self.translation)

    def after(self, first: Rigid) -> Rigid:
        """The motion that does `first`, then this."""
        return Rigid(self.rotation @ first.rotation, self.rotation @ first.translation + self.translation)

    @property
    def angle(self) -> float:
        """Angle of rotation, rad; keeps its digits when small."""
        a = self.rotation - self.rotation.T
        sine = 0.5 * math.hypot(a[2, 1], a[0, 2], a[1, 0])
        return math.atan2(sine, 0.5 * (np.trace(self.rotation) - 1.0))


IDENTITY = Rigid(np.eye(3), np.zeros(3))


def rotation_about(vector: Floats) -> Floats:
    """Rotation matrix of a rotation vector in rad (Rodrigues)."""
    x, y, z = vector
    angle = float(np.linalg.norm(vector))
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    half = np.sinc(0.5 * angle / np.pi)
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * half * half * cross @ cross)


def mild_pose(outline: Outline, rng: np.random.Generator) -> Rigid:
    """Up to 0.4 of a pitch about z, so that tooth 1 stays tooth 1; up to 2° about x and y; up to 2 mm per axis."""
    tilt = math.radians(2.0)
    turn = 0.4 * outline.pitch_angle
    about = rng.uniform(-1.0, 1.0, 3) * np.array([tilt, tilt, turn])
    return Rigid(rotation_about(about), rng.uniform(-2.0, 2.0, 3))


def any_pose(rng: np.random.Generator) -> Rigid:
    """Any orientation with equal chance (a random unit quaternion), up to 50 mm per axis."""
    w, x, y, z = (q := rng.standard_normal(4)) / np.linalg.norm(q)
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return Rigid(rotation, rng.uniform(-50.0, 50.0, 3))


def view_pose(rng: np.random.Generator) -> Rigid:
    """Up to 1.5° about z, 1° about x and y, 1 mm per axis, as in the practice scans."""
    about = np.radians(rng.uniform(-1.0, 1.0, 3) * np.array([1.0, 1.0, 1.5]))
    return Rigid(rotation_about(about), rng.uniform(-1.0, 1.0, 3))


@dataclass(frozen=True, slots=True)
class PoseError:
    """How far a found registration is from the true pose, after the gear's own symmetry is taken out.

    `teeth` pitches were turned (true tooth k is found as tooth k + teeth, or as −k + teeth when `flipped`, with left and
    right exchanged), `angle` (rad) and `shift` (mm) remain. `turn` is the part of the angle about the gear axis,
    `tilt` the part across it; `shift` is of the middle of the gear.
    """

    angle: float
    turn: float
    tilt: float
    shift: Floats
    teeth: int
    flipped: bool


def pose_error(rotation: Floats, translation: Floats, true: Rigid, outline: Outline) -> PoseError:
    """Compare design = rotation · scan + translation (as in `report.json`) with scan = R · design + t.

    Parameters
    ----------
    rotation, translation : (3, 3), (3,) float
        The registration found.
    true : Rigid
        The pose of the truth.
    outline : Outline

    Returns
    -------
    PoseError
    """
    whole = Rigid(np.asarray(rotation), np.asarray(translation)).after(true)  # design to found design
    flipped = bool(whole.rotation[2, 2] < 0.0)
    b = outline.face_width
    flip = Rigid(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, b])) if flipped else IDENTITY
    rest = whole.after(flip)  # the flip is its own inverse
    turned = math.atan2(rest.rotation[1, 0] - rest.rotation[0, 1], rest.rotation[0, 0] + rest.rotation[1, 1])
    teeth = round(turned / outline.pitch_angle)
    back = Rigid(rotation_about(np.array([0.0, 0.0, -teeth * outline.pitch_angle])), np.zeros(3))
    rest = back.after(rest)
    middle = np.array([[0.0, 0.0, 0.5 * b]])
    r = rest.rotation
    turn = 0.5 * (r[1, 0] - r[0, 1])
    tilt = 0.5 * math.hypot(r[2, 1] - r[1, 2], r[0, 2] - r[2, 0])
    return PoseError(rest.angle, turn, tilt, (rest.apply(middle) - middle)[0], teeth % outline.teeth, flipped)

"""The screw that carries a gear's section along its face: the one place where a helix angle turns points.

The section at height z is that at mid-face, turned by κ (z − b/2) with κ = tan β / r = 2π / lead (ISO 21771: the same at every radius).
So half a turn about x maps a gear of either hand on itself, and so do both halves of a pair.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.design.gear import Gear


def turn_at(gear: Gear, z: Floats) -> Floats:
    """Angle (rad) by which the sections at heights `z` (mm) are turned against the one at mid-face."""
    return np.asarray(gear.twist * (z - 0.5 * gear.face_width), dtype=np.float64)


def section_angle(gear: Gear, x: Floats, y: Floats, z: Floats) -> Floats:
    """Polar angle (rad) of points in the mid-face section, each turned back along the screw from its own height."""
    angle: Floats = np.arctan2(y, x)
    return angle if gear.twist == 0.0 else angle - turn_at(gear, z)


def untwisted(gear: Gear, points: Floats) -> Floats:
    """Points (n, 3) in the design frame, mm, each turned back by its own height: on a spur gear they stay."""
    return points if gear.twist == 0.0 else _turned(points, -turn_at(gear, points[:, 2]))


def twisted(gear: Gear, points: Floats) -> Floats:
    """The way back from `untwisted`."""
    return points if gear.twist == 0.0 else _turned(points, turn_at(gear, points[:, 2]))


def _turned(points: Floats, angle: Floats) -> Floats:
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = points[:, 0], points[:, 1]
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, points[:, 2]])


def normal_lean(gear: Gear, lever: Floats) -> tuple[Floats, Floats]:
    """Cosine and sine of the angle γ by which a surface's normal leans out of the transverse plane.

    Parameters
    ----------
    gear : Gear
    lever : (n,) float
        Moment of the transverse unit normal about the axis on the left of a tooth, mm: r_b on flanks, 0 on lands.

    Returns
    -------
    tuple of (n,) float
        The normal is (n_t cos γ, −s sin γ) on side s; a distance in the section is worth cos γ of itself in space.

    Notes
    -----
    The screw carries the surface into itself, so n_z = −κ (r × n)_z: tan γ = κ · lever. On a flank γ is β_b.
    """
    tangent = gear.twist * lever
    cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
    return cosine, tangent * cosine


def spur_only(gear: Gear, what: str) -> None:
    """Refuse a helical gear where a room cannot do it: never the answer of a spur gear in its place.

    Parameters
    ----------
    gear : Gear
    what : str
        What cannot be done, as the subject of a sentence.

    Raises
    ------
    InputError
        If the gear is helical.
    """
    if gear.twist != 0.0:
        angle = math.degrees(gear.spec.helix_angle)
        raise InputError(
            f"[{gear.spec.name}] helix_angle = {angle:g}: {what} of helical gears is out of scope for now; "
            "only spur gears (helix_angle = 0)"
        )

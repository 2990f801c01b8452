"""The screw that carries a gear's section along its face: the one place where a helix angle turns points.

The section at height z is that at mid-face, turned by κ (z − b/2) with κ = tan β / r = 2π / lead (ISO 21771: the same at every radius).
So half a turn about x maps a gear of either hand on itself, and so do both halves of a pair. A double helical gear is two such
segments of the face, the upper one with the other hand; each is as drawn at its own middle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.design.gear import Gear


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of the face with one screw: from `low` to `high` (mm), `twist` κ in rad/mm, + right hand."""

    low: float
    high: float
    twist: float

    @property
    def middle(self) -> float:
        """Height at which the section has a tooth centre on +x, mm."""
        return 0.5 * (self.low + self.high)


def segments(gear: Gear) -> tuple[Segment, ...]:
    """The whole face; of a double helical gear its two halves, from z = 0."""
    width, gap = gear.face_width, gear.spec.gap
    if gap == 0.0:
        return (Segment(0.0, width, gear.twist),)
    return Segment(0.0, 0.5 * (width - gap), gear.twist), Segment(0.5 * (width + gap), width, -gear.twist)


def turn_at(gear: Gear, z: Floats) -> Floats:
    """Angle (rad) by which the sections at heights `z` (mm) are turned against the one at mid-face, or at the middle of their half."""
    if gear.spec.gap == 0.0:
        return np.asarray(gear.twist * (z - 0.5 * gear.face_width), dtype=np.float64)
    low, high = segments(gear)
    upper = np.asarray(z) > 0.5 * gear.face_width
    return np.where(upper, high.twist * (z - high.middle), low.twist * (z - low.middle))


def hand_at(gear: Gear, z: Floats) -> Floats | float:
    """Sign (±1) of the helix at heights `z` (mm) against that of `gear.twist`: −1 on the upper half of a double helical gear."""
    return 1.0 if gear.spec.gap == 0.0 else np.where(np.asarray(z) > 0.5 * gear.face_width, -1.0, 1.0)


def has_screw(gear: Gear) -> bool:
    """Whether a screw carries the whole toothing into itself, so that height and turn go together: helical, and of one helix."""
    return gear.twist != 0.0 and gear.spec.gap == 0.0


def drawn_height(gear: Gear) -> float:
    """Height, mm, of a section as drawn, with a tooth centre on +x: mid-face, or the middle of the lower half."""
    return segments(gear)[0].middle


def from_end(gear: Gear, z: Floats) -> Floats:
    """Distance (mm) of heights `z` from the nearest end of the face, or of a half of it; negative beyond, and in a groove."""
    width = gear.face_width
    if gear.spec.gap == 0.0:
        return np.asarray(np.minimum(z, width - z))
    low, high = segments(gear)
    return np.where(np.asarray(z) > 0.5 * width, np.minimum(z - high.low, width - z), np.minimum(z, low.high - z))


def helix_coordinate(gear: Gear, z: Floats) -> Floats:
    """ζ = (z − middle) / width of the helix that heights `z` (mm) lie on: from −½ to ½ over the face, or over each half."""
    if gear.spec.gap == 0.0:
        return np.asarray(z / gear.face_width - 0.5)
    low, high = segments(gear)
    return np.where(np.asarray(z) > 0.5 * gear.face_width, z - high.middle, z - low.middle) / (low.high - low.low)


def section_angle(gear: Gear, x: Floats, y: Floats, z: Floats) -> Floats:
    """Polar angle (rad) of points in the mid-face section, each turned back along the screw from its own height."""
    angle: Floats = np.arctan2(y, x)
    return angle if gear.twist == 0.0 else angle - turn_at(gear, z)


def wrapped_angle(angle: Floats) -> Floats:
    """Angles, rad, within −π … π."""
    return np.asarray(np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi, dtype=np.float64)


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


def helix_words(gear: Gear) -> str:
    """Hand and angle as a clause behind a tooth count, "" for a spur gear."""
    if gear.twist == 0.0:
        return ""
    return f", {gear.spec.hand} hand of {abs(math.degrees(gear.helix_angle)):g}°"


class Toothing(StrEnum):
    """What a room may not be able to do."""

    HELICAL = "helical"
    DOUBLE_HELICAL = "double helical"
    INTERNAL = "internal"


def refuse(gear: Gear, task: str, *kinds: Toothing) -> None:
    """Refuse a gear of some kinds where a room cannot do it: never the answer of another one in its place.

    Parameters
    ----------
    gear : Gear
    task : str
        What cannot be done, as the subject of a sentence.
    kinds : Toothing
        Of gears that it cannot be done for.

    Raises
    ------
    InputError
        If the gear is of one of them.
    """
    spec = gear.spec
    words = {
        Toothing.HELICAL: (
            gear.twist != 0.0,
            f"helix_angle = {math.degrees(spec.helix_angle):g}",
            "spur gears (helix_angle = 0)",
        ),
        Toothing.DOUBLE_HELICAL: (spec.gap > 0.0, f"gap = {spec.gap:g} mm", "gears of one helix (gap = 0)"),
        Toothing.INTERNAL: (spec.internal, "internal = true", "external gears (internal = false)"),
    }
    for kind in kinds:
        so, value, right = words[kind]
        if so:
            raise InputError(f"[{spec.name}] {value}: {task} of {kind} gears is out of scope for now; only {right}")


def normal_loss(gear: Gear, arc: float) -> float:
    """What both flanks of a tooth together have lost along their normals, mm, that is thinner by a normal `arc` (mm) at the reference circle: ``arc r_b / r · cos β_b / cos β``."""
    per_arc = gear.base_helix_cosine / math.cos(gear.helix_angle)
    return arc * gear.base_radius / gear.reference_radius * per_arc

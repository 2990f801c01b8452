"""Heights at which two gears are looked at in contact.

The axes are parallel, so every transverse slice is an exact problem in the plane; a slice of a helical gear is that of mid-face at
another angle of rotation (`design.twist.turn_at`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles

STEPS_PER_PITCH = 32
"""Slices while the helix gets ahead by one pitch, at least: what a profile 20 µm off does is then within 0.1 µm of that with any number."""

SAME_HEIGHT = 1e-6
"""Share of the face width; rows closer than this are one."""


@dataclass(frozen=True, slots=True)
class Slices:
    """Heights common to both gears; mm from mid-face, which they share.

    Parameters
    ----------
    height : (n,) float or None
        Rising. None: those the driver's profiles have, as with spur gears, where a slice stands for its surroundings.
    """

    height: Floats | None

    @classmethod
    def of(cls, driver: ToothProfiles, driven: ToothProfiles) -> Slices:
        """Slices of a pair.

        On helical gears the ends of the common face are in, because there contact begins and ends; so is every row in which a flank
        differs from the next, and as many between as let the contact move on in small steps.
        """
        gear = driver.gear
        if gear.twist == 0.0:
            return cls(None)
        rows = np.concatenate([_rows(profiles) for profiles in (driver, driven)])
        step = gear.pitch_angle / abs(gear.twist) / STEPS_PER_PITCH
        return cls(np.concatenate([_filled(*ends, rows, step) for ends in common_face(gear, driven.gear)]))

    def cut(self, driver: ToothProfiles, driven: ToothProfiles) -> tuple[ToothProfiles, ToothProfiles]:
        """Both gears in these slices, z that of the driver; the same profiles where there is nothing to cut."""
        if self.height is None:
            return driver, replace(driven, z=driver.z, half_angle=driven.at_heights(driver.z))
        middle = 0.5 * driver.gear.face_width
        z = self.height + middle
        mate = driven.at_heights(self.height + 0.5 * driven.gear.face_width)
        return replace(driver, z=z, half_angle=driver.at_heights(z)), replace(driven, z=z, half_angle=mate)


class FaceParts(NamedTuple):
    """The common face in parts of equal width.

    Middles in the frames of driver and driven gear, and widths, mm; place over the common face, from −½ to ½; and half of a double helical gear,
    0 or 1; each (n,).
    """

    z: Floats
    mate_z: Floats
    widths: Floats
    place: Floats
    half: Ints

    @classmethod
    def of(cls, gear: Gear, mate: Gear, count: int) -> FaceParts:
        """`count` parts, as many of each half of a double helical gear; the faces of spur gears both begin at z = 0."""
        width = min(gear.face_width, mate.face_width)
        ends = [(0.0, width)] if gear.twist == 0.0 else common_face(gear, mate)
        edges = [np.linspace(low, high, count + 1) for low, high in ends]
        middle = np.concatenate([0.5 * (part[1:] + part[:-1]) for part in edges])
        widths, half = np.concatenate([np.diff(part) for part in edges]), np.repeat(np.arange(len(ends)), count)
        if gear.twist == 0.0:
            return cls(middle, middle, widths, middle / width - 0.5, half)
        return cls(middle + 0.5 * gear.face_width, middle + 0.5 * mate.face_width, widths, middle / width, half)


def common_face(gear: Gear, mate: Gear) -> list[tuple[float, float]]:
    """Ends of the face that both gears have, of both halves where they are double helical; mm from mid-face."""
    outer = 0.5 * min(gear.face_width, mate.face_width)
    inner = 0.5 * max(gear.spec.gap, mate.spec.gap)
    return [(-outer, outer)] if inner == 0.0 else [(-outer, -inner), (inner, outer)]


def common_width(gear: Gear, mate: Gear) -> float:
    """Width of the face that both gears have, mm, without the groove of double helical ones."""
    return sum(high - low for low, high in common_face(gear, mate))


def _filled(low: float, high: float, rows: Floats, step: float) -> Floats:
    """From `low` to `high` with the rows between, and so many more that none is further than `step` from the next, mm."""
    near = SAME_HEIGHT * (high - low)
    inside = np.unique(rows[(rows > low + near) & (rows < high - near)])
    inside = inside[np.append(True, np.diff(inside) > near)] if len(inside) else inside
    known = np.concatenate([[low], inside, [high]])
    parts = [np.linspace(start, stop, max(1, math.ceil((stop - start) / step)) + 1)[:-1] for start, stop in pairwise(known)]
    return np.concatenate([*parts, [high]])


def _rows(profiles: ToothProfiles) -> Floats:
    """Heights from mid-face, mm, of the rows of a gear; none where all are alike."""
    psi = profiles.half_angle
    if len(profiles.z) == 1 or (psi == psi[:, :, :1]).all():
        return np.empty(0)
    return np.asarray(profiles.z - 0.5 * profiles.gear.face_width, dtype=np.float64)

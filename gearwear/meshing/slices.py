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
from gearwear.design.profiles import ToothProfiles, section_heights

STEPS_PER_PITCH = 32
"""Slices while the helix gets ahead by one pitch, at least: what a profile 20 µm off does is then within 0.1 µm of that with any number."""

SAME_HEIGHT = 1e-6
"""Share of the face width; rows closer than this are one."""


@dataclass(frozen=True, slots=True)
class Slices:
    """Heights at which both gears are looked at, mid-faces at one height.

    Parameters
    ----------
    z, mate_z : (n,) float
        mm, rising, each in its own gear's frame: of the driver, and of the driven gear.
    """

    z: Floats
    mate_z: Floats

    @classmethod
    def of(cls, driver: ToothProfiles, driven: ToothProfiles) -> Slices:
        """Slices of a pair, on the face that both gears have.

        On spur gears they are the driver's rows, each of which stands for its surroundings; the ends of the common face are in where the
        driver is wider. On helical gears these ends are in, because there contact begins and ends; so is every row in which a flank
        differs from the next, and as many between as let the contact move on in small steps.
        """
        gear, mate = driver.gear, driven.gear
        ends = common_face(gear, mate)
        middle = 0.5 * gear.face_width
        if gear.twist == 0.0:
            z = np.unique(np.clip(driver.z, middle + ends[0][0], middle + ends[-1][1]))
            return cls(z, beside(z, gear, mate))
        rows = np.concatenate([_rows(profiles) for profiles in (driver, driven)])
        step = gear.pitch_angle / abs(gear.twist) / STEPS_PER_PITCH
        height = np.concatenate([_filled(*end, rows, step) for end in ends])
        return cls(height + middle, height + 0.5 * mate.face_width)

    def cut(self, driver: ToothProfiles, driven: ToothProfiles) -> tuple[ToothProfiles, ToothProfiles]:
        """Both gears in these slices."""
        return (
            replace(driver, z=self.z, half_angle=driver.at_heights(self.z)),
            replace(driven, z=self.mate_z, half_angle=driven.at_heights(self.mate_z)),
        )


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
        """`count` parts, as many of each half of a double helical gear."""
        ends, width = common_face(gear, mate), min(gear.face_width, mate.face_width)
        edges = [np.linspace(0.0, high - low, count + 1) for low, high in ends]  # from the lower end of each
        middle = np.concatenate([0.5 * (part[1:] + part[:-1]) for part in edges])
        low = np.repeat([low for low, _ in ends], count)
        return cls(
            z=middle + (low + 0.5 * gear.face_width),
            mate_z=middle + (low + 0.5 * mate.face_width),
            widths=np.concatenate([np.diff(part) for part in edges]),
            place=middle / width + low / width,
            half=np.repeat(np.arange(len(ends)), count),
        )


def beside(z: Floats, gear: Gear, mate: Gear) -> Floats:
    """Heights in the frame of a gear, mm, in that of its mate: mid-faces are at one height."""
    return z + 0.5 * (mate.face_width - gear.face_width)


def on_face_of(mate: Gear, z: Floats, gear: Gear) -> Floats:
    """Heights on the face of a gear, mm, as heights on that of its mate, rising; its end stands for what lies beyond it."""
    return np.unique(np.clip(beside(z, gear, mate), 0.0, mate.face_width))


def heights_beside(mate: Gear, z: Floats, gear: Gear) -> Floats:
    """Heights, mm, of sections of a mate as drawn that show what it has modified along its face, and the rows `z` of a gear beside it."""
    if not mate.modified_along_face:
        return on_face_of(mate, z, gear)
    return np.union1d(on_face_of(mate, np.append(z, (0.0, gear.face_width)), gear), section_heights(mate))


def facing_mate(profiles: ToothProfiles, mate: Gear) -> ToothProfiles:
    """A measured gear by the rows that lie on the face it shares with its mate alone; as it is where none does, or all do.

    A row stands for half the way to the next. What one beside the edge of the common face says is half of an overhang that no mate wears.
    """
    z, middle, ends = profiles.z, 0.5 * profiles.gear.face_width, common_face(profiles.gear, mate)
    near = SAME_HEIGHT * profiles.gear.face_width
    between = 0.5 * (z[1:] + z[:-1])
    low, high = np.append(z[0], between), np.append(between, z[-1])
    alone = (low > middle + ends[0][0] - near) & (high < middle + ends[-1][1] + near)
    if alone.all() or not alone.any():
        return profiles
    return replace(profiles, z=z[alone], half_angle=profiles.half_angle[:, :, alone])


def common_face(gear: Gear, mate: Gear) -> list[tuple[float, float]]:
    """Ends of the face that both gears have, of both halves where they are double helical; mm from mid-face."""
    outer = 0.5 * min(gear.face_width, mate.face_width)
    inner = 0.5 * max(gear.spec.gap, mate.spec.gap)
    return [(-outer, outer)] if inner == 0.0 else [(-outer, -inner), (inner, outer)]


def uneven_across_face(gear: Gear, mate: Gear) -> bool:
    """Whether a pair as drawn touches otherwise at one height than at another: by a helix, or flanks modified along the face."""
    return gear.twist != 0.0 or gear.modified_along_face or mate.modified_along_face


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

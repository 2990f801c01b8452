"""Lengths of a gear seen along its axis: tip and bottom lands, face width, groove, bore and rim."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.errors import InputError
from gearwear.identify.free_involute import FreeInvolute
from gearwear.identify.plane import Plane
from gearwear.robust import median_scale


def lands(radius: Floats, turns: Floats, flank: FreeInvolute, plane: Plane) -> tuple[float, float, float]:
    """Radii of the tip and bottom lands, and the bottom's robust scatter, mm, from the points near the middle of teeth and spaces.

    `turns` are pitches from the tooth's middle; where no bottom was seen its radius is where the flanks end, and its scatter nan.
    """
    tip, root, teeth = plane.circle.radius, plane.root, plane.count.teeth
    for _ in range(3):
        # Half of the land is surely land; of pointed teeth a little more than nothing.
        half = 0.25 * flank.thickness(tip) / tip * teeth / (2.0 * math.pi)
        of_land = radius[(np.abs(turns) < max(half, 0.01)) & (radius > 0.5 * (root + tip)) & (radius < 1.05 * tip)]
        if len(of_land) < 20:
            break
        tip = float(np.median(of_land))
    reach = 0.15 * (tip - root)
    of_land = radius[(np.abs(turns) > 0.47) & (radius > root - reach) & (radius < root + reach)]
    return (tip, *median_scale(of_land)) if len(of_land) >= 20 else (tip, root, math.nan)


OUTERMOST = 0.002
"""Share of the points of the teeth that may lie beyond either end: strays."""
LEVEL = 0.1
"""Share of the height round an end that is searched within which the points of an end face scatter."""


@dataclass(frozen=True, slots=True)
class FaceEnds:
    """Heights between which teeth were seen, mm, and whether an end face says so at the lower and at the upper end."""

    low: float
    high: float
    low_seen: bool
    high_seen: bool

    @property
    def width(self) -> float:
        return self.high - self.low

    @property
    def low_edge(self) -> float:
        """The lower end; where no face says so as far down as evenly spread points let it be expected."""
        return self.low if self.low_seen else self.low - OUTERMOST * self.width

    @property
    def high_edge(self) -> float:
        """As `low_edge`, the upper end."""
        return self.high if self.high_seen else self.high + OUTERMOST * self.width


def face_ends(parts: Sequence[Plane], inside: float) -> FaceEnds:
    """The ends of the teeth.

    Parameters
    ----------
    parts : sequence of Plane
        One, or two halves to be taken together.
    inside : float
        Radius below which sides are no teeth's, mm.

    Raises
    ------
    InputError
        If no tooth sides are in the scan.
    """
    plane = parts[0]
    points, sides, faces = (np.concatenate([getattr(part, name) for part in parts]) for name in ("points", "sides", "faces"))
    height = points[:, 2]
    radius, _ = plane.circle.polar(points[:, :2])
    toothed = (radius > inside) & (radius < 1.01 * plane.circle.radius)
    shown = height[toothed & sides]
    if not len(shown):
        raise InputError("the teeth that were counted show no side, only end faces: a scan of the flanks is needed")
    low, high = np.quantile(shown, [OUTERMOST, 1.0 - OUTERMOST])
    ends = []
    for end in (low, high):
        near = 0.05 * (high - low)
        at = (radius < 1.01 * plane.circle.radius) & faces & (np.abs(height - end) < near)
        # A face holds many points at one height; a chamfer or normals gone wrong at edges do not.
        face, scatter = median_scale(height[at]) if at.sum() >= 40 else (math.nan, math.nan)
        ends.append(face if scatter < LEVEL * near else None)
    lower, upper = (float(value if end is None else end) for end, value in zip(ends, (low, high), strict=True))
    return FaceEnds(lower, upper, ends[0] is not None, ends[1] is not None)


def bore_diameter(plane: Plane) -> float:
    """Diameter of the innermost cylinder about the axis that nothing lies inside of, mm; 0 where there is none."""
    radius, _ = plane.circle.polar(plane.points[:, :2])
    inner = plane.sides & (radius < 0.97 * plane.root)
    if inner.sum() < 60:
        return 0.0
    least = float(np.quantile(radius[inner], 0.02))
    wall = inner & (np.abs(radius - least) < 0.03 * least)
    return 0.0 if (radius < 0.9 * least).sum() > 0.05 * wall.sum() else _cylinder(plane, wall)


def rim_diameter(plane: Plane) -> float:
    """Diameter of the outermost cylinder about the axis of a ring that nothing lies outside of, mm; 0 where there is none.

    A ring's outside has points all round; a housing, a flange or a table beside it have not.
    """
    radius, _ = plane.circle.polar(plane.points[:, :2])
    outer = plane.sides & (radius > 1.02 * plane.circle.radius)
    if outer.sum() < 60:
        return 0.0
    most = float(np.quantile(radius[outer], 0.98))
    wall = outer & (np.abs(radius - most) < 0.02 * most)
    return 0.0 if (radius > 1.05 * most).sum() > 0.05 * wall.sum() else _cylinder(plane, wall)


def _cylinder(plane: Plane, wall: Bools) -> float:
    """Diameter of the cylinder that some points lie on; 0 where they do not go round the axis."""
    radius, angle = plane.circle.polar(plane.points[wall, :2])
    if np.unique(np.floor(angle * (18.0 / math.pi))).size < 24:
        return 0.0
    return 2.0 * float(np.median(radius))

"""A scan seen along a candidate axis: which points are sides of teeth, between which radii, and how many teeth there are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.identify.free_involute import FreeInvolute, fit_involute
from gearwear.identify.ring import TipCircle, ToothCount, count_teeth, innermost, tip_circle
from gearwear.placing.coarse import Sample, frame
from gearwear.placing.screw import LEAST_ANGLE

LEAST_SHARE = 0.04
"""Share of the pattern that must repeat for teeth to be counted."""


@dataclass(frozen=True)
class Plane:
    """A scan seen along a candidate axis; teeth that turn with the height by `twist`, rad/mm."""

    turn: Floats
    points: Floats
    normals: Floats
    sides: Bools
    faces: Bools
    circle: TipCircle
    root: float
    count: ToothCount
    twist: float = 0.0

    @property
    def flat(self) -> tuple[Floats, Floats]:
        """Tooth sides in the plane of rotation, (n, 2) mm, and their heights (n,) from the middle, mm."""
        return self.points[self.sides, :2], self.points[self.sides, 2] - self.middle

    @property
    def toothing(self) -> tuple[Floats, Floats, float, float]:
        """Points about the axis and their normals, (n, 3), and between which radii the teeth lie, mm."""
        return self.points - np.array([*self.circle.centre, 0.0]), self.normals, self.circle.radius, self.root

    @property
    def middle(self) -> float:
        """Height from which the twist is counted, mm."""
        return float(np.median(self.points[self.sides, 2]))

    @cached_property
    def flank(self) -> FreeInvolute | None:
        """The involute through the tooth sides; fitted once, as every stage of a survey asks for it."""
        return self.fit(*self.flat)

    def fit(self, flat: Floats, height: Floats | None) -> FreeInvolute | None:
        """The involute through tooth sides (n, 2) seen in the plane, at heights (n,) or, of a planar section, at none; mm."""
        count = self.count
        return fit_involute(
            flat, height, self.circle.centre, count.teeth, count.phase, self.root, self.circle.radius, self.twist or None
        )


def along_axis(sample: Sample, axis: Floats, twist: float = 0.0, known: int | None = None) -> list[Plane]:
    """A scan seen along an axis, in none or one plane; further parameters as `plane_of`."""
    turn = frame(axis)
    return plane_of(turn, sample.points @ turn.T, sample.normals @ turn.T, twist, known)


def plane_of(turn: Floats, points: Floats, normals: Floats, twist: float = 0.0, known: int | None = None) -> list[Plane]:
    """The points along an axis, in none or one plane.

    Parameters
    ----------
    turn : (3, 3) float
        Rotation from the scan's own frame.
    points, normals : (n, 3) float
        Turned by it, mm.
    twist : float
        Of the teeth, rad/mm; one that is none of a helical gear is left out.
    known : int or None
        The tooth count, where it is known.
    """
    cosine = np.abs(normals[:, 2])
    sides = cosine < 0.25
    if sides.sum() < 200:
        return []
    circle = tip_circle(points[sides, :2])
    if circle is None:
        return []
    slope = abs(twist) * circle.radius
    if slope < 0.5 * math.tan(LEAST_ANGLE):
        twist = 0.0
    else:
        sides = cosine < max(0.25, min(0.85, math.sin(math.atan(slope)) + 0.15))
        circle = tip_circle(points[sides, :2])
        if circle is None:
            return []
    height = points[sides, 2]
    counted = count_flat(points[sides, :2], twist * (height - float(np.median(height))), circle, known)
    if counted is None:
        return []
    circle, root, count = counted
    faces = cosine > 0.9
    return [
        Plane(
            turn=turn,
            points=points,
            normals=normals,
            sides=sides,
            faces=faces,
            circle=circle,
            root=root,
            count=count,
            twist=twist,
        )
    ]


def count_flat(
    flat: Floats, turn: Floats, circle: TipCircle, known: int | None = None
) -> tuple[TipCircle, float, ToothCount] | None:
    """Circle, where the teeth end inwards, and their number, of points (n, 2) after each is turned back by `turn`, rad.

    Where a rim lies round the teeth of a ring it is the outermost circle; what is inside of the first empty ring is tried too.
    """
    counted = _count_within(flat, turn, circle, known)
    if counted is not None and counted[2].share >= LEAST_SHARE:
        return counted
    inner = innermost(circle.polar(flat)[0], circle.radius)
    within = circle.polar(flat)[0] < 0.999 * inner
    if within.sum() >= 200:
        smaller = tip_circle(flat[within])
        within_teeth = None if smaller is None else _count_within(flat[within], turn[within], smaller, known)
        if within_teeth is not None and (counted is None or within_teeth[2].share > counted[2].share):
            return within_teeth
    return counted


def _count_within(flat: Floats, turn: Floats, circle: TipCircle, known: int | None) -> tuple[TipCircle, float, ToothCount] | None:
    radius, angle = circle.polar(flat)
    inner = innermost(radius, circle.radius)
    of_teeth = radius[(radius >= inner) & (radius < 1.02 * circle.radius)]
    if len(of_teeth) < 200:
        return None
    root = float(np.quantile(of_teeth, 0.003))
    if not 0.2 * circle.radius < root < 0.995 * circle.radius:
        return None
    count = count_teeth(radius, angle, root, circle.radius, turn, known)
    return None if count is None else (circle, root, count)

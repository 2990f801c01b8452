"""Effects of the instrument as motions of points, and weights of density and coverage; design frame, mm and rad."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.families.gear import Array
from benchmarks.families.part import Part
from benchmarks.families.sampling import END, Points


@dataclass(frozen=True)
class Coat:
    """Every surface out by `thickness`."""

    thickness: float

    def __call__(self, part: Part, xyz: Array, normal: Array) -> Array:
        return xyz + self.thickness * normal


@dataclass(frozen=True)
class Stretch:
    """Scale by (1 + plane) across the axis, (1 + axial) along it, and by (1 + more) along one direction across."""

    plane: float = 0.0
    axial: float = 0.0
    more: float = 0.0
    direction: float = 0.0

    def __call__(self, part: Part, xyz: Array, normal: Array) -> Array:
        way = np.array([math.cos(self.direction), math.sin(self.direction), 0.0])
        moved = xyz * np.array([1.0 + self.plane, 1.0 + self.plane, 1.0 + self.axial])
        stretched: Array = moved + self.more * (xyz @ way)[:, None] * way
        return stretched


@dataclass(frozen=True)
class Turntable:
    """θ measured = θ + a cos(n θ + φ)."""

    order: float
    amplitude: float
    phase: float

    def __call__(self, part: Part, xyz: Array, normal: Array) -> Array:
        theta = np.arctan2(xyz[:, 1], xyz[:, 0])
        return _turned(xyz, self.amplitude * np.cos(self.order * theta + self.phase))


@dataclass(frozen=True)
class Drift:
    """θ measured = θ + closure · (share of the revolution since the start − ½)."""

    closure: float
    start: float

    def __call__(self, part: Part, xyz: Array, normal: Array) -> Array:
        theta = np.arctan2(xyz[:, 1], xyz[:, 0])
        return _turned(xyz, self.closure * (np.mod(theta - self.start, 2.0 * math.pi) / (2.0 * math.pi) - 0.5))


@dataclass(frozen=True)
class RadialOffset:
    """Every radius greater by `offset`."""

    offset: float

    def __call__(self, part: Part, xyz: Array, normal: Array) -> Array:
        rho = np.hypot(xyz[:, 0], xyz[:, 1])[:, None]
        way = np.column_stack([xyz[:, :2] / rho, np.zeros(len(xyz))])
        return xyz + self.offset * way


def _turned(xyz: Array, angle: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * xyz[:, 0] - s * xyz[:, 1], s * xyz[:, 0] + c * xyz[:, 1], xyz[:, 2]])


# Density and coverage -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class RoundGear:
    """Density falls round the gear from 1 to 1/`ratio` at the direction opposite to `towards`: gradually or at once (`step`)."""

    ratio: float
    towards: float
    step: bool = False

    def __call__(self, part: Part, points: Points) -> Array:
        c = np.cos(np.arctan2(points.xyz[:, 1], points.xyz[:, 0]) - self.towards)
        return self.ratio ** (-(c < 0.0).astype(float) if self.step else 0.5 * (c - 1.0))


@dataclass(frozen=True)
class AlongAxis:
    """Density falls from one end to the other by `ratio`."""

    ratio: float
    up: bool = True

    def __call__(self, part: Part, points: Points) -> Array:
        share = np.clip(points.xyz[:, 2] / part.gear.face_width, 0.0, 1.0)
        return self.ratio ** -(share if self.up else 1.0 - share)


@dataclass(frozen=True)
class Sector:
    """Only teeth from `first`, `number` of them, with what is between them."""

    first: int
    number: int

    def __call__(self, part: Part, points: Points) -> Array:
        theta = np.mod(np.arctan2(points.xyz[:, 1], points.xyz[:, 0]) / part.gear.pitch_angle - self.first + 0.5, part.gear.teeth)
        return (theta < self.number).astype(float)


@dataclass(frozen=True)
class OneSide:
    """Flanks (and root halves) of one side only."""

    side: int

    def __call__(self, part: Part, points: Points) -> Array:
        return np.where(points.side != -self.side, 1.0, 0.0)


@dataclass(frozen=True)
class Outer:
    """Only what lies outside a radius."""

    radius: float

    def __call__(self, part: Part, points: Points) -> Array:
        return (np.hypot(points.xyz[:, 0], points.xyz[:, 1]) > self.radius).astype(float)


@dataclass(frozen=True)
class Between:
    """Only what lies between two heights."""

    low: float
    high: float

    def __call__(self, part: Part, points: Points) -> Array:
        return np.where((points.xyz[:, 2] > self.low) & (points.xyz[:, 2] < self.high) & (points.kind != END), 1.0, 0.0)


@dataclass(frozen=True)
class Unseen:
    """Nothing of one tooth."""

    tooth: int

    def __call__(self, part: Part, points: Points) -> Array:
        rho = np.hypot(points.xyz[:, 0], points.xyz[:, 1])
        return np.where((points.tooth == self.tooth) & (rho > part.section.root_radius[0]), 0.0, 1.0)

"""The involute tooth that the generators of helical gears and of rings share, from drawing data alone, and how a scan of one lies.

Nothing of the package is used. Lengths in mm, angles in degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Patch:
    """Wear of a flank: depth along the normal at feet (L, z), a smooth hill of this height and these limits; tooth from 0, side ±1."""

    tooth: int
    side: int
    depth: float
    roll: tuple[float, float]
    z: tuple[float, float]

    def at(self, roll: Floats, z: Floats) -> Floats:
        u, v = ((x - low) / (high - low) for x, (low, high) in ((roll, self.roll), (z, self.z)))
        inside = (u > 0) & (u < 1) & (v > 0) & (v < 1)
        return np.where(inside, self.depth * np.sin(np.pi * np.clip(u, 0, 1)) ** 2 * np.sin(np.pi * np.clip(v, 0, 1)) ** 2, 0.0)


@dataclass(frozen=True)
class Tooth:
    """Angles in degrees, + a right hand; `shift`, `addendum` and `dedendum` in normal modules; a shift of + makes the tooth thicker."""

    outwards: ClassVar[int] = 1
    """Which way the tooth points from its root: −1 on a ring, whose tooth is what an external gear's space is."""
    teeth: int
    module: float
    helix: float
    width: float
    pressure: float
    shift: float
    addendum: float
    dedendum: float

    @property
    def cos(self) -> float:
        return math.cos(math.radians(self.helix))

    @property
    def reference(self) -> float:
        return 0.5 * self.teeth * self.module / self.cos

    @property
    def transverse(self) -> float:
        return math.atan(math.tan(math.radians(self.pressure)) / self.cos)

    @property
    def base(self) -> float:
        return self.reference * math.cos(self.transverse)

    @property
    def base_cos(self) -> float:
        """cos β_b."""
        return math.sqrt(1.0 - (math.sin(math.radians(self.helix)) * math.cos(math.radians(self.pressure))) ** 2)

    @property
    def tip(self) -> float:
        return self.reference + self.outwards * self.module * (self.addendum + self.shift)

    @property
    def root(self) -> float:
        return self.reference - self.outwards * self.module * (self.dedendum - self.shift)

    @property
    def turn(self) -> float:
        """Turn of the section per height, rad/mm."""
        return math.tan(math.radians(self.helix)) / self.reference

    def flank_half(self, roll: Floats) -> Floats:
        """Half angle of the tooth on its involute, at lengths of roll."""
        arc = (0.5 * math.pi + 2 * self.shift * math.tan(math.radians(self.pressure))) * self.module / self.cos
        half = arc / (2 * self.reference) + self.outwards * (math.tan(self.transverse) - self.transverse)
        return half - self.outwards * (roll / self.base - np.arctan(roll / self.base))

    def volume(self, patch: Patch) -> float:
        """Metal of a patch, mm³: ∫∫ (d L / (r_b cos β_b) ∓ d² / 2 r_b) dL dz over the feet of its normals; in a ring the metal widens outwards."""
        roll, z = (low + (high - low) * (np.arange(600) + 0.5) / 600 for low, high in (patch.roll, patch.z))
        d = patch.at(roll[:, None], z)
        cell = (patch.roll[1] - patch.roll[0]) * (patch.z[1] - patch.z[0]) / 600**2
        return float((d * roll[:, None] / (self.base * self.base_cos) - self.outwards * d**2 / (2 * self.base)).sum() * cell)


@dataclass(frozen=True)
class Cloud:
    """Points in the scan's own frame: scan = rotation · design + translation."""

    points: Floats
    rotation: Floats
    translation: Floats


def laid(points: Floats, noise: float, rng: np.random.Generator) -> Cloud:
    """Points of the design frame as a scan: every coordinate with noise of this standard deviation, tilted, turned and moved."""
    axis = np.array([0.02, -0.03, 1.0])
    turned = rotation(axis / np.linalg.norm(axis), 0.05)
    translation = np.array([1.3, -0.7, 2.1])
    return Cloud((points + rng.normal(0.0, noise, points.shape)) @ turned.T + translation, turned, translation)


def rotation(axis: Floats, angle: float) -> Floats:
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * skew @ skew

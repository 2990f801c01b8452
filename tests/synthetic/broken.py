"""What is broken off a tooth of a helical gear, a half of a double helical one or a ring: all of it beyond a plane; nothing of the package is used."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tests.synthetic.helical import Floats, Helical
from tests.synthetic.ring import Ring


@dataclass(frozen=True)
class Break:
    """Metal of tooth 0 beyond the plane through `point`, on its side of `normal`; where the flanks are involutes only.

    `low` and `turn` are those of the stretch of the face that the tooth lies on: its lower end, and its turn per height.
    """

    gear: Helical | Ring
    point: Floats
    normal: Floats
    low: float = 0.0
    hand: float = 1.0

    @property
    def middle(self) -> float:
        return self.low + 0.5 * self.gear.width

    @property
    def ends(self) -> tuple[float, float]:
        """Radii that the involute may lie between, the smaller first: from the base circle, of a ring from where its fillet begins."""
        if isinstance(self.gear, Ring):
            return self.gear.tip, math.hypot(self.gear.base, self.gear.touch[0])
        return max(self.gear.base, float(self.gear.fillet()[0][-1])), self.gear.tip

    def half(self, radius: Floats) -> Floats:
        """Half angle of a tooth."""
        return self.gear.flank_half(np.sqrt(np.maximum(radius**2 - self.gear.base**2, 0.0)))

    def place(self, points: Floats) -> tuple[Floats, Floats]:
        """Radius of points and their angle from the middle of tooth 0, each at its own height."""
        angle = np.arctan2(points[:, 1], points[:, 0]) - self.hand * self.gear.turn * (points[:, 2] - self.middle)
        return np.hypot(points[:, 0], points[:, 1]), np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi

    def inside(self, points: Floats) -> np.ndarray:
        """Whether points are metal of the tooth, on its involutes' part."""
        (radius, angle), (low, high) = self.place(points), self.ends
        off = np.abs(points[:, 2] - self.middle) < 0.5 * self.gear.width
        return (radius > low) & (radius < high) & off & (np.abs(angle) < self.half(np.clip(radius, low, high)))

    def of(self, points: Floats, noise: float, seed: int = 0, density: float = 20.0) -> Floats:
        """A scan without what is gone, with the plane of the fracture in it; `density` in points per mm²."""
        rng = np.random.default_rng(seed)
        radius, angle = self.place(points)
        low, high = self.ends
        own = (np.abs(angle) < math.pi / self.gear.teeth) & (radius > low - 0.5) & (radius < high + 0.5)
        own &= np.abs(points[:, 2] - self.middle) < 0.5 * self.gear.width + 0.5
        gone = own & ((points - self.point) @ self.normal > 0.0)
        across = np.linalg.svd(self.normal[None, :])[2][1:]
        reach = 1.5 * self.gear.width
        plane = self.point + rng.uniform(-reach, reach, (int(density * (2 * reach) ** 2), 2)) @ across
        plane = plane[self.inside(plane)]
        return np.vstack([points[~gone], plane + noise * rng.normal(size=plane.shape)])

    @property
    def volume(self) -> float:
        """mm³ beyond the plane: a fine sum over radius, angle and height."""
        low, high = self.ends
        n = 160
        middles = (np.arange(n) + 0.5) / n
        total = 0.0
        z = self.middle + (middles - 0.5) * self.gear.width
        for radius in low + (high - low) * middles:
            half = float(self.half(np.array([radius]))[0])
            angle = (2.0 * middles - 1.0)[:, None] * half + self.hand * self.gear.turn * (z - self.middle)
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            beyond = (
                (x - self.point[0]) * self.normal[0] + (y - self.point[1]) * self.normal[1] + (z - self.point[2]) * self.normal[2]
            )
            total += float((beyond > 0.0).mean()) * 2.0 * half * radius
        return total * (high - low) / n * self.gear.width

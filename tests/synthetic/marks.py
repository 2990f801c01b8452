"""A keyway cut into the bore of a scanned gear, or a cone punched into its end face: points taken away, and those of the mark put in their place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats


@dataclass(frozen=True, slots=True)
class Keyway:
    """Walls parallel to its middle plane, floor square to it.

    Parameters
    ----------
    angle : float
        Of the middle, rad.
    width, depth, bore : float
        Depth beyond the bore along the middle; diameter of the bore, mm.
    density : float
        Points per mm².
    seen : (float, float)
        Part of the width that the scanner saw, from −0.5 to 0.5; a wall is seen where its end is.
    """

    angle: float
    width: float = 6.0
    depth: float = 2.8
    bore: float = 30.0
    density: float = 3.0
    seen: tuple[float, float] = (-0.5, 0.5)

    def cut(self, points: Floats, face_width: float, noise: float, rng: np.random.Generator) -> Floats:
        """The points (n, 3) mm in the design frame with the keyway in place of what it took away, its own at the end."""
        along, across = self._frame(points)
        gone = (np.abs(across) < 0.5 * self.width) & (along > 0.0) & (along < 0.5 * self.bore + self.depth)
        new = self.points(face_width, rng)
        return np.concatenate([points[~gone], new + rng.normal(0.0, noise, new.shape)])

    def points(self, face_width: float, rng: np.random.Generator) -> Floats:
        """Of walls and floor, (n, 3) mm."""
        floor = 0.5 * self.bore + self.depth
        mouth = np.sqrt(0.25 * self.bore**2 - 0.25 * self.width**2)
        parts = []
        for end in (-0.5, 0.5):
            if self.seen[0] <= end <= self.seen[1]:
                n = rng.poisson(self.density * (floor - mouth) * face_width)
                parts.append(np.column_stack([rng.uniform(mouth, floor, n), np.full(n, end * self.width)]))
        low, high = (share * self.width for share in self.seen)
        n = rng.poisson(self.density * (high - low) * face_width)
        parts.append(np.column_stack([np.full(n, floor), rng.uniform(low, high, n)]))
        along, across = np.concatenate(parts).T
        cos, sin = np.cos(self.angle), np.sin(self.angle)
        z = rng.uniform(0.0, face_width, len(along))
        return np.column_stack([cos * along - sin * across, sin * along + cos * across, z])

    def _frame(self, points: Floats) -> tuple[Floats, Floats]:
        cos, sin = np.cos(self.angle), np.sin(self.angle)
        return cos * points[:, 0] + sin * points[:, 1], cos * points[:, 1] - sin * points[:, 0]


@dataclass(frozen=True, slots=True)
class Punch:
    """A cone in the upper end face.

    Parameters
    ----------
    angle : float
        Where it is, rad.
    radius, diameter, depth : float
        Off the axis, and its own, mm.
    density : float
        Points per mm² of the face.
    """

    angle: float
    radius: float = 24.0
    diameter: float = 3.0
    depth: float = 1.5
    density: float = 12.0

    def cut(self, points: Floats, face_width: float, noise: float, rng: np.random.Generator) -> Floats:
        """As `Keyway.cut`."""
        middle = self.radius * np.array([np.cos(self.angle), np.sin(self.angle)])
        gone = (np.hypot(*(points[:, :2] - middle).T) < 0.5 * self.diameter) & (points[:, 2] > face_width - 0.1)
        n = rng.poisson(self.density * 0.25 * np.pi * self.diameter**2)
        away, turn = 0.5 * self.diameter * np.sqrt(rng.uniform(0.0, 1.0, n)), rng.uniform(-np.pi, np.pi, n)
        place = middle + away[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        new = np.column_stack([place, face_width - self.depth * (1.0 - 2.0 * away / self.diameter)])
        return np.concatenate([points[~gone], new + rng.normal(0.0, noise, new.shape)])

"""What is broken off a tooth: a half space or a ball with a rough surface, in the design frame."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.families.gear import Array


@dataclass(frozen=True, eq=False)
class Cut:
    """Metal of one tooth beyond a plane (`radius` 0), or within a ball, is gone.

    Parameters
    ----------
    tooth : int
    kind : str
        What the verdict should call it: "missing tooth", "broken corner", "chipped edge".
    point : (3,) float
        A point of the plane, or the ball's centre.
    normal : (3,) float
        Into what is gone; without meaning for a ball.
    radius : float
        Of the ball, mm.
    rough : (n, 5) float
        Modes of the fracture's roughness: wave vector (1/mm), phase, amplitude (mm).
    """

    tooth: int
    kind: str
    point: Array
    normal: Array
    radius: float
    rough: Array

    def roughness(self, points: Array) -> Array:
        """Height of the fracture surface, mm."""
        wave = np.cos(points @ self.rough[:, :3].T + self.rough[:, 3])
        height: Array = wave @ self.rough[:, 4]
        return height

    def beyond(self, points: Array) -> Array:
        """Distance into what is gone, mm; negative in what is left."""
        if self.radius > 0.0:
            plain = self.radius - np.linalg.norm(points - self.point, axis=1)
        else:
            plain = (points - self.point) @ self.normal
        deep: Array = plain - self.roughness(points)
        return deep

    def surface(self, number: int, reach: float, rng: np.random.Generator) -> tuple[Array, Array]:
        """Points of the whole fracture surface, a plane's within `reach` of its point, and its normals, out of the metal."""
        if self.radius > 0.0:
            way = rng.standard_normal((number, 3))
            way /= -np.linalg.norm(way, axis=1)[:, None]
            foot = self.point - self.radius * way
        else:
            across = np.linalg.svd(self.normal[None, :])[2][1:]
            foot = self.point + rng.uniform(-reach, reach, (number, 2)) @ across
            way = np.broadcast_to(self.normal, (number, 3))
        height = np.zeros(number)
        for _ in range(12):
            height = self.roughness(foot + height[:, None] * way)
        points = foot + height[:, None] * way
        step = 1e-5
        slope = np.column_stack([self.beyond(points + step * axis) - self.beyond(points - step * axis) for axis in np.eye(3)])
        return points, slope / np.linalg.norm(slope, axis=1)[:, None]

    def size(self, reach: float) -> float:
        """Area that `surface` spreads its points over, mm²."""
        return 4.0 * math.pi * self.radius**2 if self.radius > 0.0 else (2.0 * reach) ** 2


def roughness(amplitude: float, length: float, rng: np.random.Generator, number: int = 12) -> Array:
    """Modes of a fracture surface: RMS `amplitude`, wavelengths about `length`, mm."""
    way = rng.standard_normal((number, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    wave = way * (2.0 * math.pi / (length * np.exp(rng.uniform(-0.5, 0.5, number))))[:, None]
    return np.column_stack([wave, rng.uniform(0.0, 2.0 * math.pi, number), np.full(number, amplitude * math.sqrt(2.0 / number))])

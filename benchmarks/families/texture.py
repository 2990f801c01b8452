"""Surface texture as a sum of plane waves in space with random directions, phases and lengths: no covariance is assumed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.families.gear import Array


@dataclass(frozen=True)
class Texture:
    """Several scales, each with its own height.

    Parameters
    ----------
    heights : tuple of float
        RMS of each scale, mm.
    lengths : tuple of float
        Its middle wavelength, mm; single waves lie within a factor of 1.6 of it.
    modes : int
        Waves in each scale.
    """

    heights: tuple[float, ...]
    lengths: tuple[float, ...]
    modes: int = 24

    @property
    def rms(self) -> float:
        return math.sqrt(sum(h * h for h in self.heights))

    def at(self, points: Array, seed: int) -> Array:
        """Heights at points of the part, mm; the same seed is the same surface."""
        rng = np.random.default_rng(seed)
        height = np.zeros(len(points))
        for rms, length in zip(self.heights, self.lengths, strict=True):
            way = rng.standard_normal((self.modes, 3))
            way /= np.linalg.norm(way, axis=1)[:, None]
            waves = 2.0 * math.pi / (length * np.exp(rng.uniform(-0.47, 0.47, self.modes)))
            phase = rng.uniform(0.0, 2.0 * math.pi, self.modes)
            height += rms * math.sqrt(2.0 / self.modes) * np.cos(points @ (way * waves[:, None]).T + phase).sum(axis=1)
        return height

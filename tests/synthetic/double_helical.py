"""Scans of double helical gears: two halves by the helical generator, the groove between them; nothing of the package is used."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from tests.synthetic.helical import Helical, scan
from tests.synthetic.tooth import Cloud, Floats, Patch, rotation


@dataclass(frozen=True)
class Double:
    """`lower` is the half at z = 0, as wide as a half; the upper one is its mirror image, `gap` mm further up."""

    lower: Helical = field(default_factory=lambda: Helical(teeth=17, helix=24.0, width=11.0))
    gap: float = 5.0

    @property
    def upper(self) -> Helical:
        return replace(self.lower, helix=-self.lower.helix)

    @property
    def width(self) -> float:
        return 2.0 * self.lower.width + self.gap

    @property
    def groove(self) -> float:
        """Radius of the groove."""
        return self.lower.root - 0.5 * self.lower.module


@dataclass(frozen=True)
class WornHalf:
    """Wear of a flank of one half, its heights from where that half begins."""

    upper: bool
    patch: Patch


def double_scan(
    gear: Double,
    count: int = 60_000,
    noise: float = 0.006,
    seed: int = 0,
    wear: tuple[WornHalf, ...] = (),
    added: Callable[[Floats, Floats, Floats], Floats] | None = None,
    coat: float = 0.0,
    shift: float = 0.0,
    turn: float = 0.0,
    faces: bool = True,
    upside_down: bool = False,
) -> Cloud:
    """A scan.

    Parameters
    ----------
    gear : Double
    count : int
        Points, about.
    noise : float
        Standard deviation of every coordinate, mm.
    wear : tuple of WornHalf
    added : callable or None
        On both halves, as of `helical.scan`; z from where a half begins.
    coat : float
        On every surface, along its normal, mm.
    shift : float
        How far the halves stand turned against each other, mm at the base circle of each, + where the upper is turned to the left.
    turn : float
        Amplitude, rad, of an angle that is read wrong twice a revolution.
    faces : bool
        Whether the end faces of the gear are in it.
    upside_down : bool
        How it lies on the table.
    """
    rng = np.random.default_rng(seed)
    parts = []
    for upper, half in ((False, gear.lower), (True, gear.upper)):
        own = tuple(one.patch for one in wear if one.upper is upper)
        cloud = scan(half, count // 2, noise=0.0, seed=2 * seed + upper, wear=own, added=added, coat=coat)
        points = (cloud.points - cloud.translation) @ cloud.rotation
        radius = np.hypot(points[:, 0], points[:, 1])
        inner = np.abs(points[:, 2] - (0.0 if upper else half.width)) < 1e-9 + 1.01 * coat
        flat = radius < half.root - 1e-9  # of the faces, which the generator draws below the root circle
        outer = np.abs(points[:, 2] - (half.width if upper else 0.0)) < 1e-9 + 1.01 * coat
        keep = np.where(flat & inner, radius > gear.groove, np.where(flat & outer, faces, True))
        points = points[keep]
        if upper:
            points[:, 2] += half.width + gear.gap
            angle = shift / half.base
            points[:, :2] = points[:, :2] @ np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        parts.append(points)
    n = int(count * gear.gap / gear.width / 4)
    angle, z = rng.uniform(0.0, 2.0 * math.pi, n), gear.lower.width + rng.uniform(0.0, gear.gap, n)
    parts.append(np.column_stack([(gear.groove + coat) * np.cos(angle), (gear.groove + coat) * np.sin(angle), z]))
    cloud = np.vstack(parts)
    if turn:
        theta = np.arctan2(cloud[:, 1], cloud[:, 0])
        theta += turn * np.cos(2.0 * theta + 0.4)
        radius = np.hypot(cloud[:, 0], cloud[:, 1])
        cloud[:, 0], cloud[:, 1] = radius * np.cos(theta), radius * np.sin(theta)
    cloud += rng.normal(0.0, noise, cloud.shape)
    axis = np.array([0.02, -0.03, 1.0])
    turned: Floats = rotation(axis / np.linalg.norm(axis), 0.05)
    if upside_down:
        turned = turned @ np.diag([1.0, -1.0, -1.0])
    translation = np.array([1.3, -0.7, 2.1])
    return Cloud(cloud @ turned.T + translation, turned, translation)

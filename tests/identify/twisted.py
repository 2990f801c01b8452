"""Scans of helical, double helical and internal gears from their formulas alone: nothing of the package is used.

Transverse half angle of a tooth ψ(r) = ψ_b ∓ inv α_r (− external, + internal), turned by tan β / r per height (ISO 21771).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Twisted:
    """A gear whose teeth may run round it or point inwards; angles in degrees, lengths in mm, + a right hand.

    `double`: the upper half has the other hand. `faces`: points on the end faces, of teeth and of the hub or rim beside them.
    """

    teeth: int = 23
    module: float = 2.0
    helix: float = 0.0
    width: float = 16.0
    pressure: float = 20.0
    shift: float = 0.0
    internal: bool = False
    double: bool = False
    groove: float = 0.0
    stagger: float = 0.0  # of the upper half, in pitches
    rim: bool = False
    faces: bool = True

    @property
    def lead_turn(self) -> float:
        """tan β / r, rad/mm."""
        return math.tan(math.radians(self.helix)) / self.reference

    @property
    def reference(self) -> float:
        return 0.5 * self.teeth * self.module / math.cos(math.radians(self.helix))

    @property
    def base(self) -> float:
        return self.reference * math.cos(self.transverse)

    @property
    def transverse(self) -> float:
        return math.atan(math.tan(math.radians(self.pressure)) / math.cos(math.radians(self.helix)))

    @property
    def base_helix(self) -> float:
        """Degrees: sin β_b = sin β cos α_n."""
        return math.degrees(math.asin(math.sin(math.radians(self.helix)) * math.cos(math.radians(self.pressure))))

    @property
    def tip(self) -> float:
        return self.reference + (-1 if self.internal else 1) * self.module * (0.9 + self.shift)

    @property
    def root(self) -> float:
        return self.reference - (-1 if self.internal else 1) * self.module * (1.25 - self.shift)

    def half_angle(self, radius: np.ndarray) -> np.ndarray:
        """Of a tooth with its fillet; below the base circle radial."""
        sign = -1.0 if self.internal else 1.0
        alpha = np.arccos(np.minimum(self.base / radius, 1.0))
        at = self.transverse
        thickness = (
            self.module
            / math.cos(math.radians(self.helix))
            * (0.5 * math.pi + 2 * self.shift * math.tan(math.radians(self.pressure)))
        )
        psi = thickness / (2 * self.reference) + sign * (math.tan(at) - at) - sign * (np.tan(alpha) - alpha)
        up = np.clip(np.abs(radius - self.root) / (0.3 * self.module), 0.0, 1.0)
        return psi + 0.3 * self.module * (1.0 - np.sqrt(1.0 - (1.0 - up) ** 2)) / radius


def scan(gear: Twisted, points: int = 20_000, noise: float = 0.005, seed: int = 0, teeth_seen: int | None = None) -> np.ndarray:
    """Points (n, 3) of tooth sides, lands and end faces, in a pose of their own."""
    rng = np.random.default_rng(seed)
    pitch = 2 * math.pi / gear.teeth
    low, high = min(gear.root, gear.tip), max(gear.root, gear.tip)
    tooth = rng.integers(0, teeth_seen or gear.teeth, points)
    z = rng.uniform(0.0, gear.width, points)
    kind = rng.random(points)
    radius = rng.uniform(low, high, points)
    angle = rng.choice([-1.0, 1.0], points) * gear.half_angle(radius)
    tip, root = kind < 0.15, (kind >= 0.15) & (kind < 0.3)
    half_tip, half_root = (float(gear.half_angle(np.array([r]))[0]) for r in (gear.tip, gear.root))
    radius[tip], angle[tip] = gear.tip, rng.uniform(-half_tip, half_tip, tip.sum())
    radius[root], angle[root] = gear.root, 0.5 * pitch + rng.uniform(-1, 1, root.sum()) * max(0.5 * pitch - half_root, 0.0)
    if gear.faces:
        face = kind > 0.88
        n = int(face.sum())
        body = rng.random(n) < 0.5
        beside = rng.uniform(high, high + 3 * gear.module, n) if gear.internal else rng.uniform(0.6 * low, low, n)
        radius[face] = np.where(body, beside, rng.uniform(low, high, n))
        angle[face] = np.where(body, rng.uniform(-0.5, 0.5, n) * pitch, rng.uniform(-1, 1, n) * gear.half_angle(radius[face]))
        z[face] = rng.choice([0.0, gear.width], n)
    if gear.rim:
        wall = (kind > 0.3) & (kind < 0.4)
        radius[wall], angle[wall] = high + 3 * gear.module, rng.uniform(-0.5, 0.5, int(wall.sum())) * pitch
    height = z - 0.5 * gear.width
    turn = gear.lead_turn * height
    if gear.double:
        turn = np.where(height < 0, turn, -turn + gear.stagger * pitch)
        if gear.groove:
            cut = np.abs(height) < 0.5 * gear.groove
            radius[cut] = gear.root
    theta = angle + tooth * pitch + turn
    cloud = np.column_stack([radius * np.cos(theta), radius * np.sin(theta), z])
    cloud += rng.normal(0.0, noise, cloud.shape)
    turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turned *= np.sign(np.linalg.det(turned))
    return cloud @ turned.T + rng.uniform(-5, 5, 3)

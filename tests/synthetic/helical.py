"""Scans of helical gears from drawing data alone: nothing of the package is used.

Flanks are involute helicoids. The root is what the tip of a rack leaves that is round in its normal section, so an ellipse in the transverse
one: each of its points cuts when its normal passes through the pitch point. Wear is taken off along the normal in space. Lengths in mm.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from tests.synthetic.tooth import Cloud, Floats, Patch, Tooth, laid


@dataclass(frozen=True)
class Helical(Tooth):
    """`tip_radius` of the rack in normal modules."""

    teeth: int = 15
    module: float = 3.0
    helix: float = 20.0
    width: float = 14.0
    pressure: float = 20.0
    shift: float = 0.1
    addendum: float = 1.0
    dedendum: float = 1.25
    tip_radius: float = 0.30

    def fillet(self, count: int = 4000) -> tuple[Floats, Floats]:
        """Radius and half angle of a tooth along the root from its bottom land up to the involute."""
        alpha, rho = math.radians(self.pressure), self.tip_radius * self.module
        depth = (self.dedendum - self.shift) * self.module - rho
        straight = self.dedendum * self.module - rho
        across = (0.25 * math.pi * self.module - straight * math.tan(alpha) - rho / math.cos(alpha)) / self.cos
        u = np.linspace(0.0, 0.5 * math.pi - alpha, count)
        x, y = across + rho / self.cos * np.sin(u), depth + rho * np.cos(u)  # ellipse, y below the pitch line
        nx, ny = np.sin(u) * self.cos, np.cos(u)
        moved = y * nx / ny - x  # of the rack, when the normal at the point passes through the pitch point
        px, py = x + moved, self.reference - y
        angle = np.arctan2(px, py) - moved / self.reference
        radius = np.hypot(px, py)
        half = math.pi / self.teeth - angle
        roll = np.sqrt(np.maximum(radius**2 - self.base**2, 0.0))
        # Undercut: the root ends where it cuts the involute.
        free = self.reference * math.sin(self.transverse) - (depth + rho * math.sin(alpha)) / math.sin(self.transverse)
        above = (radius > self.base) & (half > self.flank_half(roll)) & (free < 0.0)
        end = int(np.argmax(above)) if above.any() else count
        return radius[:end], half[:end]

    @property
    def land(self) -> float:
        """Half angle of the bottom land."""
        return math.pi / self.teeth - float(self.fillet()[1][0])


def scan(
    gear: Helical,
    count: int = 60_000,
    noise: float = 0.008,
    seed: int = 0,
    wear: tuple[Patch, ...] = (),
    added: Callable[[Floats, Floats, Floats], Floats] | None = None,
    coat: float = 0.0,
    faces: bool = True,
    bent: Mapping[int, float] | None = None,
) -> Cloud:
    """A scan.

    Parameters
    ----------
    gear : Helical
    count : int
        Points, evenly over area.
    noise : float
        Standard deviation of every coordinate.
    wear : tuple of Patch
    added : callable or None
        Deviation along the transverse base tangent of flank points with (side, L, z).
    coat : float
        On every surface, along its normal.
    faces : bool
        Whether the end faces are in it.
    bent : mapping of int to float, or None
        By tooth how far it was bent at its tip, along the transverse base tangent, + counter-clockwise: from nothing at the form circle as the square of the
        way.
    """
    rng = np.random.default_rng(seed)
    fillet_r, fillet_half = gear.fillet()
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fillet_r), fillet_r[1:] * np.diff(fillet_half)))])
    low, high = (math.sqrt(max(r**2 - gear.base**2, 0.0)) for r in (fillet_r[-1], gear.tip))
    tip_half = float(gear.flank_half(np.array([high]))[0])
    body = math.pi * (gear.root**2 - (0.3 * gear.root) ** 2) / gear.teeth
    arcs = {
        "flank": 2 * (high**2 - low**2) / (2 * gear.base) / gear.base_cos, "fillet": 2 * way[-1], "tip": 2 * gear.tip * tip_half,
        "root": 2 * gear.root * gear.land,
    }  # fmt: skip
    areas = {name: arc * gear.width for name, arc in arcs.items()} | ({"face": 2 * body} if faces else {})
    total = sum(areas.values())
    parts = []
    for name, area in areas.items():
        n = int(count * area / total)
        tooth, side, z = rng.integers(0, gear.teeth, n), rng.choice([-1, 1], n), rng.uniform(0.0, gear.width, n)
        off, up, out = np.zeros(n), np.zeros(n), np.ones(n)
        if name == "flank":
            roll = np.sqrt(rng.uniform(low**2, high**2, n))
            radius, angle = np.hypot(gear.base, roll), side * gear.flank_half(roll)
            lever = np.full(n, gear.base)
            if added is not None:
                off += added(side, roll, z) * gear.base_cos
            moved = np.array([(bent or {}).get(int(one), 0.0) for one in tooth])
            off += side * moved * ((roll - low) / (high - low)) ** 2 * gear.base_cos
            for patch in wear:
                off -= np.where((tooth == patch.tooth) & (side == patch.side), patch.at(roll, z), 0.0)
        elif name == "fillet":
            s = rng.uniform(0.0, way[-1], n)
            radius, half = np.interp(s, way, fillet_r), np.interp(s, way, fillet_half)
            # The normal is the tangent turned by a right angle: its share across the radius is the tangent's along it, and the other way round.
            lever = radius * np.interp(s, way, np.gradient(fillet_r, way))
            out = -np.interp(s, way, fillet_r * np.gradient(fillet_half, way))
            angle = side * half
        elif name in ("tip", "root"):
            radius = np.full(n, gear.tip if name == "tip" else gear.root)
            half = tip_half if name == "tip" else gear.land
            angle = rng.uniform(-half, half, n) + (0.0 if name == "tip" else math.pi / gear.teeth)
            lever = np.zeros(n)
        else:
            radius = np.sqrt(rng.uniform((0.3 * gear.root) ** 2, gear.root**2, n))
            angle = rng.uniform(-1, 1, n) * math.pi / gear.teeth
            lever = np.zeros(n)
            upper = rng.random(n) < 0.5
            z, up = np.where(upper, gear.width, 0.0), np.where(upper, 1.0, -1.0)
        theta = angle + 2 * math.pi * tooth / gear.teeth + gear.turn * (z - 0.5 * gear.width)
        # Normal in the section from its lever (r × n)_z = side · lever, then leaning as the screw has it.
        sine = np.clip(lever / radius, -1.0, 1.0)
        along, across = np.copysign(np.sqrt(1.0 - sine**2), out), side * sine
        lean = 1.0 / np.sqrt(1.0 + (gear.turn * lever) ** 2)
        cos, sin = np.cos(theta), np.sin(theta)
        normal = np.column_stack([along * cos - across * sin, along * sin + across * cos, -side * gear.turn * lever])
        normal *= lean[:, None]
        if name == "face":
            normal = np.column_stack([0 * up, 0 * up, up])
        position = np.column_stack([radius * cos, radius * sin, z])
        parts.append(position + (off + coat)[:, None] * normal)
    return laid(np.vstack(parts), noise, rng)

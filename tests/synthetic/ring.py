"""Scans of internal gears from drawing data alone: nothing of the package is used.

Flanks are involute helicoids seen from their other side: on a ring the tooth is what an external gear's space is. The root is an arc that
touches root circle and flank in the transverse section; where it touches is found on the flank's points. Lengths in mm, angles in degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tests.synthetic.tooth import Cloud, Floats, Patch, Tooth, laid


@dataclass(frozen=True)
class Ring(Tooth):
    """`shift` by ISO: + makes teeth thicker and the tip circle smaller. `fillet_radius` in mm, in the transverse section."""

    outwards: ClassVar[int] = -1
    teeth: int = 42
    module: float = 2.5
    helix: float = 0.0
    width: float = 14.0
    pressure: float = 20.0
    shift: float = 0.1
    addendum: float = 0.8
    dedendum: float = 1.25
    fillet_radius: float = 0.5
    rim: float = 65.0
    """Radius of the outside."""

    @property
    def touch(self) -> tuple[float, float]:
        """Roll length at which the fillet touches the flank, and the angle of its centre from the tooth's centre line."""
        roll = np.linspace(math.sqrt(self.tip**2 - self.base**2), 1.2 * math.sqrt(self.root**2 - self.base**2), 200_001)
        angle, radius = self.flank_half(roll), np.hypot(self.base, roll)
        # Out of the metal of a left flank: along the involute's normal, which touches the base circle, against the roll.
        lean = np.arctan(roll / self.base)
        x = radius * np.cos(angle) + self.fillet_radius * -np.sin(angle + lean)
        y = radius * np.sin(angle) + self.fillet_radius * np.cos(angle + lean)
        at = int(np.argmin(np.abs(np.hypot(x, y) - (self.root - self.fillet_radius))))
        return float(roll[at]), float(math.atan2(y[at], x[at]))


def ring_scan(
    ring: Ring,
    count: int = 60_000,
    noise: float = 0.006,
    seed: int = 0,
    wear: tuple[Patch, ...] = (),
    added: Callable[[Floats, Floats, Floats], Floats] | None = None,
    coat: float = 0.0,
    radial: float = 0.0,
    rim: bool = True,
) -> Cloud:
    """A scan.

    Parameters
    ----------
    ring : Ring
    count : int
        Points, evenly over area.
    noise : float
        Standard deviation of every coordinate, mm.
    wear : tuple of Patch
    added : callable or None
        Deviation along the transverse base tangent of flank points with (side, L, z).
    coat : float
        On every surface along its normal, mm.
    radial : float
        By which all radii read too large, mm.
    rim : bool
        Whether the outside is in it.
    """
    rng = np.random.default_rng(seed)
    low, centre = ring.touch
    high = math.sqrt(ring.tip**2 - ring.base**2)
    tip_half, space = float(ring.flank_half(np.array([high]))[0]), math.pi / ring.teeth
    # The fillet from where it leaves the root circle (outwards) round to the flank's normal, from its own centre.
    middle = (ring.root - ring.fillet_radius) * np.array([math.cos(centre), math.sin(centre)])
    lean = float(ring.flank_half(np.array([low]))[0]) + math.atan(low / ring.base)
    start, end = centre, lean - 0.5 * math.pi  # directions from the centre: of the root circle, and against the flank's normal
    lengths = {
        "flank": 2 * (low**2 - high**2) / (2 * ring.base) / ring.base_cos, "fillet": 2 * ring.fillet_radius * abs(start - end),
        "tip": 2 * ring.tip * tip_half, "root": 2 * ring.root * (space - centre), "rim": 2 * ring.rim * space * rim,
    }  # fmt: skip
    areas = {name: length * ring.width for name, length in lengths.items()}
    areas["face"] = 2 * math.pi * (ring.rim**2 - ring.root**2) / ring.teeth
    parts = []
    for name, area in areas.items():
        n = int(count * area / sum(areas.values()))
        tooth, side, z = rng.integers(0, ring.teeth, n), rng.choice([-1, 1], n), rng.uniform(0.0, ring.width, n)
        off = np.zeros(n)
        if name == "flank":
            roll = np.sqrt(rng.uniform(high**2, low**2, n))
            angle, radius = ring.flank_half(roll), np.hypot(ring.base, roll)
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            lean_ = angle + np.arctan(roll / ring.base)
            nx, ny = -np.sin(lean_), np.cos(lean_)
            if added is not None:
                off += added(side, roll, z) * ring.base_cos
            for patch in wear:
                off -= np.where((tooth == patch.tooth) & (side == patch.side), patch.at(roll, z), 0.0)
        elif name == "fillet":
            way = rng.uniform(end, start, n)
            x, y = (middle[i] + ring.fillet_radius * f(way) for i, f in enumerate((np.cos, np.sin)))
            nx, ny = -np.cos(way), -np.sin(way)  # towards the centre, which lies in the space
        elif name == "face":
            radius, angle = np.sqrt(rng.uniform(ring.root**2, ring.rim**2, n)), rng.uniform(0.0, space, n)
            x, y, nx, ny = radius * np.cos(angle), radius * np.sin(angle), 0 * radius, 0 * radius
            z = np.where(rng.random(n) < 0.5, ring.width, 0.0)
        else:
            radius = {"tip": ring.tip, "root": ring.root, "rim": ring.rim}[name]
            ends = {"tip": (0.0, tip_half), "root": (centre, space), "rim": (0.0, space)}[name]
            angle = rng.uniform(*ends, n)
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            outwards = 1.0 if name == "rim" else -1.0
            nx, ny = outwards * np.cos(angle), outwards * np.sin(angle)
        # On the other side of the tooth as in a mirror; then leaning as the screw has it.
        y, ny = side * y, side * ny
        nz = -ring.turn * (x * ny - y * nx)
        if name == "face":
            nz = np.where(z > 0.0, 1.0, -1.0)
        size = np.sqrt(nx**2 + ny**2 + nz**2)
        theta = 2 * math.pi * tooth / ring.teeth + (0.0 if name == "rim" else ring.turn * (z - 0.5 * ring.width))
        cos, sin = np.cos(theta), np.sin(theta)
        move = (off + coat) / size
        px, py = x + move * nx, y + move * ny
        parts.append(np.column_stack([cos * px - sin * py, sin * px + cos * py, z + move * nz]))
    cloud = np.vstack(parts)
    radius = np.hypot(cloud[:, 0], cloud[:, 1])
    cloud[:, :2] *= (1.0 + radial / radius)[:, None]
    return laid(cloud, noise, rng)

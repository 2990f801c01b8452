"""A root fillet drawn as an arc: from the root circle to the flank of a ring, tangent to both, in the transverse section."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.spec import GearSpec


@dataclass(frozen=True, slots=True)
class FilletArc:
    """An arc about a centre in the space of a ring; its parameter φ is the angle of its radius from that through the axis.

    Parameters
    ----------
    centre_radius : float
        Of its centre about the gear axis, mm.
    centre_angle : float
        Of its centre from the space's centre line, rad; not negative.
    radius : float
        ρ, mm.
    """

    centre_radius: float
    centre_angle: float
    radius: float

    @property
    def land_half_angle(self) -> float:
        """Half the bottom land, seen from the axis, rad."""
        return self.centre_angle

    def polar(self, phi: Floats) -> tuple[Floats, Floats]:
        """Radius (mm) and angle from the space centre (rad) at `phi`."""
        x, y = self.centre_radius + self.radius * np.cos(phi), self.radius * np.sin(phi)
        return np.hypot(x, y), self.centre_angle + np.arctan2(y, x)

    def at_radius(self, radius: Floats, limit: float) -> Floats:
        """φ in 0 … `limit` at which the arc has the given radius (mm): half-angle form of the law of cosines."""
        c, rho = self.centre_radius, self.radius
        r = np.clip(np.asarray(radius, dtype=np.float64), c - rho, c + rho)
        # (c + ρ)² − r² = 2 c ρ (1 − cos φ) = 4 c ρ sin²(φ/2): no digit is lost near the root circle
        sine = np.sqrt((c + rho - r) * (c + rho + r) / (4.0 * c * rho))
        return np.asarray(np.clip(2.0 * np.arcsin(np.minimum(sine, 1.0)), 0.0, limit), dtype=np.float64)

    def normal_angle(self, radius: Floats, angle: Floats, start: Floats, limit: float) -> Floats:
        """φ of the radius that passes through given points, within 0 … `limit`; closed form, `start` is not needed."""
        at = angle - self.centre_angle
        direction = np.arctan2(radius * np.sin(at), radius * np.cos(at) - self.centre_radius)
        return np.asarray(np.clip(direction, 0.0, limit), dtype=np.float64)

    def plumb_line(self, radius: Floats, angle: Floats, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """Distance (mm) along the normal at `phi`, + towards the space; that normal along the point's own radius, and across it."""
        at = angle - self.centre_angle
        reach = radius * np.cos(at - phi) - self.centre_radius * np.cos(phi)
        return self.radius - reach, -np.cos(phi - at), np.sin(phi - at)

    def lever(self, phi: Floats) -> Floats:
        """Moment of the transverse normal about the axis, mm."""
        return np.asarray(self.centre_radius * np.sin(phi), dtype=np.float64)

    def sector_area(self, limit: float) -> float:
        """Area (mm²) swept from the axis from φ = 0 to `limit`."""
        return 0.5 * self.radius * (self.radius * limit + self.centre_radius * math.sin(limit))

    def words(self, spec: GearSpec) -> str:
        """What makes it, with its sizes."""
        return f"a fillet of {self.radius:.3g} mm"

"""The pinion-type cutter of a ring: the root its tip leaves.

The cutter rolls inside the ring on the pitch circles r_w0 and r_w2 = r_w0 z / z0, axes a0 apart; its tip is an arc of radius ρ0 in the
transverse section, about a centre at the radius r_c and the angle ε from the cutter tooth's centre line. The cutter's own angle from the
line of centres to that arc's centre is the natural parameter φ: 0 at the bottom of the root, where both lie on one line. Normals pass the
pitch point, as those of every generated curve do (Litvin & Fuentes 2004, ch. 6).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.spec import GearSpec

STEPS = 12
"""Most Newton steps; they are quadratic and end after four or five."""


@dataclass(frozen=True, slots=True)
class ShaperTip:
    """Tip arc of a pinion-type cutter, in mm, rolling inside a ring.

    Parameters
    ----------
    centre_distance : float
        a0, from the ring's axis to the cutter's.
    pitch_radius : float
        r_w2, the ring's circle on which the cutter rolls.
    ratio : float
        z0 / z, turn of the ring for each turn of the cutter.
    centre_radius : float
        r_c, of the arc's centre about the cutter's axis.
    centre_angle : float
        ε, of the arc's centre from the cutter tooth's centre line, rad; not negative.
    tip_radius : float
        ρ0; 0 is a sharp corner.
    """

    centre_distance: float
    pitch_radius: float
    ratio: float
    centre_radius: float
    centre_angle: float
    tip_radius: float

    @property
    def land_half_angle(self) -> float:
        """Half the bottom land, seen from the ring's axis, rad."""
        return self.centre_angle * self.ratio

    def _centre(self, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """The arc's centre from the pitch point, x along the line of centres, y across, and its distance, mm."""
        x = self.centre_distance - self.pitch_radius + self.centre_radius * np.cos(phi)
        y = self.centre_radius * np.sin(phi)
        return x, y, np.hypot(x, y)

    def _turn(self, phi: Floats) -> Floats:
        """Turn of the ring since its space stood on the line of centres, rad."""
        return np.asarray((phi - self.centre_angle) * self.ratio, dtype=np.float64)

    def contact(self, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """Generated point along the line of centres and across it from the ring's axis (mm), and the ring's turn (rad)."""
        x, y, distance = self._centre(phi)
        outward = 1.0 + self.tip_radius / distance
        return self.pitch_radius + outward * x, outward * y, self._turn(phi)

    def polar(self, phi: Floats) -> tuple[Floats, Floats]:
        """Radius (mm) and angle from the space centre (rad) of the generated curve at `phi`."""
        x, y, turn = self.contact(phi)
        return np.hypot(x, y), np.arctan2(y, x) - turn

    def _rates(self, phi: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Generated point in the shop, and its derivative by φ."""
        x, y, distance = self._centre(phi)
        dx, dy = -self.centre_radius * np.sin(phi), self.centre_radius * np.cos(phi)
        outward = 1.0 + self.tip_radius / distance
        fall = self.tip_radius * (x * dx + y * dy) / distance**3
        return self.pitch_radius + outward * x, outward * y, outward * dx - fall * x, outward * dy - fall * y

    def at_radius(self, radius: Floats, limit: float) -> Floats:
        """φ in 0 … `limit` at which the curve has the given radius (mm), to rounding, by Newton on r² from a table in sqrt(r_f − r)."""
        table = np.linspace(0.0, limit, 129)
        known = self.polar(table)[0]
        r = np.clip(np.asarray(radius, dtype=np.float64), known[-1], known[0])
        phi = np.interp(np.sqrt(known[0] - r), np.sqrt(np.maximum(known[0] - known, 0.0)), table)
        for _ in range(STEPS):
            x, y, dx, dy = self._rates(phi)
            slope = x * dx + y * dy
            new = np.clip(phi - 0.5 * (x * x + y * y - r * r) / np.minimum(slope, -1e-12), 0.0, limit)
            moved = float(np.abs(new - phi).max(initial=0.0))
            phi = new
            if moved < 1e-10:  # quadratic: the next step would be rounding
                break
        return np.asarray(phi, dtype=np.float64)

    def normal_angle(self, radius: Floats, angle: Floats, start: Floats, limit: float) -> Floats:
        """φ of the normal that passes through given points, within 0 … `limit`; as `RackTip.normal_angle`.

        The point, the pitch point and the arc's centre lie on one line: Newton on their cross product.
        """
        phi = np.clip(start, 0.0, limit)
        for _ in range(STEPS):
            x, y, _distance = self._centre(phi)
            dx, dy = -self.centre_radius * np.sin(phi), self.centre_radius * np.cos(phi)
            at = angle + self._turn(phi)
            along, across = radius * np.cos(at), radius * np.sin(at)
            from_pitch = along - self.pitch_radius
            miss = from_pitch * y - across * x
            slope = from_pitch * dy - across * dx - self.ratio * (across * y + along * x)
            step = miss / np.where(np.abs(slope) > 1e-9, slope, 1e-9)
            new = np.clip(phi - np.clip(step, -0.3, 0.3), 0.0, limit)
            moved = float(np.abs(new - phi).max(initial=0.0))
            phi = new
            if moved < 1e-8:
                break
        return np.asarray(phi, dtype=np.float64)

    def plumb_line(self, radius: Floats, angle: Floats, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """Distance (mm) along the normal at `phi`, + towards the space; that normal along the point's own radius, and across it."""
        x, y, distance = self._centre(phi)
        at = angle + self._turn(phi)
        cos, sin = np.cos(at), np.sin(at)
        ux, uy = x / distance, y / distance  # into the metal
        reach = (radius * cos - self.pitch_radius) * ux + radius * sin * uy
        return distance + self.tip_radius - reach, -(ux * cos + uy * sin), uy * cos - ux * sin

    def lever(self, phi: Floats) -> Floats:
        """Moment of the transverse normal about the ring's axis, mm; r_b where the root meets the flank."""
        _, y, distance = self._centre(phi)
        return np.asarray(self.pitch_radius * y / distance, dtype=np.float64)

    def sector_area(self, limit: float) -> float:
        """Area (mm²) swept from the axis from φ = 0 to `limit`: ½ ∫ r² dβ, by 64 nodes of Gauss."""
        nodes, weights = np.polynomial.legendre.leggauss(64)
        x, y, dx, dy = self._rates(0.5 * limit * (nodes + 1.0))
        swept = x * dy - y * dx - (x * x + y * y) * self.ratio
        return float(0.25 * limit * np.dot(weights, swept))

    def words(self, spec: GearSpec) -> str:
        """What makes it, with its sizes."""
        return f"a cutter of {round(self.ratio * spec.teeth)} teeth with a tip radius of {self.tip_radius / spec.normal_module:.3g} modules"

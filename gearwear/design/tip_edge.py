"""The edge between flank and tip circle: sharp, a chamfer of 45°, or an arc tangent to both."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.involute import involute_at_roll


@dataclass(frozen=True, slots=True)
class TipArc:
    """A tip rounding in the transverse section, on the left of a tooth's centre line.

    The centre lies ρ within the tip circle and on the flank's inner parallel, which is the same involute turned by ρ / r_b (the normals of
    an involute are tangents of its base circle): both tangencies are closed forms, of a ring (ι = −1) too.

    Parameters
    ----------
    radius : float
        ρ, mm.
    tip_radius, base_radius, base_half_angle : float
        Of the gear, mm, mm and rad.
    orientation : int
        ι.
    """

    radius: float
    tip_radius: float
    base_radius: float
    base_half_angle: float
    orientation: int

    @property
    def centre_radius(self) -> float:
        """Of its centre about the gear's axis, mm."""
        return self.tip_radius - self.orientation * self.radius

    @property
    def centre_roll(self) -> float:
        """Roll length of its centre, mm; nan where it lies within the base circle."""
        square = (self.centre_radius - self.base_radius) * (self.centre_radius + self.base_radius)
        return math.sqrt(square) if square > 0.0 else math.nan

    @property
    def half_angle(self) -> float:
        """Of its centre, and of the tip land's end, from the tooth's centre line, rad."""
        turned = self.base_half_angle - self.radius / self.base_radius
        return turned - self.orientation * float(involute_at_roll(np.array(self.centre_roll), self.base_radius))

    @property
    def flank_end_radius(self) -> float:
        """Where the flank ends, mm; nan where there is no such arc."""
        return math.hypot(self.base_radius, self.centre_roll + self.orientation * self.radius)

    def points(self, share: Floats) -> Floats:
        """(n, 2) points from the flank (share 0) to the tip land (1), mm; the tooth on +x."""
        x, y = (self.centre_radius * part(self.half_angle) for part in (math.cos, math.sin))
        return np.array([x, y]) + self.radius * self.normals(share)

    def normals(self, share: Floats) -> Floats:
        """(n, 2) unit normals there, out of the metal."""
        first, last = self._ends
        angle = first + (last - first) * share
        return np.column_stack([np.cos(angle), np.sin(angle)])

    @property
    def _ends(self) -> tuple[float, float]:
        """Direction from the centre to the flank's end and to the land's, rad."""
        lean = math.atan2(self.centre_roll, self.base_radius)  # the flank's normal from the centre's own direction across
        across = self.half_angle + 0.5 * math.pi
        outward = self.half_angle + (0.0 if self.orientation > 0 else math.pi)
        return across - self.orientation * lean, outward

    @property
    def sector_area(self) -> float:
        """Area swept from the axis by the arc, ½ ∫ r² dψ from the flank's end to the land's as ψ falls, mm²."""
        first, last = self._ends
        chord = math.sin(last - self.half_angle) - math.sin(first - self.half_angle)
        return -0.5 * self.radius * (self.radius * (last - first) + self.centre_radius * chord)

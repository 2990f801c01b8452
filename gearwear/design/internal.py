"""Conditions of a pinion, or a pinion-type cutter, inside a ring: three interferences, each as a margin that must not be negative.

Sources: ISO 21771:2007 for the angles; SDP/SI, *Elements of Metric Gear Technology*, eqs. 5-5 to 5-10, for the three conditions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.involute import involute_function


@dataclass(frozen=True, slots=True)
class Wheel:
    """What the conditions need of either gear: teeth, and tip and base radius (mm)."""

    teeth: int
    tip_radius: float
    base_radius: float

    @property
    def tip_angle(self) -> float:
        """Pressure angle at the tip circle, rad."""
        return math.acos(min(self.base_radius / self.tip_radius, 1.0))

    @property
    def tip_involute(self) -> float:
        """inv α_a, rad."""
        return involute_function(self.tip_angle)

    @property
    def tip_roll(self) -> float:
        """L at the tip circle, mm."""
        return math.sqrt(max(self.tip_radius**2 - self.base_radius**2, 0.0))


@dataclass(frozen=True, slots=True)
class InternalPair:
    """A pinion inside a ring, without backlash.

    Parameters
    ----------
    pinion, ring : Wheel
    centre_distance : float
        a, mm; above the difference of the base radii.
    """

    pinion: Wheel
    ring: Wheel
    centre_distance: float

    @property
    def working_angle(self) -> float:
        """α_w, rad: cos α_w = (r_b2 − r_b1) / a."""
        return math.acos((self.ring.base_radius - self.pinion.base_radius) / self.centre_distance)

    @property
    def involute_margin(self) -> float:
        """L_a2 − a sin α_w, mm of roll: below 0 the ring's tip passes the pinion's base circle and cuts into it, or is cut by it."""
        return self.ring.tip_roll - self.centre_distance * math.sin(self.working_angle)

    @property
    def fouling_margin(self) -> float:
        """θ1 z1/z2 + inv α_w − inv α_a2 − θ2, rad of the ring: below 0 tips meet where they leave each other (trochoid interference)."""
        a, r1, r2 = self.centre_distance, self.pinion.tip_radius, self.ring.tip_radius
        if r2 >= a + r1:
            return math.inf  # the tip circles do not cross
        working = involute_function(self.working_angle)
        at_pinion = math.acos(_cosine((r2 * r2 - r1 * r1 - a * a) / (2.0 * a * r1))) + self.pinion.tip_involute - working
        at_ring = math.acos(_cosine((a * a + r2 * r2 - r1 * r1) / (2.0 * a * r2)))
        return at_pinion * self.pinion.teeth / self.ring.teeth + working - self.ring.tip_involute - at_ring

    @property
    def trimming_margin(self) -> float:
        """θ1 + inv α_a1 − inv α_w − (z2/z1)(θ2 + inv α_a2 − inv α_w), rad of the pinion: below 0 it cannot be put in, or a cutter fed, radially."""
        ratio = self.pinion.teeth / self.ring.teeth
        cosines = math.cos(self.pinion.tip_angle) / math.cos(self.ring.tip_angle)
        at_pinion = (1.0 - cosines**2) / (1.0 - ratio**2)
        at_ring = (1.0 / cosines**2 - 1.0) / (1.0 / ratio**2 - 1.0)
        if not (0.0 <= at_pinion <= 1.0 and 0.0 <= at_ring <= 1.0):
            return math.inf  # no tooth stands where its tip could meet the ring's on the way in
        working = involute_function(self.working_angle)
        reach = math.asin(math.sqrt(at_pinion)) + self.pinion.tip_involute - working
        return reach - (math.asin(math.sqrt(at_ring)) + self.ring.tip_involute - working) / ratio


def _cosine(value: float) -> float:
    return min(max(value, -1.0), 1.0)

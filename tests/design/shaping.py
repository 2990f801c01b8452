"""A pinion-type cutter rolled inside a ring: whether it cuts a point, from nothing but the cutter's own involute and arc."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from gearwear.arrays import Floats
from gearwear.design import GearSpec

STEPS = 1501


@dataclass(frozen=True)
class Cutter:
    """A cutter without profile shift, set so deep that its tip reaches the ring's root circle; transverse section, mm."""

    spec: GearSpec
    teeth: int
    tip_radius: float
    """Of the arc, mm."""

    @property
    def _transverse(self) -> tuple[float, float]:
        cos = math.cos(self.spec.helix_angle)
        return self.spec.normal_module / cos, math.atan(math.tan(self.spec.normal_pressure_angle) / cos)

    @property
    def base(self) -> float:
        module, alpha = self._transverse
        return 0.5 * module * self.teeth * math.cos(alpha)

    @property
    def centre(self) -> float:
        """Distance of the axes at which the cutter's space width is the ring's tooth on the working pitch circle: no play."""
        module, alpha = self._transverse
        cos, z, z0 = math.cos(self.spec.helix_angle), self.spec.teeth, self.teeth
        ring = (
            0.5 * math.pi + 2.0 * self.spec.profile_shift * math.tan(self.spec.normal_pressure_angle)
        ) * self.spec.normal_module
        standard, base = 0.5 * module * (z - z0), 0.5 * module * (z - z0) * math.cos(alpha)

        def play(centre: float) -> float:
            working = math.acos(base / centre)
            inv, at = math.tan(working) - working, math.tan(alpha) - alpha
            own = math.pi * module / 2.0 / (module * z0) + at - inv  # half angle of the cutter's tooth there, not thickened
            mate = ring / cos / (module * z) - at + inv
            return math.pi - z * mate - z0 * own  # both arcs fill the pitch, in angles times teeth

        return float(brentq(play, base * (1.0 + 1e-9), 1.3 * standard, xtol=1e-15, rtol=1e-15))

    def cut_depth(self, radius: Floats, angle: Floats) -> Floats:
        """How deep (mm) the cutter ever gets over points of the blank; radius and angle from the centre line of a space."""
        turn = np.linspace(-1.2, 1.2, STEPS) * math.pi / self.teeth * 2.0 + np.zeros((len(radius), 1))
        for _ in range(3):
            depth = self._depth(radius[:, None], angle[:, None], turn)
            deepest = np.take_along_axis(turn, depth.argmax(axis=1)[:, None], axis=1)
            turn = deepest + (turn[:, 1] - turn[:, 0])[:, None] * np.linspace(-1.0, 1.0, STEPS)
        return np.asarray(self._depth(radius[:, None], angle[:, None], turn).max(axis=1), dtype=np.float64)

    def _depth(self, radius: Floats, angle: Floats, turn: Floats) -> Floats:
        """Depth within the cutter's tooth, which has turned by `turn` about its own axis, and the ring with it."""
        module, alpha = self._transverse
        centre = self.centre
        at = angle + turn * self.teeth / self.spec.teeth
        x, y = radius * np.cos(at) - centre, radius * np.sin(at)
        own, around = np.hypot(x, y), np.abs(np.arctan2(y, x) - turn)
        half = (0.5 * math.pi * self.spec.normal_module + self.spec.thinning) / math.cos(self.spec.helix_angle)
        half = half / (module * self.teeth) + math.tan(alpha) - alpha
        root = self.spec.normal_module * (self.spec.dedendum - self.spec.profile_shift) + 0.5 * module * self.spec.teeth
        tip = root - centre
        roll = np.sqrt(np.maximum(own**2 - self.base**2, 0.0))
        flank = self.base * (half - around) - (roll - self.base * np.arctan(roll / self.base))
        arc = tip - self.tip_radius
        arc_roll = math.sqrt(arc**2 - self.base**2)
        arc_angle = half - self.tip_radius / self.base - (arc_roll / self.base - math.atan(arc_roll / self.base))
        px, py = own * np.cos(around) - arc * math.cos(arc_angle), own * np.sin(around) - arc * math.sin(arc_angle)
        # The corner lies between the arc's radius through the axis and the flank's normal, which touches the base circle.
        direction = np.arctan2(py, px) - arc_angle
        corner = (direction > 0.0) & (direction < math.acos(arc_roll / arc))
        plain = np.minimum(flank, tip - own)
        depth = np.where(corner, np.minimum(plain, self.tip_radius - np.hypot(px, py)), plain)
        return np.where(own > self.base, depth, -1.0)

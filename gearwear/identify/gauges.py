"""Dimensions of a gear as they are measured, and the helix of its teeth."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.spec import MOST_HELIX_DEGREES

DRAWN_ANGLES = (1.0, 0.5, 0.01)
"""Degrees, of which a drawn helix angle is a multiple where a scan leaves room for it."""


@dataclass(frozen=True, slots=True)
class Measured:
    """A length and its standard deviation, mm.

    Parameters
    ----------
    value, std : float
        mm.
    scale : float
        Relative standard deviation of the scale, which `std` holds: what is left without it is the length's own.
    """

    value: float
    std: float
    scale: float = 0.0

    @property
    def own_std(self) -> float:
        """Standard deviation on a scan of true scale, mm."""
        return math.sqrt(max(self.std**2 - (self.scale * self.value) ** 2, 0.0))


@dataclass(frozen=True, slots=True)
class Helix:
    """What is known of the helix of a gear, rad, + right hand.

    Parameters
    ----------
    angle : float
        β at the reference circle; where `at_base`, β_b at the base circle, as a scan shows it without a pressure angle.
    std : float
        Its standard deviation; 0 where it is stated.
    at_base : bool
    """

    angle: float = 0.0
    std: float = 0.0
    at_base: bool = False

    def at_reference(self, pressure_angle: float) -> float | None:
        """β for a normal pressure angle, sin β = sin β_b / cos α_n; as a drawing would have it, where that is as likely. None: impossible."""
        if not self.at_base:
            return self.angle
        sine = math.sin(self.angle) / math.cos(pressure_angle)
        if not abs(sine) < math.sin(math.radians(MOST_HELIX_DEGREES)):
            return None
        degrees = math.degrees(math.asin(sine))
        for step in DRAWN_ANGLES:
            drawn = round(degrees / step) * step
            if abs(drawn - degrees) < 2.0 * math.degrees(self.std):
                return math.radians(round(drawn, 9))
        return math.radians(round(degrees, 3))


SPUR = Helix()
"""No helix."""


@dataclass(frozen=True, slots=True)
class Gauge:
    """One measured dimension of a gear.

    Parameters
    ----------
    kind : str
        "tip_diameter", "root_diameter", "span", "over_pins", "thickness" or "base_pitch"; the latter two in the transverse section, over
        balls in one plane where the teeth are helical.
    length : Measured
        mm.
    at : float
        Span: teeth spanned. Over pins: pin diameter in mm. Thickness: diameter in mm at which the arc is measured. Else not used.
    """

    kind: str
    length: Measured
    at: float = 0.0

    @property
    def name(self) -> str:
        """What it is, for people."""
        label = self.kind.replace("_", " ")
        return {
            "span": f"span over {self.at:g} teeth",
            "over_pins": f"over {self.at:g} mm pins",
            "thickness": f"tooth thickness at diameter {self.at:.2f} mm",
        }.get(self.kind, label)

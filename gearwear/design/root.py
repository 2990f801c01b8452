"""The root of a tooth space: what a curve from the bottom land to the flank must say of itself.

Three curves do: the trochoid of a rack (`rack.RackTip`), that of a pinion-type cutter (`shaper.ShaperTip`), and a fillet drawn as an arc
(`fillet_arc.FilletArc`). Coordinates are polar about the gear axis, the angle measured from the **space** centre line towards the tooth. Each
has a parameter φ of its own, 0 where the curve leaves the bottom land, rising towards the flank.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.spec import GearSpec


class RootCurve(Protocol):
    """A root whose normals are known in closed form; mm and rad."""

    @property
    def land_half_angle(self) -> float:
        """Half the bottom land, seen from the axis, rad."""

    def polar(self, phi: Floats) -> tuple[Floats, Floats]:
        """Radius (mm) and angle from the space centre (rad) at `phi`."""

    def at_radius(self, radius: Floats, limit: float) -> Floats:
        """φ in 0 … `limit` at which the curve has the given radius (mm)."""

    def normal_angle(self, radius: Floats, angle: Floats, start: Floats, limit: float) -> Floats:
        """φ in 0 … `limit` whose normal passes through given points, from first guesses `start`."""

    def plumb_line(self, radius: Floats, angle: Floats, phi: Floats) -> tuple[Floats, Floats, Floats]:
        """Distance (mm) of points along the normal at `phi`, + towards the space, and that normal along the point's own radius and across.

        Across is + towards the space's centre line. All in the transverse section.
        """

    def lever(self, phi: Floats) -> Floats:
        """Moment of the transverse normal about the axis, on the left of a tooth, mm; r_b where the curve meets the flank."""

    def sector_area(self, limit: float) -> float:
        """Area (mm²) swept from the axis from φ = 0 to `limit`: ½ ∫ r² dβ."""

    def words(self, spec: GearSpec) -> str:
        """What makes it, with its sizes."""


def fillet_table(curve: RootCurve, end: float, orientation: int) -> tuple[Floats, Floats]:
    """(65,) radius (mm), rising, and φ along a fillet that ends at φ = `end`: where the search for a foot begins."""
    phi = np.linspace(0.0, end, 65)[::orientation]
    return curve.polar(phi)[0], phi


@dataclass(frozen=True, slots=True)
class ToothSection:
    """What is known of a transverse section before its root, mm and rad."""

    reference_radius: float
    base_radius: float
    tip_radius: float
    root_radius: float
    flank_end_radius: float
    pressure_angle: float
    base_half_angle: float


@dataclass(frozen=True, slots=True)
class RootPart:
    """A root curve and where it ends.

    Parameters
    ----------
    curve : RootCurve
    end : float
        φ where it meets the flank.
    form_radius : float
        Radius there, mm.
    undercut : bool
        Whether it cuts the involute instead of running into it.
    stated : bool
        Whether the drawing says it: that of a ring without cutter or fillet is a guess, and no datum.
    """

    curve: RootCurve
    end: float
    form_radius: float
    undercut: bool = False
    stated: bool = True

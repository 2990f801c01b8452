"""How the points of a scan come on the design: moved, located, and what is higher than low tips left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import Bands, SurfacePoints, locate
from gearwear.placing.low_tips import below_tips
from gearwear.placing.pose import Pose


class Places(Protocol):
    """Something that puts points on the design."""

    def located(self, points: Floats) -> SurfacePoints:
        """Points (n, 3), mm, on the design."""


@dataclass(frozen=True, slots=True)
class OnDesign:
    """By a motion and by bands.

    Parameters
    ----------
    gear : Gear
    bands : Bands
        How far a point may lie from a surface.
    noise : float
        Scatter of points, mm.
    shift : float
        How far the tips lie above those drawn, mm.
    motion : Pose or None
        Before they are located; None: they stay.
    """

    gear: Gear
    bands: Bands
    noise: float
    shift: float
    motion: Pose | None = None

    def located(self, points: Floats) -> SurfacePoints:
        """Points (n, 3) of the frame that the motion begins in, mm."""
        here = points if self.motion is None else self.motion.apply(points)
        return below_tips(locate(here, self.gear, self.bands), self.gear, self.noise, self.shift)

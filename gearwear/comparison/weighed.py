"""The scale beside the scan: does the weighed loss of mass agree with the volume that the scan shows missing?"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.weighing import WeighingSpec

AGREE = 1.959963984540054
"""Standard deviations of the difference up to which the two agree: 95 % of a normal distribution."""


@dataclass(frozen=True, slots=True)
class WeighedLoss:
    """Lost volume by weighing and by the scan, mm³.

    Parameters
    ----------
    mass : float
        Lost, g.
    weighed, scanned : (float, float)
        Volume and standard deviation.
    low, high : float
        Within what limits the scanned volume lies where something is left open; else the volume itself.
    """

    mass: float
    weighed: tuple[float, float]
    scanned: tuple[float, float]
    low: float
    high: float

    @property
    def difference(self) -> float:
        """Weighed less scanned, mm³; from the nearest limit where the scan leaves the volume open."""
        return self.weighed[0] - min(max(self.weighed[0], self.low), self.high)

    @property
    def difference_std(self) -> float:
        """mm³."""
        return math.hypot(self.weighed[1], self.scanned[1])

    @property
    def agrees(self) -> bool:
        """Whether the difference is no more than chance."""
        return abs(self.difference) <= AGREE * self.difference_std


def weighed_loss(weighing: WeighingSpec, lost: tuple[float, float], limits: tuple[float, float] | None) -> WeighedLoss:
    """Put the weighed loss beside the scanned one.

    Parameters
    ----------
    weighing : WeighingSpec
    lost : (float, float)
        Metal that is gone by the scan, worn and broken off, and its standard deviation, mm³.
    limits : (float, float) or None
        Within what limits it lies, where the scan leaves it open.
    """
    low, high = limits or (lost[0], lost[0])
    return WeighedLoss(weighing.lost_mass, weighing.lost_volume, lost, min(low, lost[0]), max(high, lost[0]))

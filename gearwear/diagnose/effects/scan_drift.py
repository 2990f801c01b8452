"""Drift of the angle over the scan: a seam where the revolution closes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, polar_angle, turned, turning
from gearwear.diagnose.parameter import Parameter, Spread, angular

FEWEST_STARTS, MOST_STARTS = 24, 72


@dataclass(frozen=True)
class ScanDrift(CatalogueEffect):
    """θ measured = θ + c (share of the revolution since the start − ½), the share counted counter-clockwise.

    Notes
    -----
    A scan that went round clockwise shows it with the sign of c turned over. The jump, −c at the start, lies where the scan
    started, not at a certain tooth.
    """

    name: ClassVar[str] = "scan_drift"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "slow change of the table's or the laser's zero over one revolution"
    tells_apart: ClassVar[str] = (
        "Start the scan at another tooth: the seam goes where the scan starts, a pitch error stays with its tooth."
    )
    group: ClassVar[str] = "G4"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("closure_deg"), angular("start_deg", spread=Spread.JUMP))
    phrase: ClassVar[str] = "a drift during the scan that leaves a step of {closure_deg} at {start_deg}"
    lower: ClassVar[float] = -math.radians(2.0)
    upper: ClassVar[float] = math.radians(2.0)

    def applies(self, context: Context) -> bool:
        return context.turntable

    def shapes(self, context: Context) -> list[Shape]:
        step = self._step(context)
        return [(step * number,) for number in range(round(2.0 * math.pi / step))]

    def _step(self, context: Context) -> float:
        """Half a pitch: with its seam on the wrong tooth, that tooth alone takes back what the others gain."""
        return 2.0 * math.pi / min(max(2 * context.gear.teeth, FEWEST_STARTS), MOST_STARTS)

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        step = self._step(context)
        return [(shape[0] - step, shape[0] + step)]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        share = np.mod(polar_angle(points) - shape[0], 2.0 * np.pi) / (2.0 * np.pi)
        return np.asarray((turning(points) * (share - 0.5))[:, None])

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        share = np.mod(np.arctan2(position[:, 1], position[:, 0]) - shape[0], 2.0 * np.pi) / (2.0 * np.pi)
        return turned(position, amplitudes[0] * (share - 0.5))


EFFECT = ScanDrift()

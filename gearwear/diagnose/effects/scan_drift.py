"""Drift of the angle over the scan: a seam where the revolution closes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, polar_angle, turning


@dataclass(frozen=True)
class ScanDrift:
    """θ measured = θ + c (share of the revolution since the start − ½).

    Notes
    -----
    The jump lies where the scan started, not at a certain tooth: another start moves it, a pitch error stays.
    """

    name: ClassVar[str] = "scan_drift"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: drift over scan time"
    group: ClassVar[str] = "G4"
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "closure_deg",
        "start_deg",
    )

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [(math.radians(start),) for start in range(0, 360, 15)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        step = math.radians(15.0)
        return [(shape[0] - step, shape[0] + step)]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(abs(amplitudes[0]) < math.radians(2.0))

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        std = math.sqrt(max(float(covariance[0, 0]), 0.0))
        return {
            "closure_deg": Estimate(math.degrees(float(amplitudes[0])), math.degrees(std), "deg"),
            "start_deg": Estimate(math.degrees(shape[0]) % 360.0, 360.0 / context.gear.teeth / math.sqrt(12.0), "deg"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        share = np.mod(polar_angle(points) - shape[0], 2.0 * np.pi) / (2.0 * np.pi)
        return np.asarray((turning(points) * (share - 0.5))[:, None])


EFFECT = ScanDrift()

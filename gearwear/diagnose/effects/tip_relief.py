"""Tip relief: metal taken off towards the tip."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, on_flank


@dataclass(frozen=True)
class TipRelief:
    """δ = −C (L − L_r) / (L_tip − L_r) above the start L_r; the same on both flanks of every tooth."""

    name: ClassVar[str] = "tip_relief"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771:2007, tip relief C_a"
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "amount_um",
        "start_mm",
    )

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        gear = context.gear
        return [(gear.form_roll + share * (gear.tip_roll - gear.form_roll),) for share in (0.4, 0.5, 0.6, 0.7, 0.8, 0.9)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        step = 0.1 * (context.gear.tip_roll - context.gear.form_roll)
        return [
            (max(shape[0] - step, context.gear.form_roll + 0.5 * step), min(shape[0] + step, context.gear.tip_roll - 0.5 * step))
        ]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(0.0 <= amplitudes[0] < 0.5)

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        std = math.sqrt(max(float(covariance[0, 0]), 0.0))
        return {
            "amount_um": Estimate(1e3 * float(amplitudes[0]), 1e3 * std, "um"),
            "start_mm": Estimate(shape[0], math.nan, "mm"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        tip = context.gear.tip_roll
        share = np.maximum((np.nan_to_num(points.roll) - shape[0]) / (tip - shape[0]), 0.0)
        return np.where(on_flank(points), -share, 0.0)[:, None]


EFFECT = TipRelief()

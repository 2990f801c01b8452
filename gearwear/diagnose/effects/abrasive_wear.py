"""Abrasive wear: the same loss all over the flanks of one side."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, on_flank


@dataclass(frozen=True)
class AbrasiveWear:
    """δ = −d on all flanks of one side.

    Notes
    -----
    A rotation of thinner teeth looks the same on flanks; fillets that did not wear tell.
    """

    name: ClassVar[str] = "abrasive_wear"
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "reference D3, D4; ISO 10825"
    group: ClassVar[str] = "G3"
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = ("depth_um",)

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [(1.0,), (-1.0,)]  # all left flanks, all right flanks

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return amplitudes[0] >= 0.0

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        return {"depth_um": Estimate(1e3 * float(amplitudes[0]), 1e3 * math.sqrt(max(float(covariance[0, 0]), 0.0)), "um")}

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(on_flank(points) & (points.side == shape[0]), -1.0, 0.0)[:, None]


EFFECT = AbrasiveWear()

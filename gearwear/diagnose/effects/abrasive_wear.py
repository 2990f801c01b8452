"""Abrasive wear: the same loss all over the flanks of one side."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, on_flank


@dataclass(frozen=True)
class AbrasiveWear(CatalogueEffect):
    """δ = −d on all flanks of one side, d ≥ 0; the side is the shape value (+1 left, −1 right).

    Notes
    -----
    A rotation of thinner teeth looks the same on flanks; fillets that did not wear tell.
    """

    name: ClassVar[str] = "abrasive_wear"
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "uniform part B of the fit family A w abs(K) + B; term: ISO 10825:1995, 1.1.2"
    tells_apart: ClassVar[str] = (
        "Scan the fillets or a datum fixed to the part (keyway, bore): worn flanks have moved against them, a turned gear has not."
    )
    group: ClassVar[str] = "G3"
    parameters: ClassVar[tuple[str, ...]] = ("depth_um",)
    lower: ClassVar[float] = 0.0
    upper: ClassVar[float] = math.inf

    def shapes(self, context: Context) -> list[Shape]:
        return [(1.0,), (-1.0,)]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return 0.0 <= float(amplitudes[0]) < context.gear.tooth_thickness

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(on_flank(points) & (points.side == shape[0]), -1.0, 0.0)[:, None]


EFFECT = AbrasiveWear()

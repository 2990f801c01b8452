"""Tip diameter: the blank was turned larger or smaller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import TIP, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape


@dataclass(frozen=True)
class TipDiameter(CatalogueEffect):
    """δ = ½ d on tip lands only, d the difference in diameter, + larger."""

    name: ClassVar[str] = "tip_diameter"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771:2007, 4.5.3, tip diameter"
    tells_apart: ClassVar[str] = "Measure the tip diameter with a micrometer."
    parameters: ClassVar[tuple[str, ...]] = ("diameter_um",)
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return TIP in context.surfaces

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(points.surface == TIP, 0.5, 0.0)[:, None]


EFFECT = TipDiameter()

"""Tip diameter: the blank was turned larger or smaller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import TIP, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class TipDiameter(CatalogueEffect):
    """δ = ½ ι d on tip lands only, d the difference in diameter, + larger."""

    name: ClassVar[str] = "tip_diameter"
    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "ISO 21771:2007, 4.5.3, tip diameter"
    tells_apart: ClassVar[str] = "Measure the tip diameter with a micrometer."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("diameter_um"),)
    phrase: ClassVar[str] = "a tip diameter {diameter_um} too large"
    phrase_below: ClassVar[str] = "a tip diameter {diameter_um} too small"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return TIP in context.surfaces

    def tolerance(self, context: Context) -> float | None:
        return context.gear.tolerance.tip_diameter

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(points.surface == TIP, 0.5 * context.gear.orientation, 0.0)[:, None]


EFFECT = TipDiameter()

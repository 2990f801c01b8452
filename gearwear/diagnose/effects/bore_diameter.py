"""Bore diameter: the bore is wider or narrower than drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class BoreDiameter(CatalogueEffect):
    """δ = −½ ι d in the bore only, or on the outside of a ring; d the difference in diameter, + wider."""

    name: ClassVar[str] = "bore_diameter"
    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "cylinder moved along its normals; ISO 286-1 for its usual tolerance"
    tells_apart: ClassVar[str] = "Measure the bore with a plug gauge."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("diameter_um"),)
    phrase: ClassVar[str] = "a bore {diameter_um} wider than drawn"
    phrase_below: ClassVar[str] = "a bore {diameter_um} narrower than drawn"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return BORE in context.surfaces

    def tolerance(self, context: Context) -> float | None:
        return context.gear.tolerance.bore_diameter

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(points.surface == BORE, -0.5 * context.gear.orientation, 0.0)[:, None]


EFFECT = BoreDiameter()

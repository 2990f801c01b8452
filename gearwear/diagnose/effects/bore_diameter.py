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
class BodyDiameter(CatalogueEffect):
    """δ = −½ ι d where the body ends away from the teeth: in the bore, on the outside of a ring; d the difference in diameter, + wider."""

    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "cylinder moved along its normals; ISO 286-1 for its usual tolerance"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("diameter_um"),)
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return BORE in context.surfaces

    def tolerance(self, context: Context) -> float | None:
        return context.gear.tolerance.bore_diameter

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(points.surface == BORE, -0.5 * context.gear.orientation, 0.0)[:, None]


@dataclass(frozen=True)
class BoreDiameter(BodyDiameter):
    """δ = −½ d in the bore only; d the difference in diameter, + wider."""

    name: ClassVar[str] = "bore_diameter"
    tells_apart: ClassVar[str] = "Measure the bore with a plug gauge."
    phrase: ClassVar[str] = "a bore {diameter_um} wider than drawn"
    phrase_below: ClassVar[str] = "a bore {diameter_um} narrower than drawn"

    def applies(self, context: Context) -> bool:
        return context.gear.orientation > 0 and super().applies(context)


EFFECT = BoreDiameter()

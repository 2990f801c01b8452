"""Face width: both ends stand off the drawing's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class FaceWidth(CatalogueEffect):
    """δ = ½ w on both end faces, w the difference in width, + wider; where one end only was seen it is that end's place, and not told."""

    name: ClassVar[str] = "face_width"
    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "ISO 21771:2007, face width b; ends moved along their normals"
    tells_apart: ClassVar[str] = (
        "Measure the face width with a micrometer: a scanner's scale along the axis looks the same in the scan."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("width_um"),)
    phrase: ClassVar[str] = "a face {width_um} wider than drawn"
    phrase_below: ClassVar[str] = "a face {width_um} narrower than drawn"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return context.surfaces >= {END_LOW, END_HIGH}

    def tolerance(self, context: Context) -> float | None:
        return context.gear.tolerance.face_width

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(np.isin(points.surface, (END_LOW, END_HIGH)), 0.5, 0.0)[:, None]


EFFECT = FaceWidth()

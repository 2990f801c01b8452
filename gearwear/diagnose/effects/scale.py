"""Isotropic scale: the scanner shows everything larger by the same ratio, or the part is warm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter

SCALE = "scale"


@dataclass(frozen=True)
class Scale(CatalogueEffect):
    """Scan = (1 + e) · part: δ = e (P · n).

    Notes
    -----
    On flanks P · n = L: a profile slope and a thicker tooth together; tip, root and face width tell. Thermal growth is the same thing, e =
    11.5 ppm a kelvin for steel: 10 K is 115 ppm.
    """

    name: ClassVar[str] = SCALE
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "similarity: displacement e P dotted with the normal; thermal expansion of steel 11.5 ppm/K"
    tells_apart: ClassVar[str] = (
        "Scan a gauge of known length with the part; a record of the part's temperature tells thermal growth "
        "(11.5 ppm a kelvin for steel) from the scanner's scale."
    )
    group: ClassVar[str] = "G2"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("relative_ppm"),)
    phrase: ClassVar[str] = "a scan that is {relative_ppm} too large"
    phrase_below: ClassVar[str] = "a scan that is {relative_ppm} too small"

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return abs(float(amplitudes[0])) <= context.scale_limit

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((points.position * points.normal).sum(axis=1)[:, None])

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        return np.asarray(amplitudes[0] * position)


EFFECT = Scale()

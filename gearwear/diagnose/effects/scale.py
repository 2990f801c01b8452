"""Isotropic scale: the scanner shows everything larger by the same ratio (or the part is warm)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape


@dataclass(frozen=True)
class Scale(LinearEffect):
    """Scan = (1 + e) · part: δ = e (P · n).

    Notes
    -----
    On flanks P · n = L: a profile slope and a thicker tooth; tip, root and face width tell. Thermal growth (11.5 ppm a kelvin for
    steel) is the same thing: a record of temperature tells.
    """

    name: ClassVar[str] = "scale"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: isotropic scale"
    group: ClassVar[str] = "G2"
    parameters: ClassVar[tuple[str, ...]] = ("relative_ppm",)
    unit: ClassVar[str] = "ppm"
    per_unit: ClassVar[float] = 1e6
    lower: ClassVar[float] = -0.05
    upper: ClassVar[float] = 0.05

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((points.position * points.normal).sum(axis=1)[:, None])


EFFECT = Scale()

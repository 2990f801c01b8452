"""Scale along the axis: a z drive or a step that is too long."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape


@dataclass(frozen=True)
class HeightScale(LinearEffect):
    """z measured = (1 + e) z: δ = e z n_z, seen by end faces only.

    Notes
    -----
    A face width off its drawing looks the same; chamfers or a gauge tell.
    """

    name: ClassVar[str] = "height_scale"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: z scale, z step error"
    parameters: ClassVar[tuple[str, ...]] = ("relative_ppm",)
    unit: ClassVar[str] = "ppm"
    per_unit: ClassVar[float] = 1e6
    lower: ClassVar[float] = -0.05
    upper: ClassVar[float] = 0.05

    def applies(self, context: Context) -> bool:
        return {END_LOW, END_HIGH} <= context.surfaces

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((points.position[:, 2] * points.normal[:, 2])[:, None])


EFFECT = HeightScale()

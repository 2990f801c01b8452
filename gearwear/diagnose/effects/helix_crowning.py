"""Helix crowning: the flank bulges at mid-face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, face_coordinate, on_flank


@dataclass(frozen=True)
class HelixCrowning(LinearEffect):
    """δ = −c (2ζ)²: nothing at mid-face, −c at the two ends; + is a bulge."""

    name: ClassVar[str] = "helix_crowning"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771 modifications; ISO 1328-1:2013"
    group: ClassVar[str] = "G7"
    parameters: ClassVar[tuple[str, ...]] = ("crowning_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def applies(self, context: Context) -> bool:
        return not context.planar

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.where(on_flank(points), -((2.0 * face_coordinate(points, context.gear)) ** 2), 0.0)[:, None]


EFFECT = HelixCrowning()

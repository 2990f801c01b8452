"""Taper: the teeth grow thicker along the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, face_coordinate, on_flank, on_side, turning


@dataclass(frozen=True)
class Taper(LinearEffect):
    """δ = f ζ on both flanks."""

    name: ClassVar[str] = "taper"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "reference E: taper (s-even part of the helix slope)"
    parameters: ClassVar[tuple[str, ...]] = ("taper_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]  # the tool that made the flank made the fillet too, or it did not (ground flanks)

    def applies(self, context: Context) -> bool:
        return not context.planar

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        moved = on_side(points) if shape[0] else on_flank(points)
        turn = points.side * turning(points) / context.gear.base_radius * face_coordinate(points, context.gear)
        return np.where(moved, turn, 0.0)[:, None]


EFFECT = Taper()

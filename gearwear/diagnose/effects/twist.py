"""Twist: the profile slope changes along the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, face_coordinate, profile_coordinate


@dataclass(frozen=True)
class Twist(LinearEffect):
    """δ = ½ f u ζ on both flanks."""

    name: ClassVar[str] = "twist"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771 modifications: flank twist"
    parameters: ClassVar[tuple[str, ...]] = ("twist_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def applies(self, context: Context) -> bool:
        return not context.planar

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        u = profile_coordinate(points, context.gear)
        return (0.5 * u * face_coordinate(points, context.gear))[:, None]


EFFECT = Twist()

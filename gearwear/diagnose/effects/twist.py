"""Twist: the profile slope changes along the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import (
    CatalogueEffect,
    Context,
    Kind,
    Shape,
    face_coordinate,
    of_transverse,
    profile_coordinate,
)
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class Twist(CatalogueEffect):
    """δ = ½ f u ζ on both flanks: f is the profile slope at the upper end less that at the lower."""

    name: ClassVar[str] = "twist"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition of flank twist"
    tells_apart: ClassVar[str] = (
        "Measure the profile at both ends of the face on a gear tester: nothing else makes its slope differ there on all teeth alike."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("twist_um"),)
    phrase: ClassVar[str] = "flanks twisted by {twist_um}"

    def applies(self, context: Context) -> bool:
        return not context.planar and context.gear.spec.gap == 0.0  # the halves of a double helical gear are cut one by one

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        u = profile_coordinate(points, context.gear)
        return of_transverse(0.5 * u * face_coordinate(points, context.gear), context.gear)[:, None]


EFFECT = Twist()

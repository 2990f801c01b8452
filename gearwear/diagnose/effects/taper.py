"""Taper: the teeth grow thicker along the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, face_coordinate, side_cut
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class Taper(CatalogueEffect):
    """δ = f ζ on both flanks, + thicker towards the upper end. Fillets follow their flanks, or do not: both are tried."""

    name: ClassVar[str] = "taper"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "the part of the helix slope deviations (ISO 1328-1:2013) that is equal on both flanks"
    tells_apart: ClassVar[str] = (
        "Measure the span near both end faces: a taper shows as their difference, and turns over with the part."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("taper_um"),)
    phrase: ClassVar[str] = "teeth that taper by {taper_um} along the face"

    def applies(self, context: Context) -> bool:
        return not context.planar and context.gear.spec.gap == 0.0  # the halves of a double helical gear are cut one by one

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        cut = points.side * side_cut(points, context.gear, shape[0])
        return (cut * face_coordinate(points, context.gear))[:, None]


EFFECT = Taper()

"""Tooth thickness: both flanks of every tooth stand out, or in, by the same turn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, side_cut


@dataclass(frozen=True)
class ToothThickness(CatalogueEffect):
    """Arc s at the reference circle, + thicker: each side turns by s / (2 r), on flanks δ = ½ s cos α.

    Notes
    -----
    Tips and roots stay. Whether the fillets turn too depends on the tool: both are tried. Cutting deeper or shallower instead moves the root and
    is a `profile_shift`.
    """

    name: ClassVar[str] = "tooth_thickness"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771:2007, 7.3, tooth thickness allowance"
    tells_apart: ClassVar[str] = (
        "Measure over pins or across a span: the gauge sees neither a coat of spray nor a scanner's error."
    )
    group: ClassVar[str] = "G1"
    parameters: ClassVar[tuple[str, ...]] = ("thickness_um",)

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return abs(float(amplitudes[0])) < 0.5 * context.gear.tooth_thickness

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        half = 0.5 * math.cos(context.gear.transverse_pressure_angle)
        return (half * points.side * side_cut(points, context.gear, shape[0]))[:, None]


EFFECT = ToothThickness()

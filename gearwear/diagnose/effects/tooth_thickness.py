"""Tooth thickness: both flanks of every tooth stand out, or in, by the same turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, on_flank, on_side, turning


@dataclass(frozen=True)
class ToothThickness(LinearEffect):
    """Arc s at the reference circle, + thicker: each side turns by s / (2 r), on flanks δ = ½ s cos α.

    Notes
    -----
    Tips and roots stay. Whether the fillets turn too depends on the process; both are tried.
    """

    name: ClassVar[str] = "tooth_thickness"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771:2007, tooth thickness allowance"
    group: ClassVar[str] = "G1"
    parameters: ClassVar[tuple[str, ...]] = ("thickness_um",)
    lower: ClassVar[float] = -1.0
    upper: ClassVar[float] = 1.0

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]  # the tool that made the flank made the fillet too, or it did not (ground flanks)

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        moved = on_side(points) if shape[0] else on_flank(points)
        turn = points.side * turning(points) / (2.0 * context.gear.reference_radius)
        return np.where(moved, turn, 0.0)[:, None]


EFFECT = ToothThickness()

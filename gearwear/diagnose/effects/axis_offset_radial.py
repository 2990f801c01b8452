"""Radial axis offset: the laser's zero lies off the table's axis, along the line of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, radial


@dataclass(frozen=True)
class AxisOffsetRadial(LinearEffect):
    """Every radius grows by d: δ = d (n · e_r), on flanks d L / r, on tips and roots d.

    Notes
    -----
    A radial beam and a table axis on the gear's axis are assumed. On flanks a thickness and a scale explain 99.9 % of it;
    tip : pitch : root go as 1 : 0.34 : 1.
    """

    name: ClassVar[str] = "axis_offset_radial"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: radial axis offset"
    group: ClassVar[str] = "G2"
    parameters: ClassVar[tuple[str, ...]] = ("offset_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return radial(points)[:, None]


EFFECT = AxisOffsetRadial()

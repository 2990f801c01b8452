"""Lateral axis offset: the laser's zero lies off the table's axis, across the line of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, turning


@dataclass(frozen=True)
class AxisOffsetLateral(LinearEffect):
    """θ grows by h / r: δ = h (n · e_θ), on flanks s h cos α_r, nothing radial.

    Notes
    -----
    99.6 % of it on flanks is a rotation, which the pose owns; what is left grows from root to tip with opposite sign on the two
    sides.
    """

    name: ClassVar[str] = "axis_offset_lateral"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: lateral axis offset"
    group: ClassVar[str] = "G3"
    parameters: ClassVar[tuple[str, ...]] = ("offset_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((turning(points) / np.hypot(points.position[:, 0], points.position[:, 1]))[:, None])


EFFECT = AxisOffsetLateral()

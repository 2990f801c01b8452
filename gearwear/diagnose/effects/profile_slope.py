"""Profile slope: the flank rises or falls in a straight line from root to tip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, profile_coordinate


@dataclass(frozen=True)
class ProfileSlope(LinearEffect):
    """δ = ½ f u on left and right flanks, each with its own f; u runs from −1 at the form circle to +1 at the tip.

    Notes
    -----
    + is more metal at the tip. A pressure angle error of −f / (L_α tan α) is the same thing.
    """

    name: ClassVar[str] = "profile_slope"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 1328-1:2013, profile slope deviation f_Hα"
    group: ClassVar[str] = "G2"
    parameters: ClassVar[tuple[str, ...]] = (
        "left_um",
        "right_um",
    )
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        u = 0.5 * profile_coordinate(points, context.gear)
        return np.column_stack([np.where(points.side > 0, u, 0.0), np.where(points.side < 0, u, 0.0)])


EFFECT = ProfileSlope()

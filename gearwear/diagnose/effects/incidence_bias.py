"""Incidence bias: the range is wrong by more the more slanting the surface is to the beam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, radial


@dataclass(frozen=True)
class IncidenceBias(LinearEffect):
    """δ = b (1 − |n · e_r|) on the tooth surfaces, for a radial beam: tips and roots read true.

    Notes
    -----
    On flanks a slope and an offset. Views from other directions separate it.
    """

    name: ClassVar[str] = "incidence_bias"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: incidence bias"
    group: ClassVar[str] = "G7"
    parameters: ClassVar[tuple[str, ...]] = ("bias_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        end = (points.surface == END_LOW) | (points.surface == END_HIGH)
        return np.where(end, 0.0, 1.0 - np.abs(radial(points)))[:, None]


EFFECT = IncidenceBias()

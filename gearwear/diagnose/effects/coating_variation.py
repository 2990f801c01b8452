"""A coat that varies round the gear: sprayed from one side, it is thicker there than across."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect, polar_angle
from gearwear.diagnose.parameter import Parameter, angular


@dataclass(frozen=True)
class CoatingVariation(WaveEffect):
    """A coat thicker by a than in the mean in one direction from the design's +x, and thinner by as much across: δ = a cos(θ − θ₀) on all surfaces.

    Notes
    -----
    The mean is a `coating`. Teeth are thicker on one side of the gear, and tips, roots and ends stand higher there; a translation, which the
    pose takes, moves the tips so but no two flanks of a tooth apart.
    """

    name: ClassVar[str] = "coating_variation"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "offset of a surface along its normal, first harmonic round the gear"
    tells_apart: ClassVar[str] = (
        "Wipe the coat off, spray it anew from another side and scan again: teeth keep their thickness, a coat does not."
    )
    group: ClassVar[str] = "G1"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amplitude_um", signed=False), angular("direction_deg"))
    most: ClassVar[float] = 0.15
    turns: ClassVar[float] = -1.0
    phrase: ClassVar[str] = "a coat {amplitude_um} thicker towards {direction_deg} than in the mean"

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        angle = polar_angle(points)
        return np.column_stack([np.cos(angle), np.sin(angle)])


EFFECT = CoatingVariation()

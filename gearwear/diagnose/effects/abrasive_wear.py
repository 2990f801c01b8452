"""Abrasive wear: the same loss all over the flanks of one side."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, on_sides
from gearwear.diagnose.effects.worn_depth import WornDepth
from gearwear.diagnose.parameter import Parameter

ABRASIVE_WEAR = "abrasive_wear"


@dataclass(frozen=True)
class AbrasiveWear(WornDepth):
    """δ = −d on all flanks of one side, d ≥ 0; the side is the shape value (+1 left, −1 right; 0 both, each by an
    amount of its own).

    Notes
    -----
    A rotation of thinner teeth looks the same on flanks; fillets that did not wear tell.
    """

    name: ClassVar[str] = ABRASIVE_WEAR
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "uniform part B of the fit family A w abs(K) + B; term: ISO 10825:1995, 1.1.2"
    tells_apart: ClassVar[str] = (
        "Scan the fillets or a datum fixed to the part (keyway, bore): worn flanks have moved against them, a turned gear has not."
    )
    group: ClassVar[str] = "G3"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("depth_um", signed=False),)
    phrase: ClassVar[str] = "even wear of {depth_um}"
    lower: ClassVar[float] = 0.0
    upper: ClassVar[float] = math.inf

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return on_sides(points, np.full(len(points), -1.0), shape[0])


EFFECT = AbrasiveWear()

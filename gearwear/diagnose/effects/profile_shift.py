"""Profile shift: the tool stood further out or in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FILLET, ROOT, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, on_flank, radial


@dataclass(frozen=True)
class ProfileShift(LinearEffect):
    """The rack is displaced by x radially: δ = x sin α on flanks, x on roots, x cos φ on fillets, nothing on tips.

    Notes
    -----
    Tips are turned before cutting and stay. Flank : root goes as 0.34 : 1, against 1 : 1 for a coat.
    """

    name: ClassVar[str] = "profile_shift"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771:2007, profile shift"
    group: ClassVar[str] = "G1"
    parameters: ClassVar[tuple[str, ...]] = ("shift_um",)
    lower: ClassVar[float] = -1.0
    upper: ClassVar[float] = 1.0

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        sine = math.sin(context.gear.transverse_pressure_angle)
        root = (points.surface == FILLET) | (points.surface == ROOT)
        return np.where(on_flank(points), sine, np.where(root, np.abs(radial(points)), 0.0))[:, None]


EFFECT = ProfileShift()

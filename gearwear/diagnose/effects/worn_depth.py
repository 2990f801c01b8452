"""Wear of the flanks of one side, or of both: what its depths may be, and which sides are tried."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Shape


class WornDepth(CatalogueEffect):
    """A depth ≥ 0 on each side that is worn; the side is the shape value (+1 left, −1 right; 0 both, each by an amount of its own)."""

    def shapes(self, context: Context) -> list[Shape]:
        return [(1.0,), (-1.0,), (0.0,)]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(np.all((amplitudes >= 0.0) & (amplitudes < context.gear.tooth_thickness)))

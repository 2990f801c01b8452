"""Spray coat: every surface moves out by the same thickness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape


@dataclass(frozen=True)
class Coating(LinearEffect):
    """A coat of even thickness t on all surfaces: δ = t.

    Notes
    -----
    On flanks alone it is a thicker tooth (``s = 2 t / cos α``); tips, roots and ends, which a thicker tooth does not move,
    tell them apart.
    """

    name: ClassVar[str] = "coating"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "offset of a surface along its normal; sizes: Materials 2023, 16(18):6165"
    group: ClassVar[str] = "G1"
    parameters: ClassVar[tuple[str, ...]] = ("thickness_um",)
    lower: ClassVar[float] = 0.0
    upper: ClassVar[float] = 0.5

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.ones((len(points), 1))


EFFECT = Coating()

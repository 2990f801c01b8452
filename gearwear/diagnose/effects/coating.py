"""Spray coat: every surface moves out by the same thickness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class Coating(CatalogueEffect):
    """A coat of even thickness t on all surfaces: δ = t, in the bore too (its radius shrinks).

    Notes
    -----
    On flanks alone it is a thicker tooth, ``s = 2 t / cos α``; tips, roots and ends, which a thicker tooth does not move, tell
    them apart.
    """

    name: ClassVar[str] = "coating"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "offset of a surface along its normal; sizes: Materials 2023, 16(18):6165"
    tells_apart: ClassVar[str] = "Wipe the coat off and scan again, or measure over pins: the gauge does not see the spray."
    group: ClassVar[str] = "G1"
    usual: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("thickness_um", signed=False),)
    phrase: ClassVar[str] = "a coat {thickness_um} thick on every surface"
    lower: ClassVar[float] = 0.0
    upper: ClassVar[float] = 0.15

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.ones((len(points), 1))


EFFECT = Coating()

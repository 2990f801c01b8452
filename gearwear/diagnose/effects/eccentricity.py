"""Eccentricity: the teeth run out against the bore."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, ROOT, TIP, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect
from gearwear.diagnose.parameter import Parameter, angular

TRUE_TIPS = 0.0
"""Shape value: how far tips run out of what the teeth do; none is the toothing with its tips."""


@dataclass(frozen=True)
class Eccentricity(WaveEffect):
    """The toothing's axis lies e off the bore's, in the given direction from the design's +x: δ = n · e on the teeth, 0 in the bore. Tips run out with the
    teeth where the blank did; they run true where the teeth were cut off its axis.

    Notes
    -----
    Without bore and tips that run true it is part of the pose and not named. Runout F_r is 2 e.
    """

    name: ClassVar[str] = "eccentricity"
    kind: ClassVar[Kind] = Kind.MOUNTING
    source: ClassVar[str] = "translation of the teeth against the bore; runout: AGMA 93FTM6"
    tells_apart: ClassVar[str] = (
        "Put the gear on a mandrel and measure the runout of teeth and bore: a bore that the scan located badly shows none there."
    )
    group: ClassVar[str] = "G4"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amplitude_um", signed=False), angular("direction_deg"))
    turns: ClassVar[float] = -1.0
    phrase: ClassVar[str] = "teeth whose axis lies {amplitude_um} off the blank's towards {direction_deg}"

    def applies(self, context: Context) -> bool:
        return BORE in context.surfaces

    def shapes(self, context: Context) -> list[Shape]:
        return [(), (TRUE_TIPS,)] if TIP in context.surfaces else [()]

    def largest(self, context: Context) -> float:
        return 0.5 * context.gear.transverse_module

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        last = ROOT if shape else TIP
        return np.where((points.surface <= last)[:, None], points.normal[:, :2], 0.0)


EFFECT = Eccentricity()

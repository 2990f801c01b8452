"""Eccentricity: the teeth run out against the bore."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, TIP, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect
from gearwear.diagnose.parameter import Parameter, angular


@dataclass(frozen=True)
class Eccentricity(WaveEffect):
    """The toothing's axis lies e off the bore's, in the given direction from the design's +x: δ = n · e on the teeth, 0 in the bore.

    Notes
    -----
    Without a bore in the design and in the scan it is part of the pose and not named. Runout F_r is 2 e.
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
    phrase: ClassVar[str] = "a gear mounted {amplitude_um} off its axis towards {direction_deg}"

    def applies(self, context: Context) -> bool:
        return BORE in context.surfaces

    def largest(self, context: Context) -> float:
        return 0.5 * context.gear.transverse_module

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        teeth = (points.surface <= TIP)[:, None]
        return np.where(teeth, points.normal[:, :2], 0.0)


EFFECT = Eccentricity()

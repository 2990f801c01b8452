"""Eccentricity: the teeth run out against the bore."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, TIP, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Estimate, Kind, Shape, in_units, polar_estimate


@dataclass(frozen=True)
class Eccentricity(CatalogueEffect):
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
    parameters: ClassVar[tuple[str, ...]] = ("amplitude_um", "direction_deg")

    def applies(self, context: Context) -> bool:
        return BORE in context.surfaces

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < 0.5 * context.gear.transverse_module

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        return {
            "amplitude_um": in_units("amplitude_um", size, size_std),
            "direction_deg": in_units("direction_deg", -phase % (2.0 * math.pi), phase_std),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        teeth = (points.surface <= TIP)[:, None]
        return np.where(teeth, points.normal[:, :2], 0.0)


EFFECT = Eccentricity()

"""Eccentricity: the teeth run out against the bore."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, TIP, SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, polar_estimate


@dataclass(frozen=True)
class Eccentricity:
    """The toothing's axis lies (e_x, e_y) off the bore's: δ = n · e on the teeth, nothing in the bore.

    Notes
    -----
    Without a bore in the design and in the scan it is part of the pose and not named.
    """

    name: ClassVar[str] = "eccentricity"
    kind: ClassVar[Kind] = Kind.MOUNTING
    source: ClassVar[str] = "reference E: translation (e_x, e_y); AGMA 93FTM6 on runout"
    group: ClassVar[str] = "G4"
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "amplitude_um",
        "direction_deg",
    )

    def applies(self, context: Context) -> bool:
        return BORE in context.surfaces

    def shapes(self, context: Context) -> list[Shape]:
        return [()]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return True

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        return {
            "amplitude_um": Estimate(1e3 * size, 1e3 * size_std, "um"),
            "direction_deg": Estimate(math.degrees(-phase) % 360.0, math.degrees(phase_std), "deg"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        teeth = (points.surface <= TIP)[:, None]
        return np.where(teeth, points.normal[:, :2], 0.0)


EFFECT = Eccentricity()

"""Edge rounding: the laser spot averages across an edge."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FLANK, TIP, SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, polar_angle


@dataclass(frozen=True)
class EdgeRounding:
    """δ = −a (1 − 2 x / w)² within half a spot width w of the tip corners and the face edges, x the distance from the edge.

    Notes
    -----
    All edges alike, both sides; a tip relief is on flanks only and spares tip lands and face edges.
    """

    name: ClassVar[str] = "edge_rounding"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: edge rounding; horizon effect: Sensors 2024, 24(8):2410"
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "amount_um",
        "width_mm",
    )

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        m = context.gear.transverse_module
        return [(0.1 * m,), (0.2 * m,), (0.4 * m,)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return [(0.6 * shape[0], 1.6 * shape[0])]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(0.0 <= amplitudes[0] < 0.5)

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        std = math.sqrt(max(float(covariance[0, 0]), 0.0))
        return {
            "amount_um": Estimate(1e3 * float(amplitudes[0]), 1e3 * std, "um"),
            "width_mm": Estimate(shape[0], math.nan, "mm"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        flank, tip = points.surface == FLANK, points.surface == TIP
        along = np.where(flank, (gear.tip_roll**2 - np.nan_to_num(points.roll) ** 2) / (2.0 * gear.base_radius), np.inf)
        within = np.mod(polar_angle(points) + 0.5 * gear.pitch_angle, gear.pitch_angle) - 0.5 * gear.pitch_angle
        along = np.where(tip, gear.tip_radius * (gear.tip_half_angle - np.abs(within)), along)
        z = points.position[:, 2]
        teeth = points.surface <= TIP
        across = np.where(teeth & (not context.planar), np.minimum(z, gear.face_width - z), np.inf)
        near = np.maximum(1.0 - 2.0 * np.maximum(np.minimum(along, across), 0.0) / shape[0], 0.0)
        return -(near**2)[:, None]


EFFECT = EdgeRounding()

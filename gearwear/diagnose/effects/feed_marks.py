"""Feed marks: a wave along the face from the axial feed of the tool."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, on_flank, polar_estimate


@dataclass(frozen=True)
class FeedMarks:
    """δ = A cos(2π z / λ + φ) on flanks."""

    name: ClassVar[str] = "feed_marks"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771 / gear production texts: axial feed marks"
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "amplitude_um",
        "wavelength_mm",
        "phase_deg",
    )

    def applies(self, context: Context) -> bool:
        return not context.planar

    def shapes(self, context: Context) -> list[Shape]:
        b = context.gear.face_width
        shortest = 0.2 * context.gear.transverse_module  # 2.5 of the finest cells
        waves = np.arange(1.5, min(b / shortest, 16.0), 0.5)
        return [(float(b / wave),) for wave in waves]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        b = context.gear.face_width
        waves = b / shape[0]
        return [(b / (waves + 0.5), b / max(waves - 0.5, 1.0))]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < 0.2

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        return {
            "amplitude_um": Estimate(1e3 * size, 1e3 * size_std, "um"),
            "wavelength_mm": Estimate(shape[0], math.nan, "mm"),
            "phase_deg": Estimate(math.degrees(phase) % 360.0, math.degrees(phase_std), "deg"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        phase = 2.0 * np.pi * points.position[:, 2] / shape[0]
        return np.where(on_flank(points)[:, None], np.column_stack([np.cos(phase), np.sin(phase)]), 0.0)


EFFECT = FeedMarks()

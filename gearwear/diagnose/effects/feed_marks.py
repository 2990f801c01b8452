"""Feed marks: a wave along the face from the axial feed of the tool."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import (
    CatalogueEffect,
    Context,
    Estimate,
    Kind,
    Shape,
    deviations,
    in_units,
    polar_estimate,
    side_cut,
)


@dataclass(frozen=True)
class FeedMarks(CatalogueEffect):
    """δ = A cos(2π z / λ + φ) on flanks, z from the lower end; fillets follow by a share of it, refined from 0 to 1."""

    name: ClassVar[str] = "feed_marks"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; axial feed marks of hobbing and grinding"
    tells_apart: ClassVar[str] = (
        "Scan again with another step along z: marks of the tool keep their wavelength, marks of the scanner's slices change with the step."
    )
    averaged: ClassVar[str] = "z"
    parameters: ClassVar[tuple[str, ...]] = ("amplitude_um", "wavelength_mm", "phase_deg")

    def applies(self, context: Context) -> bool:
        return not context.planar

    def shapes(self, context: Context) -> list[Shape]:
        b = context.gear.face_width
        shortest = self._shortest(context)
        waves = np.arange(1.5, min(b / shortest, 16.0), 0.5)
        return [(float(b / wave), 0.0) for wave in waves]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        b = context.gear.face_width
        waves = b / shape[0]
        return [(max(b / (waves + 0.5), self._shortest(context)), b / max(waves - 0.5, 1.0)), (0.0, 1.0)]

    def _shortest(self, context: Context) -> float:
        """Three rows of cells: a shorter wave cannot be told from a longer one."""
        return max(0.2 * context.gear.transverse_module, 3.0 * context.row_height)

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < 0.2

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        return {
            "amplitude_um": in_units("amplitude_um", size, size_std),
            "wavelength_mm": in_units("wavelength_mm", shape[0], deviations(covariance, 3)[2]),
            "phase_deg": in_units("phase_deg", phase % (2.0 * math.pi), phase_std),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        phase = 2.0 * np.pi * points.position[:, 2] / shape[0]
        cut = points.side * side_cut(points, context.gear, shape[1])
        return np.asarray(cut[:, None] * np.column_stack([np.cos(phase), np.sin(phase)]))


EFFECT = FeedMarks()

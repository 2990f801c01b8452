"""Feed marks: a wave along the face from the axial feed of the tool."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect, side_cut
from gearwear.diagnose.parameter import Parameter, Role, angular

FEWEST_WAVES = 1.5
"""Over the face: fewer are a form of the flank and no marks."""


@dataclass(frozen=True)
class FeedMarks(WaveEffect):
    """δ = A cos(2π z / λ + φ) on flanks, z from the lower end; fillets follow by a share of it, refined from 0 to 1."""

    name: ClassVar[str] = "feed_marks"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; axial feed marks of hobbing and grinding"
    tells_apart: ClassVar[str] = (
        "Scan again with another step along z: marks of the tool keep their wavelength, marks of the scanner's slices change with the step."
    )
    averaged: ClassVar[str] = "z"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amplitude_um", signed=False),
        Parameter("wavelength_mm", Role.PLACE, signed=False),
        angular("phase_deg"),
    )
    most: ClassVar[float] = 0.2
    phrase: ClassVar[str] = "feed marks of {amplitude_um}, {wavelength_mm} apart along the face"

    def applies(self, context: Context) -> bool:
        return not context.planar and context.gear.spec.gap == 0.0  # the halves of a double helical gear are cut one by one

    def shapes(self, context: Context) -> list[Shape]:
        b = context.gear.face_width
        shortest = self._shortest(context)
        waves = np.arange(FEWEST_WAVES, min(b / shortest, 16.0), 0.5)
        return [(float(b / wave), 0.0) for wave in waves]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        b = context.gear.face_width
        waves = b / shape[0]
        return [(max(b / (waves + 0.5), self._shortest(context)), b / max(waves - 0.5, FEWEST_WAVES)), (0.0, 1.0)]

    def _shortest(self, context: Context) -> float:
        """Three rows of cells: a shorter wave cannot be told from a longer one."""
        return max(0.2 * context.gear.transverse_module, 3.0 * context.row_height)

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        phase = 2.0 * np.pi * points.position[:, 2] / shape[0]
        cut = points.side * side_cut(points, context.gear, shape[1])
        return np.asarray(cut[:, None] * np.column_stack([np.cos(phase), np.sin(phase)]))


EFFECT = FeedMarks()

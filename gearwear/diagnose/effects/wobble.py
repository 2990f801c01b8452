"""Wobble: the teeth stand askew on the end faces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, END_HIGH, END_LOW, TIP, SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, face_coordinate, polar_estimate


@dataclass(frozen=True)
class Wobble:
    """The toothing is tilted against its end faces by w about an axis square to the given direction.

    Notes
    -----
    The amplitude is the swing at either end of the face, w b / 2; the direction is where the upper end leans. Without end faces it is part
    of the pose and not named.
    """

    name: ClassVar[str] = "wobble"
    kind: ClassVar[Kind] = Kind.MOUNTING
    source: ClassVar[str] = "reference E: tilt"
    group: ClassVar[str] = "G6"
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "amplitude_um",
        "direction_deg",
    )

    def applies(self, context: Context) -> bool:
        return not context.planar and bool({END_LOW, END_HIGH} & context.surfaces)

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
        teeth = (points.surface <= TIP) | (points.surface == BORE)
        height = 2.0 * face_coordinate(points, context.gear)
        return np.where(teeth[:, None], height[:, None] * points.normal[:, :2], 0.0)


EFFECT = Wobble()

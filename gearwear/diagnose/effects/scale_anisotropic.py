"""Anisotropic scale in the plane of rotation: longer one way than across it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, polar_estimate


@dataclass(frozen=True)
class ScaleAnisotropic:
    """The scan is longer by the ratio e along a direction than across it; a shear is a rotation and this.

    Notes
    -----
    With ψ the direction in the design frame, δ = ½ e [cos 2ψ (x n_x − y n_y) + sin 2ψ (x n_y + y n_x)]. The reported direction is in
    the **scan's own axes**, 0 … 180°: it must stay there when the part is turned.
    """

    name: ClassVar[str] = "scale_anisotropic"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: anisotropic x, y; shear"
    group: ClassVar[str] = "G5"
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "difference_ppm",
        "direction_deg",
    )

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [()]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < 0.05

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        direction = -0.5 * phase  # of the pair (cos 2ψ, sin 2ψ), in the design frame
        own = context.scan_axes.T @ np.array([math.cos(direction), math.sin(direction), 0.0])
        return {
            "difference_ppm": Estimate(1e6 * size, 1e6 * size_std, "ppm"),
            "direction_deg": Estimate(math.degrees(math.atan2(own[1], own[0])) % 180.0, math.degrees(0.5 * phase_std), "deg"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        x, y = points.position[:, 0], points.position[:, 1]
        nx, ny = points.normal[:, 0], points.normal[:, 1]
        return 0.5 * np.column_stack([x * nx - y * ny, x * ny + y * nx])


EFFECT = ScaleAnisotropic()

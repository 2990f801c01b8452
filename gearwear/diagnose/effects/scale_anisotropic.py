"""Anisotropic scale in the plane of rotation: longer one way than across it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect
from gearwear.diagnose.parameter import Parameter, angular


@dataclass(frozen=True)
class ScaleAnisotropic(WaveEffect):
    """The scan is longer by the ratio e along a direction than across it; a shear is a rotation and this.

    Notes
    -----
    With ψ the direction in the design frame, δ = ½ e [cos 2ψ (x n_x − y n_y) + sin 2ψ (x n_y + y n_x)]: + e/2 along, − e/2 across; a
    mean that is not 0 is a `scale`. The reported direction is in the **scan's own axes**, 0 … 180°, from their x towards their y: a
    scanner's error stays there when the part is turned on the table.
    """

    name: ClassVar[str] = "scale_anisotropic"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "plane strain without change of area: symmetric, traceless part of the displacement's gradient"
    tells_apart: ClassVar[str] = (
        "Turn the part by 90° on the table and scan again: the scanner's error keeps its direction, an oval part turns with it."
    )
    group: ClassVar[str] = "G5"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("difference_ppm", signed=False), angular("direction_deg", 180.0))
    most: ClassVar[float] = 0.05
    turns: ClassVar[float] = -0.5
    phrase: ClassVar[str] = "a scan that is {difference_ppm} longer along {direction_deg} than across it"

    def direction(self, phase: float, context: Context) -> float:
        along = self.turns * phase  # the pair is e (cos 2ψ, sin 2ψ), ψ in the design frame
        own = context.scan_axes.T @ np.array([math.cos(along), math.sin(along), 0.0])
        return math.atan2(own[1], own[0])

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        x, y = points.position[:, 0], points.position[:, 1]
        nx, ny = points.normal[:, 0], points.normal[:, 1]
        return 0.5 * np.column_stack([x * nx - y * ny, x * ny + y * nx])

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        x, y, (a, b) = position[:, 0], position[:, 1], 0.5 * amplitudes
        return np.column_stack([a * x + b * y, b * x - a * y, np.zeros(len(x))])


EFFECT = ScaleAnisotropic()

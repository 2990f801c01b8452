"""View registration: one view of a merged scan sits beside the others."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, polar_angle


@dataclass(frozen=True)
class ViewRegistration:
    """The points of a sector of the revolution are shifted together: δ = n · (t_x, t_y) inside it.

    Notes
    -----
    Steps at both borders of the sector. The sector's start and width are searched on a grid of 30°.
    """

    name: ClassVar[str] = "view_registration"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: view registration (multi-view merge)"
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = (
        "shift_x_um",
        "shift_y_um",
        "start_deg",
        "width_deg",
    )

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [(math.radians(start), math.radians(width)) for width in (90, 120, 180) for start in range(0, 360, 30)]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < 1.0

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        return {
            "shift_x_um": Estimate(1e3 * float(amplitudes[0]), 1e3 * float(std[0]), "um"),
            "shift_y_um": Estimate(1e3 * float(amplitudes[1]), 1e3 * float(std[1]), "um"),
            "start_deg": Estimate(math.degrees(shape[0]), 30.0 / math.sqrt(12.0), "deg"),
            "width_deg": Estimate(math.degrees(shape[1]), 30.0 / math.sqrt(12.0), "deg"),
        }

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        inside = np.mod(polar_angle(points) - shape[0], 2.0 * np.pi) < shape[1]
        return np.where(inside[:, None], points.normal[:, :2], 0.0)


EFFECT = ViewRegistration()

"""View registration: one view of a merged scan sits beside the others."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, polar_angle, turning
from gearwear.diagnose.parameter import Parameter, Spread, angular

VIEW_REGISTRATION = "view_registration"
"""The effect that puts a view beside the others."""
STEP = math.radians(30.0)
"""Grid of starts."""


@dataclass(frozen=True)
class ViewRegistration(CatalogueEffect):
    """The points from one angle to another are moved together in the plane: δ = n · (t_x, t_y) + ω (r × n)_z between them.

    Notes
    -----
    Steps at both borders, which are the shape, the second counter-clockwise from the first. The rest of the gear is the pose's, so that a
    sector of more than half the revolution is its complement moved the other way. Shifts are along the design's axes, the turn is about the gear's; tilts and shifts along the axis, which
    only ends would show well, are left out.
    """

    name: ClassVar[str] = VIEW_REGISTRATION
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "own definition: rigid motion of one sector in the plane of rotation"
    tells_apart: ClassVar[str] = (
        "Register the views again on common targets, or scan with other view borders: a view out of place changes, a pitch error stays."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("shift_x_um"),
        Parameter("shift_y_um"),
        Parameter("turn_deg"),
        angular("start_deg", spread=Spread.JUMP),
        angular("end_deg", spread=Spread.JUMP),
    )
    phrase: ClassVar[str] = "a view {shift_x_um} in x and {shift_y_um} in y out of place"

    def applies(self, context: Context) -> bool:
        return context.stitched

    def shapes(self, context: Context) -> list[Shape]:
        return [(i * STEP, i * STEP + math.radians(width)) for width in (90, 150) for i in range(12)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return [(border - STEP, border + STEP) for border in shape]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes[:2]) < 1.0 and abs(float(amplitudes[2])) < math.radians(2.0)

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        inside = np.mod(polar_angle(points) - shape[0], 2.0 * np.pi) < shape[1] - shape[0]
        return np.where(inside[:, None], np.column_stack([points.normal[:, :2], turning(points)]), 0.0)


EFFECT = ViewRegistration()

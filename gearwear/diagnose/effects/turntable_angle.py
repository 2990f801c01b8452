"""Turntable angle error: the table is not where its encoder says, a wave round the revolution."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect, polar_angle, turned, turning
from gearwear.diagnose.parameter import Parameter, Role, Spread, angular


@dataclass(frozen=True)
class TurntableAngle(WaveEffect):
    """θ measured = θ + a cos(n θ + φ): δ = a (r × n)_z cos(n θ + φ), on flanks s r_b a cos(n θ + φ).

    Notes
    -----
    The order n is a shape value, so that orders above half the tooth number are not aliased: the many points of a tooth
    resolve them. Tips and roots stay where they are radially, which tells order 1 from a translation and order 2 from an
    anisotropic scale.
    """

    name: ClassVar[str] = "turntable_angle"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "rotation error of the scanner's table; Kumar, Jain, Pathak 2014 name its cause"
    tells_apart: ClassVar[str] = (
        "Turn the part on the table by a few teeth and scan again: the wave stays with the table, pitch errors turn with the part."
    )
    group: ClassVar[str] = "G4"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("order", Role.PLACE, signed=False, spread=Spread.NONE),
        Parameter("amplitude_deg", signed=False),
        angular("phase_deg"),
    )
    most: ClassVar[float] = math.radians(1.0)
    phrase: ClassVar[str] = "a turntable whose angle is off by {amplitude_deg}, {order} times a revolution"

    def applies(self, context: Context) -> bool:
        return context.turntable

    def shapes(self, context: Context) -> list[Shape]:
        # A whole number of waves per tooth is the same on every tooth: a thicker tooth or another profile, not the table.
        return [(float(order),) for order in range(1, 25) if order % context.gear.teeth]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        angle = shape[0] * polar_angle(points)
        return np.asarray(turning(points)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        angle = shape[0] * np.arctan2(position[:, 1], position[:, 0])
        return turned(position, amplitudes[0] * np.cos(angle) + amplitudes[1] * np.sin(angle))


EFFECT = TurntableAngle()

"""Turntable angle error: the table is not where its encoder says, a wave round the revolution."""

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
    in_units,
    polar_angle,
    polar_estimate,
    turned,
    turning,
)


@dataclass(frozen=True)
class TurntableAngle(CatalogueEffect):
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
    parameters: ClassVar[tuple[str, ...]] = ("order", "amplitude_deg", "phase_deg")

    def shapes(self, context: Context) -> list[Shape]:
        # A whole number of waves per tooth is the same on every tooth: a thicker tooth or another profile, not the table.
        return [(float(order),) for order in range(1, 25) if order % context.gear.teeth]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        angle = shape[0] * polar_angle(points)
        return np.asarray(turning(points)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return math.hypot(*amplitudes) < math.radians(1.0)

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        size, size_std, phase, phase_std = polar_estimate(amplitudes, covariance)
        return {
            "order": Estimate(shape[0], 0.0, "1"),
            "amplitude_deg": in_units("amplitude_deg", size, size_std),
            "phase_deg": in_units("phase_deg", phase % (2.0 * math.pi), phase_std),
        }

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        angle = shape[0] * np.arctan2(position[:, 1], position[:, 0])
        return turned(position, amplitudes[0] * np.cos(angle) + amplitudes[1] * np.sin(angle))


EFFECT = TurntableAngle()

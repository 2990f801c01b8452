"""Modified gears for tests, and their flanks written from the words of a drawing: nothing of the package but r_b, ψ_b and the flank's ends."""

import math
from dataclasses import replace

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.spec import GearSpec

PLAIN = GearSpec("gear", 25, 3.0, 20.0, profile_shift=0.1)
ALL = FlankModification(
    tip_relief=0.02, tip_relief_length=2.5, tip_relief_form="parabolic", root_relief=0.012, root_relief_length=2.0,
    profile_crowning=0.004, helix_crowning=0.01, profile_slope=0.006, helix_slope=-0.012, end_relief=0.015, end_relief_length=3.0,
)  # fmt: skip
OTHER = FlankModification(tip_relief=0.03, tip_relief_start=80.0, helix_slope=0.02)
HELICAL = replace(PLAIN, helix_angle=math.radians(-22.0))


def gear_with(left: FlankModification, right: FlankModification | None = None, spec: GearSpec = PLAIN) -> Gear:
    return Gear.from_spec(replace(spec, left=left, right=left if right is None else right))


def offset_by_hand(gear: Gear, side: int, roll: float, z: float) -> float:
    """δ₀ in mm with the amounts of `ALL` on the left and of `OTHER` on the right."""
    form, tip, b = gear.form_roll, gear.tip_roll, gear.face_width
    zeta, u = z / b - 0.5, (roll - form) / (tip - form) * 2.0 - 1.0
    if side > 0:
        offset = -0.02 * (max(roll - tip + 2.5, 0.0) / 2.5) ** 2 - 0.012 * max(form + 2.0 - roll, 0.0) / 2.0
        return (
            offset + 0.003 * u - 0.004 * u**2 - 0.01 * 4.0 * zeta**2 - 0.012 * zeta - 0.015 * max(1.0 - min(z, b - z) / 3.0, 0.0)
        )
    start = math.sqrt(40.0**2 - gear.base_radius**2)
    return -0.03 * max(roll - start, 0.0) / (tip - start) - 0.02 * zeta


def point_by_hand(gear: Gear, side: int, roll: float, z: float) -> np.ndarray:
    """The flank's point at a radius: the involute's at L − δ₀, moved by δ₀ along its base tangent; (2,) mm."""
    offset = offset_by_hand(gear, side, roll, z)
    tau = side * (gear.base_half_angle - (roll - offset) / gear.base_radius)
    tau += math.tan(gear.spec.helix_angle) / gear.reference_radius * (z - gear.face_width / 2.0)
    tangent = side * np.array([-math.sin(tau), math.cos(tau)])
    return gear.base_radius * np.array([math.cos(tau), math.sin(tau)]) + (roll - offset) * tangent + offset * tangent

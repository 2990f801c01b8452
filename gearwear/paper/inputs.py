"""What the paper starts from."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design import Gear, GearSpec

MODULE = 25.4 / 4
BASE_RADII = (0.5 * 12 * MODULE * math.cos(math.radians(20.0)), 0.5 * 24 * MODULE * math.cos(math.radians(20.0)))


@dataclass(frozen=True, slots=True)
class Inputs:
    """What the paper's formulas start from; mm, rad.

    Nominal dimensions are at full precision. What the paper found further up is taken as it prints it there: B′, B and the
    new centre distance. `pi` is the 3.14 of its formula.
    """

    module: float = MODULE
    teeth: tuple[int, int] = (12, 24)
    pressure_angle: float = math.radians(20.0)
    centre_distance: float = 114.3
    tip_radii: tuple[float, float] = (44.45, 82.55)
    base_radii: tuple[float, float] = BASE_RADII
    pi: float = 3.14
    thickness_loss: float = 1.992
    allowance: float = 0.2286
    backlash: float = 1.7634
    thicknesses: tuple[float, float] = (math.pi * MODULE / 2, math.pi * MODULE / 2)
    worn_centre_distance: float = 116.722
    worn_pressure_angle: float = math.acos(sum(BASE_RADII) / 116.722)
    contact_lengths: tuple[float, float] = (28.51, 21.92)
    point_a: tuple[float, float] = (-36.2, -18.2)
    point_b: tuple[float, float] = (-35.6, -20.1)
    slices: int = 65
    slice_step: float = 0.2
    points_per_tooth: int = 505
    points: int = 453645


PAPER = Inputs()


def gears(rack_tip_radius: float = 0.30) -> tuple[Gear, Gear]:
    """The paper's pinion and gear. It does not say what cut them; `rack_tip_radius` is in modules."""
    pinion, gear = (
        Gear.from_spec(GearSpec(name, teeth, MODULE, 15.0, rack_tip_radius=rack_tip_radius))
        for name, teeth in zip(("pinion", "gear"), PAPER.teeth, strict=True)
    )
    return pinion, gear

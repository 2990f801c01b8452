"""A spread of gears that the design room is tried on."""

from __future__ import annotations

import math

from gearwear.design import Gear, GearSpec


def _gear(teeth: int, module: float = 2.0, degrees: float = 20.0, **modules: float) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, module, 8.0 * module, math.radians(degrees), **modules))


SPREAD = {
    "paper_pinion_025": _gear(12, 6.35, rack_tip_radius=0.25),
    "paper_pinion_030": _gear(12, 6.35),
    "paper_pinion_038": _gear(12, 6.35, rack_tip_radius=0.38),
    "paper_wheel": _gear(24, 6.35, rack_tip_radius=0.25),
    "five_teeth_shifted": _gear(5, profile_shift=0.6, addendum=0.7),
    "eight_teeth_undercut": _gear(8),
    "arc_centre_on_the_pitch_line": _gear(30, profile_shift=0.95, addendum=0.8),
    "arc_centre_outside_the_pitch_line": _gear(40, profile_shift=1.2, addendum=0.7),
    "sharp_rack": _gear(16, rack_tip_radius=0.0),
    "old_14_5_degrees": _gear(16, degrees=14.5, dedendum=1.157, rack_tip_radius=0.2),
    "stub_25_degrees": _gear(14, degrees=25.0, addendum=0.8, dedendum=1.0, rack_tip_radius=0.2),
    "thinned": _gear(17, thinning=0.12),
    "thickened": _gear(17, thinning=-0.12, rack_tip_radius=0.2),
    "negative_shift": _gear(40, profile_shift=-0.5),
    "hundred_teeth": _gear(100, 0.5),
    "watch": _gear(21, 0.05),
    "mill": _gear(19, 25.0),
}

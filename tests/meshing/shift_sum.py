"""The sum of profile shifts by the standard's own formula, which reads the working pressure angle."""

from __future__ import annotations

import math

from gearwear.design.gear import Gear
from gearwear.design.involute import involute_function
from gearwear.meshing.backlash import working_pressure_angle


def profile_shift_sum(pinion: Gear, gear: Gear, centre_distance: float) -> float:
    """Σx in modules that leaves no backlash at this centre distance, whatever shifts the gears have.

    ``Σx = (z_1 + z_2) (inv α_wt − inv α_t) / (2 tan α_n)`` (ISO 21771:2007; z of a ring negative), for gears without thinning.
    """
    alpha, working = pinion.transverse_pressure_angle, working_pressure_angle(pinion, gear, centre_distance)
    return (
        (pinion.orientation * pinion.teeth + gear.orientation * gear.teeth)
        * (involute_function(working) - involute_function(alpha))
        / (2.0 * math.tan(pinion.normal_pressure_angle))
    )

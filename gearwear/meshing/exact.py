"""The exact involute relations of a pair in one result; what it is made of is in `backlash`, `path`, `clearance` and `shafts`.

Every function takes the two gears and a centre distance; profile shift, thinning and any distance are in.
"""

from __future__ import annotations

from dataclasses import dataclass

from gearwear.design.gear import Gear
from gearwear.meshing.backlash import (
    Backlash,
    BacklashKind,
    backlash,
    backlash_from_normal,
    centre_distance_for_backlash,
    normal_backlash,
    operating_pitch_radii,
    profile_shift_sum,
    working_pressure_angle,
    zero_backlash_centre_distance,
)
from gearwear.meshing.clearance import (
    Interference,
    bottoming_centre_distance,
    interference,
    interference_free_centre_distance,
    tip_clearances,
)
from gearwear.meshing.path import PathOfContact, Sliding, path_of_contact, radius_at_roll, sliding
from gearwear.meshing.shafts import ShaftMovement, shaft_movement

__all__ = [
    "Backlash",
    "BacklashKind",
    "ExactMeshing",
    "Interference",
    "PathOfContact",
    "ShaftMovement",
    "Sliding",
    "backlash",
    "backlash_from_normal",
    "bottoming_centre_distance",
    "centre_distance_for_backlash",
    "exact_meshing",
    "interference",
    "interference_free_centre_distance",
    "normal_backlash",
    "operating_pitch_radii",
    "path_of_contact",
    "profile_shift_sum",
    "radius_at_roll",
    "shaft_movement",
    "sliding",
    "tip_clearances",
    "working_pressure_angle",
    "zero_backlash_centre_distance",
]


@dataclass(frozen=True, slots=True)
class ExactMeshing:
    """A pair of ideal gears at one centre distance; mm and rad.

    Parameters
    ----------
    centre_distance, working_pressure_angle : float
        a_w and α_wt.
    pitch_radius_pinion, pitch_radius_gear : float
        Operating pitch radii r_w1, r_w2.
    backlash : Backlash
    path : PathOfContact
    tip_clearance_pinion, tip_clearance_gear : float
        Between this gear's tip and its mate's root circle.
    interference_pinion, interference_gear : Interference
        Of the mate's tip with this gear's root.
    """

    centre_distance: float
    working_pressure_angle: float
    pitch_radius_pinion: float
    pitch_radius_gear: float
    backlash: Backlash
    path: PathOfContact
    tip_clearance_pinion: float
    tip_clearance_gear: float
    interference_pinion: Interference
    interference_gear: Interference


def exact_meshing(pinion: Gear, gear: Gear, centre_distance: float) -> ExactMeshing:
    """Everything the involutes say about a pair.

    Parameters
    ----------
    pinion, gear : Gear
        The pair.
    centre_distance : float
        Working centre distance in mm.

    Returns
    -------
    ExactMeshing

    Raises
    ------
    InputError
        If the base pitches differ, the base circles meet or the gears do not reach each other.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.25))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> meshing = exact_meshing(pinion, gear, 116.722)
    >>> round(meshing.backlash.normal, 6), round(meshing.path.length, 3)
    (1.780441, 21.728)
    """
    pitch_pinion, pitch_gear = operating_pitch_radii(pinion, gear, centre_distance)
    clearance_pinion, clearance_gear = tip_clearances(pinion, gear, centre_distance)
    return ExactMeshing(
        centre_distance=centre_distance,
        working_pressure_angle=working_pressure_angle(pinion, gear, centre_distance),
        pitch_radius_pinion=pitch_pinion,
        pitch_radius_gear=pitch_gear,
        backlash=backlash(pinion, gear, centre_distance),
        path=path_of_contact(pinion, gear, centre_distance),
        tip_clearance_pinion=clearance_pinion,
        tip_clearance_gear=clearance_gear,
        interference_pinion=interference(pinion, gear, centre_distance),
        interference_gear=interference(gear, pinion, centre_distance),
    )

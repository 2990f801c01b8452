"""Room at tips and roots: tip clearance and interference, by theory and by the generated root."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.gear import Gear
from gearwear.design.pair import tip_penetration
from gearwear.design.twist import Toothing, refuse
from gearwear.meshing.backlash import sum_of_base_radii, working_pressure_angle

ROUNDING = 1e-9
"""mm; a corner that follows a flank exactly is not said to dig into it."""


@dataclass(frozen=True, slots=True)
class Interference:
    """How the tip of a gear's mate passes the gear's root; mm.

    Parameters
    ----------
    overrun : float
        Length of roll by which the mate's tip passes the interference point (where the line of action leaves this gear's
        base circle). Above 0: no involute can meet it there.
    largest_mate_tip_radius : float
        The mate's largest tip radius without overrun; of a ring that is the mate the least one, and of its pinion without meaning.
    below_form : float
        Length of roll by which the mate's tip reaches below this gear's form circle. Above 0: the path of contact ends at
        the form circle.
    penetration : float
        How deep the mate's tip corner digs into this gear's generated root with the drive flanks touching, mm of arc; 0 when
        it clears.
    """

    overrun: float
    largest_mate_tip_radius: float
    below_form: float
    penetration: float


def tip_clearances(pinion: Gear, gear: Gear, centre_distance: float) -> tuple[float, float]:
    """Tip clearance in mm: pinion tip to gear root, gear tip to pinion root; negative where the tip digs in."""
    orientation = pinion.orientation * gear.orientation  # radii and distance of a ring are negative, as in ISO 21771
    centre, tip, root = (orientation * length for length in (centre_distance, gear.tip_radius, gear.root_radius))
    return centre - pinion.tip_radius - root, centre - tip - pinion.root_radius


def bottoming_centre_distance(pinion: Gear, gear: Gear) -> float:
    """Centre distance in mm at which the first tip touches a root circle: the least that is possible, with a ring the greatest."""
    orientation = pinion.orientation * gear.orientation
    tip, root = orientation * gear.tip_radius, orientation * gear.root_radius
    return orientation * max(pinion.tip_radius + root, tip + pinion.root_radius)


def interference_free_centre_distance(pinion: Gear, gear: Gear) -> float:
    """Least centre distance in mm at which neither tip passes the other's interference point; with a ring the greatest."""
    if gear.spec.internal:  # a sin α_w ≤ L of the ring's tip; the pinion's own cannot pass
        return math.hypot(sum_of_base_radii(pinion, gear), gear.tip_roll)
    return math.hypot(sum_of_base_radii(pinion, gear), max(pinion.tip_roll, gear.tip_roll))


def closest_centre_distance(pinion: Gear, gear: Gear) -> float:
    """Centre distance in mm at which a tip first touches the mate's generated root: root circle **or** fillet.

    Fillets reach further in than root circles do, so this comes before `bottoming_centre_distance` or with it. Backlash is not
    asked about: the flanks are taken to touch on one side, whatever the other has.

    Returns
    -------
    float
        mm, found by bisection to 1e-9 of itself; never below the sum of the base radii.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> round(bottoming_centre_distance(pinion, gear), 3), round(closest_centre_distance(pinion, gear), 3)
    (112.712, 113.053)
    """

    refuse(pinion, "the closest centre distance", Toothing.INTERNAL)
    refuse(gear, "the closest centre distance", Toothing.INTERNAL)

    def digs(distance: float) -> bool:
        return max(tip_penetration(pinion, gear, distance), tip_penetration(gear, pinion, distance)) > ROUNDING

    bases = sum_of_base_radii(pinion, gear)
    low = max(bottoming_centre_distance(pinion, gear), math.nextafter(bases, math.inf))
    if not digs(low):
        return low
    # There the mate's corner stays outside the form circle: involute meets involute alone.
    high = max(low, pinion.form_radius + gear.tip_radius, gear.form_radius + pinion.tip_radius)
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if digs(middle) else (low, middle)
    return high


def interference(gear: Gear, mate: Gear, centre_distance: float) -> Interference:
    """Hold the mate's tip against a gear's root.

    Parameters
    ----------
    gear : Gear
        The gear whose root is looked at.
    mate : Gear
        The gear whose tip goes there.
    centre_distance : float
        Working centre distance in mm.

    Returns
    -------
    Interference

    Raises
    ------
    InputError
        If the base pitches differ or the base circles meet.

    Notes
    -----
    A tip past the interference point harms only where there is metal: a root generated by a rack is undercut to let a rack
    pass, and a gear of any tooth count passes where its rack does. So the corner's true path is followed, too.
    """
    orientation = gear.orientation * mate.orientation
    line = orientation * centre_distance * math.sin(working_pressure_angle(gear, mate, centre_distance))
    reached = gear.orientation * (line - mate.orientation * mate.tip_roll)  # own roll that the mate's tip reaches
    depth = tip_penetration(gear, mate, centre_distance)
    return Interference(
        overrun=-reached,
        largest_mate_tip_radius=math.hypot(mate.base_radius, line),
        below_form=gear.orientation * (gear.form_roll - reached),
        penetration=depth if depth > ROUNDING else 0.0,
    )

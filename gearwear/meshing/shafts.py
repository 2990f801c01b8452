"""How far the shafts must move to take up wear, and whether they can."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.meshing.backlash import (
    BacklashKind,
    centre_distance_for_backlash,
    normal_backlash,
    sum_of_base_radii,
    working_pressure_angle,
)
from gearwear.meshing.clearance import bottoming_centre_distance, interference


@dataclass(frozen=True, slots=True)
class ShaftMovement:
    """Where the shafts would have to go to take up a loss of tooth thickness, and whether they can.

    Parameters
    ----------
    thickness_loss : float
        Thickness lost by both gears' teeth together, mm of arc at the reference circle.
    backlash : float
        Backlash wanted after the movement, mm, of `kind`.
    kind : {"reference", "operating", "normal"}
        Where that backlash is measured.
    movement : float or None
        Change of centre distance in mm, negative is closer; None where no distance gives the backlash.
    movement_linear : float
        The first-order answer, ``(wanted − present backlash − loss) / (2 tan α_wt)``.
    centre_distance : float or None
        Where the shafts would end, mm.
    working_pressure_angle : float or None
        There, rad.
    bottoming_centre_distance : float
        The closest the shafts get before a tip touches a root circle, mm.
    takeable_loss : float
        Greatest thickness loss that can be taken up to zero backlash before that, mm of arc at the reference circle.
    feasible : bool
        Whether the shafts can get there.
    obstacles : tuple of str
        Why not, each with its numbers; empty where feasible.
    """

    thickness_loss: float
    backlash: float
    kind: BacklashKind
    movement: float | None
    movement_linear: float
    centre_distance: float | None
    working_pressure_angle: float | None
    bottoming_centre_distance: float
    takeable_loss: float
    feasible: bool
    obstacles: tuple[str, ...]


def shaft_movement(
    pinion: Gear,
    gear: Gear,
    centre_distance: float,
    thickness_loss: float,
    backlash: float = 0.0,
    kind: BacklashKind = "reference",
) -> ShaftMovement:
    """How far the shafts must move to bring a worn pair back to a wanted backlash.

    Parameters
    ----------
    pinion, gear : Gear
        The unworn pair.
    centre_distance : float
        Present centre distance in mm.
    thickness_loss : float
        Thickness lost by both gears' teeth together, mm of arc at the reference circle, on **every** tooth. Teeth worn less
        jam before the worn ones close. Negative is thicker, such as a coat.
    backlash : float
        Backlash wanted, mm.
    kind : {"reference", "operating", "normal"}
        Where it is measured.

    Returns
    -------
    ShaftMovement

    Raises
    ------
    InputError
        If the base pitches differ, the base circles meet at the present distance, the loss is not finite or the
        backlash negative.

    Notes
    -----
    The loss is taken to go on below the flank as deep as on it; a ledge left in the root makes interference worse.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> answer = shaft_movement(pinion, gear, 114.3, thickness_loss=1.992, backlash=0.2286)
    >>> round(answer.movement, 3), round(answer.takeable_loss, 2), answer.feasible
    (-2.683, 1.09, False)
    """
    if not math.isfinite(thickness_loss):
        raise InputError(f"thickness loss = {thickness_loss:g} mm: must be a finite number")
    if not 0.0 <= backlash < math.inf:
        raise InputError(f"backlash = {backlash:g} mm: must be 0 or more")
    alpha = working_pressure_angle(pinion, gear, centre_distance)
    cos_reference = math.cos(pinion.transverse_pressure_angle)
    to_operating = cos_reference / math.cos(alpha)
    wanted = backlash * {"reference": to_operating, "operating": 1.0, "normal": 1.0 / math.cos(alpha)}[kind]
    present = normal_backlash(pinion, gear, centre_distance) / math.cos(alpha)
    linear = (wanted - present - thickness_loss * to_operating) / (2.0 * math.tan(alpha))
    bottoming = bottoming_centre_distance(pinion, gear)
    closest = max(bottoming, math.nextafter(sum_of_base_radii(pinion, gear), math.inf))
    needed: float | None = None
    try:
        found = centre_distance_for_backlash(pinion, gear, backlash, kind, thickness_loss)
    except InputError as error:  # the inputs are checked above: this is the answer "nowhere"
        obstacles: tuple[str, ...] = (str(error),)
    else:
        needed, obstacles = found, _obstacles(pinion, gear, found)
    return ShaftMovement(
        thickness_loss=thickness_loss,
        backlash=backlash,
        kind=kind,
        movement=None if needed is None else needed - centre_distance,
        movement_linear=linear,
        centre_distance=needed,
        working_pressure_angle=None if needed is None else working_pressure_angle(pinion, gear, needed),
        bottoming_centre_distance=bottoming,
        takeable_loss=-normal_backlash(pinion, gear, closest) / cos_reference,
        feasible=not obstacles,
        obstacles=obstacles,
    )


def _obstacles(pinion: Gear, gear: Gear, centre_distance: float) -> tuple[str, ...]:
    """What keeps the shafts from this centre distance."""
    found = []
    for name, own, mate in (("pinion", pinion, gear), ("gear", gear, pinion)):
        clearance = centre_distance - mate.tip_radius - own.root_radius
        if clearance < 0.0:
            found.append(f"the mate's tip digs {-clearance:.3f} mm into the {name}'s root circle")
            continue
        depth = interference(own, mate, centre_distance).penetration
        if depth > 0.0:
            found.append(f"the mate's tip corner digs {depth:.3f} mm into the {name}'s fillet")
    return tuple(found)

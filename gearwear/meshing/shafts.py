"""How far the shafts must move to take up wear, and whether they can."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import get_args

from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.given import check_choice, check_number
from gearwear.design.quantity import SPACE, not_zero, number, sentence
from gearwear.errors import InputError, check_kind
from gearwear.meshing.backlash import (
    BacklashKind,
    centre_distance_for_backlash,
    normal_backlash,
    sum_of_base_radii,
    transverse_backlash,
    working_pressure_angle,
)
from gearwear.meshing.clearance import ROUNDING, bottoming_centre_distance, closest_centre_distance, interference


@dataclass(frozen=True, slots=True, repr=False)
class ShaftMovement(Card):
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
        The distance at which a tip meets a root circle, mm.
    bottoming_loss : float
        Thickness loss that brings the shafts there, mm of arc at the reference circle.
    closest_centre_distance : float
        The closest the shafts get before a tip touches a root circle or a tip corner a fillet, mm.
    takeable_loss : float
        Greatest thickness loss at which the wanted backlash can be had, mm of arc at the reference circle; it takes the shafts to
        `closest_centre_distance`.
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
    bottoming_loss: float
    closest_centre_distance: float
    takeable_loss: float
    feasible: bool
    obstacles: tuple[str, ...]

    def headline(self) -> str:
        if self.movement is None or self.centre_distance is None:
            return f"no centre distance takes up {self.thickness_loss:z.4f} mm"
        way = "closer" if self.movement < 0.0 else "apart"
        can = "" if self.feasible else ", which cannot be"
        return f"{abs(self.movement):.4f} mm {way}, to {self.centre_distance:.4f} mm{can}"

    def rows(self) -> list[CardRow]:
        limit = f"{self.takeable_loss:.4f} mm, to {self.closest_centre_distance:.4f} mm"
        return [
            ("thickness lost", f"{self.thickness_loss:z.4f} mm on every tooth"),
            ("backlash wanted", f"{self.backlash:.4f} mm ({self.kind})"),
            ("most that can be taken up", limit),
            ("tips bottom", f"at {self.bottoming_centre_distance:.4f} mm"),
            *(("in the way", obstacle) for obstacle in self.obstacles),
        ]


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
        If the base pitches differ, the base circles meet at the present distance, the loss is not finite, the backlash negative or its
        kind none.

    Notes
    -----
    The loss is taken to go on below the flank as deep as on it; a ledge left in the root makes interference worse. For flanks of
    which some are worn and others are not, see `take_up`.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> answer = shaft_movement(pinion, gear, 114.3, thickness_loss=1.992, backlash=0.2286)
    >>> answer
    ShaftMovement: 2.6832 mm closer, to 111.6168 mm, which cannot be
      thickness lost             1.9920 mm on every tooth
      backlash wanted            0.2286 mm (reference)
      most that can be taken up  1.0971 mm, to 113.0534 mm
      tips bottom                at 112.7125 mm
      in the way                 the gear's tip digs 1.096 mm into the pinion's root circle
      in the way                 the pinion's tip digs 1.096 mm into the gear's root circle
    """
    for name, one in (("pinion", pinion), ("gear", gear)):
        check_kind(one, Gear, name, "one of design.gears")
    check_choice("kind", kind, get_args(BacklashKind))
    return _movement(pinion, gear, centre_distance, thickness_loss, backlash, kind, closest_centre_distance(pinion, gear))


def _movement(
    pinion: Gear, gear: Gear, centre_distance: float, thickness_loss: float, backlash: float, kind: BacklashKind, closest: float
) -> ShaftMovement:
    """`shaft_movement` with the closest distance known."""
    for name, given in (("thickness_loss", thickness_loss), ("backlash", backlash)):
        check_number(name, given, "mm")
    if not math.isfinite(thickness_loss):
        raise InputError(f"thickness loss = {thickness_loss:g} mm: must be a finite number")
    if not 0.0 <= backlash < math.inf:
        raise InputError(f"backlash = {backlash:g} mm: must be 0 or more")
    alpha = working_pressure_angle(pinion, gear, centre_distance)
    cos_reference = math.cos(pinion.transverse_pressure_angle)
    to_operating = cos_reference / math.cos(alpha)
    lean = pinion.base_helix_cosine
    wanted = backlash * {"reference": to_operating, "operating": 1.0, "normal": 1.0 / (math.cos(alpha) * lean)}[kind]
    present = transverse_backlash(pinion, gear, centre_distance) / math.cos(alpha)
    linear = (wanted - present - thickness_loss * to_operating) / (2.0 * math.tan(alpha))
    bottoming = bottoming_centre_distance(pinion, gear)

    def loss_at(distance: float) -> float:
        """Thickness loss with which the pair has the wanted backlash at this distance."""
        cos_working = sum_of_base_radii(pinion, gear) / distance
        along_action = backlash * {"reference": cos_reference, "operating": cos_working, "normal": 1.0 / lean}[kind]
        return (along_action - transverse_backlash(pinion, gear, distance)) / cos_reference

    needed: float | None = None
    try:
        sought = centre_distance_for_backlash(pinion, gear, backlash, kind, thickness_loss)
    except InputError as error:  # the inputs are checked above: this is the answer "nowhere"
        obstacles: tuple[str, ...] = (str(error),)
    else:
        needed, obstacles = sought, _obstacles(pinion, gear, sought)
    return ShaftMovement(
        thickness_loss=thickness_loss,
        backlash=backlash,
        kind=kind,
        movement=None if needed is None else needed - centre_distance,
        movement_linear=linear,
        centre_distance=needed,
        working_pressure_angle=None if needed is None else working_pressure_angle(pinion, gear, needed),
        bottoming_centre_distance=bottoming,
        bottoming_loss=loss_at(max(bottoming, math.nextafter(sum_of_base_radii(pinion, gear), math.inf))),
        closest_centre_distance=closest,
        takeable_loss=loss_at(closest),
        feasible=not obstacles,
        obstacles=obstacles,
    )


def _obstacles(pinion: Gear, gear: Gear, centre_distance: float) -> tuple[str, ...]:
    """What keeps the shafts from this centre distance."""
    obstacles = []
    for name, member, other, mate in (("pinion", pinion, "gear", gear), ("gear", gear, "pinion", pinion)):
        clearance = centre_distance - mate.tip_radius - member.root_radius
        if clearance < -ROUNDING:
            obstacles.append(f"the {other}'s tip digs {not_zero(-clearance, 3)} mm into the {name}'s root circle")
            continue
        depth = interference(member, mate, centre_distance).penetration
        if depth > 0.0:
            obstacles.append(f"the {other}'s tip corner digs {not_zero(depth, 3)} mm into the {name}'s fillet")
    return tuple(obstacles)


@dataclass(frozen=True, slots=True)
class TakeUp:
    """Taking up the play of flanks that are not all worn alike.

    Each is a movement back to the backlash that the design has at the present distance (none, if it has less than none).

    Parameters
    ----------
    tightest : ShaftMovement
        By the least backlash of a cycle: as far as the shafts **can** close. Any closer, the tightest position jams.
    loosest : ShaftMovement
        By the greatest backlash: as far as they would have to close so that no position has more than the design.
    alike : ShaftMovement
        By the greatest loss of thickness, as if every tooth had it over its whole face.
    jam : float
        How far the teeth of the tightest position would overlap at `loosest`, mm of normal backlash; 0 where all are worn alike.
    """

    tightest: ShaftMovement
    loosest: ShaftMovement
    alike: ShaftMovement
    jam: float


def take_up(pinion: Gear, gear: Gear, centre_distance: float, backlash: tuple[float, float], thickness_loss: float) -> TakeUp:
    """How far the shafts can and would have to move to take up wear that is not alike on all teeth.

    Parameters
    ----------
    pinion, gear : Gear
        The unworn pair.
    centre_distance : float
        Present centre distance in mm.
    backlash : (float, float)
        Least and greatest normal backlash of the flanks as they are, over a cycle, mm; from `contact.mesh_contact`.
    thickness_loss : float
        Greatest loss of thickness of any tooth at any height, mm of arc at the reference circle.

    Returns
    -------
    TakeUp

    Raises
    ------
    InputError
        As for `shaft_movement`.

    Notes
    -----
    Play over the design's counts as a thickness loss of play / (cos α_t cos β_b) on every tooth. That is exact for flanks worn by an even
    depth; on others the contact moves along the worn flanks while the shafts close, and the play of the new contact is another,
    to second order.

    Examples
    --------
    One worn tooth: its neighbours leave no play, and nothing can be taken up.

    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> gear = Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0))
    >>> found = take_up(pinion, gear, 114.3, (0.0, 0.1), thickness_loss=0.1064)
    >>> [round(one.movement, 4) + 0.0 for one in (found.tightest, found.loosest)], round(found.jam, 4)
    ([0.0, -0.1469], 0.1)
    """
    present = normal_backlash(pinion, gear, centre_distance)
    wanted = max(present, 0.0)
    to_arc = math.cos(pinion.transverse_pressure_angle) * pinion.base_helix_cosine
    least, greatest = ((play - present) / to_arc for play in backlash)
    closest = closest_centre_distance(pinion, gear)
    tightest, loosest, alike = (
        _movement(pinion, gear, centre_distance, loss, wanted, "normal", closest) for loss in (least, greatest, thickness_loss)
    )
    return TakeUp(tightest, loosest, alike, max(backlash[1] - backlash[0], 0.0))


ALIKE_BACKLASH = 5e-4
"""mm of normal backlash; teeth that differ by less are said to be worn alike."""


def take_up_words(shafts: TakeUp) -> str:
    """What a reader must know of it, in two or three sentences."""
    tightest, loosest, alike = shafts.tightest, shafts.loosest, shafts.alike
    if shafts.jam < ALIKE_BACKLASH and abs(loosest.movement or 0.0) < ALIKE_BACKLASH <= abs(alike.movement or 0.0):
        return sentence("there is no play to take up: in every position of the mesh teeth that are not worn carry")
    if shafts.jam < ALIKE_BACKLASH:
        return sentence(f"the wear is taken up with the shafts {_way(loosest)}{_but(loosest)}")
    if abs(tightest.movement or 0.0) < ALIKE_BACKLASH:
        play = "no more play than designed" if alike.backlash > ALIKE_BACKLASH else "no play to take up"
        can = f"the shafts cannot close: in the tightest position of the mesh there is {play}"
    else:
        can = f"the shafts can close until the tightest position has its play back, {_way(tightest)}{_but(tightest)}"
    jam = f"to take up the greatest play they would have to be {_way(loosest)}, with {_mm(shafts.jam)} of tooth in the way"
    every = (
        f"had every tooth lost the {_mm(alike.thickness_loss)} of the thinnest section, it would be {_way(alike)}{_but(alike)}"
    )
    return " ".join(map(sentence, (can, jam, every)))


def _way(movement: ShaftMovement) -> str:
    if movement.movement is None or movement.centre_distance is None:
        return "at no distance at all"
    return f"{_mm(abs(movement.movement))} {'closer' if movement.movement <= 0.0 else 'further apart'}, at {_mm(movement.centre_distance)}"


def _but(movement: ShaftMovement) -> str:
    """Why it cannot be, or nothing."""
    if movement.feasible:
        return ""
    if movement.movement is None or movement.centre_distance is None:
        return f": {movement.obstacles[0]}"
    bottom, closest = movement.bottoming_centre_distance, movement.closest_centre_distance
    why = [f"tips bottom at {_mm(bottom, 4)}"] if movement.centre_distance < bottom else []
    why += [f"tip corners meet fillets at {_mm(closest)}"] if closest > bottom else []
    return f", which cannot be: {' and '.join(why)}, so at most {_mm(movement.takeable_loss)} of lost thickness can be taken up"


def _mm(value: float, digits: int = 3) -> str:
    return f"{number(value, digits)}{SPACE}mm"

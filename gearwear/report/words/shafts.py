"""Taking up wear by moving the shafts, as numbers for JSON files and in words."""

from __future__ import annotations

import math
from typing import Any

from gearwear.design.quantity import SPACE, number, sentence
from gearwear.meshing.shafts import ShaftMovement, TakeUp
from gearwear.report.figures.arrays import Report

ALIKE = 5e-4
"""mm of normal backlash; teeth that differ by less are said to be worn alike."""


def take_up_record(found: TakeUp) -> dict[str, Any]:
    """Plain numbers; mm and degrees with the unit in the key.

    `tightest` and `loosest` are from the play of the flanks in contact; the keys beside them are for the greatest loss of
    thickness, taken to be on every tooth.
    """
    return {
        **_movement(found.alike),
        "wanted_normal_backlash_mm": found.alike.backlash,
        "bottoming_centre_distance_mm": found.alike.bottoming_centre_distance,
        "bottoming_loss_mm": found.alike.bottoming_loss,
        "closest_centre_distance_mm": found.alike.closest_centre_distance,
        "takeable_loss_mm": found.alike.takeable_loss,
        "tightest": _movement(found.tightest),
        "loosest": _movement(found.loosest),
        "jam_normal_mm": found.jam,
    }


def _movement(one: ShaftMovement) -> dict[str, Any]:
    return {
        "thickness_loss_mm": one.thickness_loss,
        "movement_mm": one.movement,
        "movement_linear_mm": one.movement_linear,
        "centre_distance_mm": one.centre_distance,
        "working_pressure_angle_deg": None if one.working_pressure_angle is None else math.degrees(one.working_pressure_angle),
        "feasible": one.feasible,
        "obstacles": list(one.obstacles),
    }


def take_up_words(found: Report) -> str:
    """What a reader must know of it, in two or three sentences; `found` as `take_up_record` gives it.

    >>> one = {"thickness_loss_mm": 0.1, "movement_mm": -0.1372, "centre_distance_mm": 114.1628, "feasible": True, "obstacles": []}
    >>> take_up_words({**one, "tightest": one, "loosest": one, "jam_normal_mm": 0.0}).replace(SPACE, " ")
    'The wear is taken up with the shafts 0.137 mm closer, at 114.163 mm.'
    """
    tightest, loosest = found["tightest"], found["loosest"]
    if found["jam_normal_mm"] < ALIKE:
        return sentence(f"the wear is taken up with the shafts {_way(loosest)}{_but(loosest, found)}")
    if abs(tightest["movement_mm"] or 0.0) < ALIKE:
        play = "no more play than designed" if found["wanted_normal_backlash_mm"] > ALIKE else "no play to take up"
        can = f"the shafts cannot close: in the tightest position of the mesh there is {play}"
    else:
        can = f"the shafts can close until the tightest position has its play back, {_way(tightest)}{_but(tightest, found)}"
    jam = f"to take up the greatest play they would have to be {_way(loosest)}, with {_mm(found['jam_normal_mm'])} of tooth in the way"
    loss = _mm(found["thickness_loss_mm"])
    alike = f"had every tooth lost the {loss} of the thinnest section, it would be {_way(found)}{_but(found, found)}"
    return " ".join(map(sentence, (can, jam, alike)))


def _way(one: Report) -> str:
    if one["movement_mm"] is None:
        return "at no distance at all"
    way = "closer" if one["movement_mm"] <= 0.0 else "further apart"
    return f"{_mm(abs(one['movement_mm']))} {way}, at {_mm(one['centre_distance_mm'])}"


def _but(one: Report, found: Report) -> str:
    """Why it cannot be, or nothing."""
    if one["feasible"]:
        return ""
    if one["movement_mm"] is None:
        return f": {one['obstacles'][0]}"
    bottom, closest = found["bottoming_centre_distance_mm"], found["closest_centre_distance_mm"]
    why = [f"tips bottom at {_mm(bottom, 4)}"] if one["centre_distance_mm"] < bottom else []
    why += [f"tip corners meet fillets at {_mm(closest)}"] if closest > bottom else []
    return (
        f", which cannot be: {' and '.join(why)}, so at most {_mm(found['takeable_loss_mm'])} of lost thickness can be taken up"
    )


def _mm(value: float, digits: int = 3) -> str:
    return f"{number(value, digits)}{SPACE}mm"

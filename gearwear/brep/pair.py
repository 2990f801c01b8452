"""Pinion and gear in mesh."""

from __future__ import annotations

import math

import numpy as np
from build123d import Compound, Location, Solid

from gearwear.brep.solid import gear_solid
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.twist import segments, turn_at


def mesh_turn(gear: Gear) -> float:
    """Angle in rad by which the gear is turned from its design frame: a space of it faces the pinion's tooth on +x, or holds it inside a ring.

    Both flanks of that tooth are then equally far from the gear's: the backlash is shared.
    """
    return (0.0 if gear.spec.internal else math.pi) + 0.5 * gear.pitch_angle


def gear_pair(design: Design, pinion: Solid | None = None, gear: Solid | None = None) -> Compound:
    """Both solids of a design in mesh at its centre distance.

    Parameters
    ----------
    design : Design
        A pair.
    pinion, gear : build123d.Solid or None
        The solids in their design frames; None: made here.

    Returns
    -------
    build123d.Compound
        Labelled "pair", children "pinion" and "gear". The pinion stands in its design frame; the gear's axis is at
        (centre distance, 0), a ring's at (−centre distance, 0), its mid-plane is the pinion's.

    Raises
    ------
    ValueError
        If the design has one gear only.
    InputError
        If a solid cannot be made; see `gear_solid`.
    """
    if design.pair is None:
        raise ValueError("a design of one gear has no pair")
    first, second = design.gears["pinion"], design.gears["gear"]
    height = 0.5 * (first.face_width - second.face_width)
    # Where the pinion has a tooth on +x the gear has a space facing it; the halves of a double helical one may end at other heights.
    facing = np.array(segments(first)[0].middle - height)
    turn = mesh_turn(second) - float(turn_at(second, facing))
    place = Location((second.orientation * design.centre_distance, 0.0, height), (0.0, 0.0, math.degrees(turn)))
    left = (pinion or gear_solid(first)).moved(Location())  # copies: to be a child changes a shape
    right = (gear or gear_solid(second)).moved(place)
    left.label, right.label = first.spec.name, second.spec.name
    return Compound(label="pair", children=[left, right])

"""Pairs whose drawing modifies the flanks, in rigid contact."""

from dataclasses import replace

import pytest

from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.meshing.path import path_of_contact
from gearwear.meshing.study import transmission_error_as_drawn

WHEEL = Gear.from_spec(GearSpec("gear", 31, 3.0, 20.0))
CENTRE = 76.5


def pinion(**modification: float) -> Gear:
    drawn = FlankModification(**modification)
    return Gear.from_spec(replace(GearSpec("pinion", 20, 3.0, 20.0), left=drawn, right=drawn))


def error(gear: Gear, side: Side = Side.LEFT) -> float:
    return transmission_error_as_drawn(gear, WHEEL, CENTRE, side)


PATH = path_of_contact(pinion(), WHEEL, CENTRE)
SPARE = PATH.length - PATH.base_pitch
"""Roll length that may be relieved while a pair is always in contact outside it, mm."""


def test_a_pair_as_generated_has_none():
    assert error(pinion()) == 0.0


@pytest.mark.parametrize("side", Side)
def test_relief_where_another_pair_carries_costs_nothing(side):
    assert error(pinion(tip_relief=0.03, tip_relief_length=0.9 * SPARE), side) < 1e-6


def test_relief_beyond_that_costs_at_most_what_it_takes_off_at_the_change():
    """Without corner contact the greatest lag is δ₀ where the next pair comes in; corners, which come in before, can only make it less."""
    length, amount = 1.5 * SPARE, 0.03
    at_the_change = amount * (length - SPARE) / length
    assert 0.5 * at_the_change < error(pinion(tip_relief=amount, tip_relief_length=length)) < at_the_change


def test_crowning_across_the_face_leaves_the_middle_carrying():
    assert error(pinion(helix_crowning=0.02, end_relief=0.02, end_relief_length=4.0)) < 1e-6


@pytest.mark.long
def test_a_slope_of_the_profile_makes_a_saw_of_its_rise_over_a_pitch():
    """δ₀ rises by f over the flank; with one pair in, the lead changes by f times base pitch over the flank's roll, at most."""
    f, gear = 0.012, pinion(profile_slope=0.012)
    assert error(gear) <= f * PATH.base_pitch / (gear.tip_roll - gear.form_roll) + 1e-6
    assert error(gear) > 0.3 * f * PATH.base_pitch / (gear.tip_roll - gear.form_roll)

"""Taking up wear by moving the shafts (reference A3), and the exact result that gathers it all."""

import math

import pytest

from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from gearwear.meshing.backlash import normal_backlash
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.shafts import shaft_movement

C = 114.3
LOSS, ALLOWANCE = 1.992, 0.2286


def test_the_papers_loss_cannot_be_taken_up(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, LOSS, ALLOWANCE)

    assert found.movement_linear == pytest.approx(-2.4224, abs=6e-5)
    assert found.centre_distance == pytest.approx(111.617, abs=5e-4)
    assert found.movement == pytest.approx(-2.683, abs=5e-4)
    assert math.degrees(found.working_pressure_angle) == pytest.approx(15.79, abs=5e-3)
    assert found.bottoming_centre_distance == pytest.approx(112.7125, abs=1e-12)
    assert found.takeable_loss == pytest.approx(1.09, abs=5e-3)
    assert not found.feasible
    assert found.obstacles == (
        "the mate's tip digs 1.096 mm into the pinion's root circle",
        "the mate's tip digs 1.096 mm into the gear's root circle",
    )


def test_down_to_no_backlash_at_all(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, LOSS)

    assert found.centre_distance == pytest.approx(111.213, abs=5e-4)
    assert found.movement == pytest.approx(-3.087, abs=5e-4)
    assert math.degrees(found.working_pressure_angle) == pytest.approx(15.03, abs=5e-3)


def test_the_takeable_loss_ends_with_tips_on_roots(pinion, wheel):
    most = shaft_movement(pinion, wheel, C, 0.0).takeable_loss
    found = shaft_movement(pinion, wheel, C, most)

    assert found.centre_distance == pytest.approx(found.bottoming_centre_distance, abs=1e-10)


def test_a_small_loss_is_taken_up(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, 0.1)

    assert found.feasible
    assert found.obstacles == ()
    assert found.movement == pytest.approx(-0.1 / (2 * math.tan(math.radians(20))), rel=0.02)
    assert found.movement_linear == pytest.approx(-0.1 / (2 * math.tan(math.radians(20))), rel=1e-12)


@pytest.mark.parametrize("kind", ["reference", "normal"])
def test_the_linear_answer_is_the_derivative_of_the_exact_one(pinion, wheel, kind):
    """At any present distance; the backlash of before is wanted back after a tiny loss."""
    at, loss = 116.0, 1e-5
    wanted = normal_backlash(pinion, wheel, at) / (math.cos(math.radians(20)) if kind == "reference" else 1.0)
    found = shaft_movement(pinion, wheel, at, loss, wanted, kind)

    assert found.movement == pytest.approx(found.movement_linear, rel=1e-4)


def test_a_fillet_in_the_way_is_named():
    pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.38))
    gear = Gear.from_spec(GearSpec("gear", 60, 6.35, 15.0, addendum=1.2))
    found = shaft_movement(pinion, gear, 231.0, 0.0)

    assert found.centre_distance == pytest.approx(36 * 6.35, abs=1e-10)
    assert found.centre_distance > found.bottoming_centre_distance
    assert not found.feasible
    assert [o.split(" digs ")[0] for o in found.obstacles] == ["the mate's tip corner"]
    assert found.obstacles[0].endswith("the pinion's fillet")


def test_no_distance_closes_teeth_that_are_hardly_there(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, 9.0)

    assert found.movement is None
    assert not found.feasible
    assert "base circles meet first" in found.obstacles[0]


def test_thicker_teeth_need_the_shafts_apart(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, -0.1)

    assert found.feasible
    assert normal_backlash(pinion, wheel, found.centre_distance) == pytest.approx(0.1 * math.cos(math.radians(20)), abs=1e-12)


@pytest.mark.parametrize(("loss", "backlash"), [(0.1, -0.1), (math.nan, 0.0), (0.0, math.inf)])
def test_amounts_that_cannot_be_are_refused(pinion, wheel, loss, backlash):
    with pytest.raises(InputError, match=r"must be (0 or more|a finite number)"):
        shaft_movement(pinion, wheel, C, loss, backlash)


def test_gathered_result_at_the_design_distance(pinion, wheel):
    found = exact_meshing(pinion, wheel, C)

    assert math.degrees(found.working_pressure_angle) == pytest.approx(20.0, abs=1e-12)
    assert (found.pitch_radius_pinion, found.pitch_radius_gear) == (pytest.approx(38.1), pytest.approx(76.2))
    assert found.backlash.normal == pytest.approx(0.0, abs=1e-13)
    assert found.path.contact_ratio == pytest.approx(1.242204, abs=5e-7)
    assert found.interference_pinion.overrun == pytest.approx(1.984, abs=5e-4)
    assert found.interference_gear.overrun < 0
    assert found.tip_clearance_pinion == pytest.approx(1.5875, abs=1e-12)

"""Taking up wear by moving the shafts (reference A3), and the exact result that gathers it all."""

import math
import re

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.pair import tip_clearances
from gearwear.design.profiles import nominal_profiles
from gearwear.errors import InputError
from gearwear.meshing.backlash import normal_backlash, working_pressure_angle, zero_backlash_centre_distance
from gearwear.meshing.clearance import interference
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.shafts import shaft_movement, take_up, take_up_words

C = 114.3
LOSS, ALLOWANCE = 1.992, 0.2286


def test_the_papers_loss_cannot_be_taken_up(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, LOSS, ALLOWANCE)

    assert found.movement_linear == pytest.approx(-2.4224, abs=6e-5)
    assert found.centre_distance == pytest.approx(111.617, abs=5e-4)
    assert found.movement == pytest.approx(-2.683, abs=5e-4)
    assert math.degrees(found.working_pressure_angle) == pytest.approx(15.79, abs=5e-3)
    assert found.bottoming_centre_distance == pytest.approx(112.7125, abs=1e-12)
    assert not found.feasible
    assert found.obstacles == (
        "the gear's tip digs 1.096 mm into the pinion's root circle",
        "the pinion's tip digs 1.096 mm into the gear's root circle",
    )


def test_where_the_first_order_answer_would_lead(pinion, wheel):
    """Reference A3: 111.878 mm, 16.25°, tips 0.835 mm in the roots."""
    there = C + shaft_movement(pinion, wheel, C, LOSS, ALLOWANCE).movement_linear

    assert there == pytest.approx(111.878, abs=5e-4)
    assert math.degrees(working_pressure_angle(pinion, wheel, there)) == pytest.approx(16.25, abs=5e-3)
    assert min(tip_clearances(pinion, wheel, there)) == pytest.approx(-0.835, abs=5e-4)


def test_tips_bottom_at_a_loss_of_1_09(pinion, wheel):
    """Reference A3: 112.7125 mm, 17.65°, 1.09 mm of arc down to no backlash."""
    found = shaft_movement(pinion, wheel, C, 0.0)
    there = shaft_movement(pinion, wheel, C, found.bottoming_loss)

    assert found.bottoming_loss == pytest.approx(1.09, abs=5e-3)
    assert there.centre_distance == pytest.approx(found.bottoming_centre_distance, abs=1e-10)
    assert math.degrees(there.working_pressure_angle) == pytest.approx(17.65, abs=5e-3)
    # The allowance is play that need not be taken up: so much more may be lost.
    assert shaft_movement(pinion, wheel, C, 0.0, ALLOWANCE).bottoming_loss == pytest.approx(found.bottoming_loss + ALLOWANCE)


def test_down_to_no_backlash_at_all(pinion, wheel):
    found = shaft_movement(pinion, wheel, C, LOSS)

    assert found.centre_distance == pytest.approx(111.213, abs=5e-4)
    assert found.movement == pytest.approx(-3.087, abs=5e-4)
    assert math.degrees(found.working_pressure_angle) == pytest.approx(15.03, abs=5e-3)


@pytest.mark.parametrize(("kind", "backlash"), [("reference", 0.0), ("reference", 0.1), ("operating", 0.1), ("normal", 0.1)])
def test_the_takeable_loss_is_the_last_feasible_one(pinion, wheel, kind, backlash):
    """Fillets come before root circles: less than up to the roots can be taken up, and a hair more cannot."""
    most = shaft_movement(pinion, wheel, C, 0.0, backlash, kind)
    last, next_one = (shaft_movement(pinion, wheel, C, most.takeable_loss + by, backlash, kind) for by in (-1e-5, 1e-5))

    assert most.takeable_loss < most.bottoming_loss
    assert most.closest_centre_distance > most.bottoming_centre_distance
    assert last.feasible and not next_one.feasible
    depth = re.match(r"the gear's tip corner digs (\S+) mm into the pinion's fillet", next_one.obstacles[0])[1]
    assert 0.0 < float(depth) < 1e-4
    assert last.centre_distance == pytest.approx(most.closest_centre_distance, abs=1e-4)


def test_the_fillet_is_felt_in_rigid_contact_from_the_closest_distance_on(pinion, wheel):
    """Teeth thinned alike on both flanks, so that they do not jam: the gear is pushed ahead by the corner alone."""
    closest = shaft_movement(pinion, wheel, C, 0.0).closest_centre_distance
    depth = 0.5
    clear, felt = (
        in_contact(pinion, wheel, closest + by, dict.fromkeys(range(12), depth), sides=(0, 1)).transmission_error_max.value
        + depth
        for by in (0.003, -0.01)
    )

    assert clear == pytest.approx(0.0, abs=1e-6)
    assert felt > 1e-3


def test_a_root_with_room_is_closed_until_tips_bottom():
    """The root of a sharp-cornered rack: no fillet is in the way before the root circle."""
    first, second = (Gear.from_spec(GearSpec(n, 30, 3.0, 10.0, rack_tip_radius=0.05)) for n in ("pinion", "gear"))
    found = shaft_movement(first, second, 90.0, 0.0)

    assert found.closest_centre_distance == found.bottoming_centre_distance == pytest.approx(89.25, abs=1e-12)
    assert found.takeable_loss == found.bottoming_loss


def test_a_corner_that_leaves_the_flank_above_the_form_circle_still_swings_into_the_fillet():
    """Contact ends above the form circle at this distance; the corner's path goes on inwards."""
    first, second = (Gear.from_spec(GearSpec(n, 60, 3.0, 10.0, addendum=0.8, rack_tip_radius=0.05)) for n in ("pinion", "gear"))
    found = shaft_movement(first, second, 180.0, 0.0)
    at = found.closest_centre_distance - 0.01

    assert interference(first, second, at).below_form < 0.0 < interference(first, second, at).penetration


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
    assert [o.split(" digs ")[0] for o in found.obstacles] == ["the gear's tip corner"]
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


def in_contact(pinion, wheel, centre_distance, worn, sides=(0,)):
    """Rigid contact of the pinion with `worn` (tooth: mm off its left flank, or both)."""
    first, second = (nominal_profiles(g, np.linspace(g.root_radius, g.tip_radius, 200), np.array([7.5])) for g in (pinion, wheel))
    for tooth, depth in worn.items():
        first.half_angle[tooth, sides] -= depth / pinion.base_radius
    return mesh_contact(first, second, centre_distance)


@pytest.mark.parametrize("worn", [{k: 0.30 if k < 5 else 0.12 for k in range(12)}, dict.fromkeys(range(12), 0.2), {3: 0.1}])
def test_teeth_worn_unlike_are_closed_until_the_least_worn_touch(pinion, wheel, worn):
    """The rigid contact of the worn flanks at the distances found: play is gone at its tightest, then at its loosest place."""
    before = in_contact(pinion, wheel, C + 0.5, worn)
    deepest = max(worn.values()) / math.cos(math.radians(20))
    found = take_up(pinion, wheel, C + 0.5, (before.backlash_min.value, before.backlash_max.value), deepest)
    design = normal_backlash(pinion, wheel, C + 0.5)

    tight = in_contact(pinion, wheel, found.tightest.centre_distance, worn)
    assert tight.backlash_min.value == pytest.approx(design, abs=1e-5)
    loose = in_contact(pinion, wheel, found.loosest.centre_distance, worn)
    assert loose.backlash_max.value == pytest.approx(design, abs=1e-5)
    assert loose.backlash_min.value == pytest.approx(design - found.jam, abs=1e-5)
    assert found.alike.movement <= found.loosest.movement + 1e-6 <= found.tightest.movement + 2e-6 <= 3e-6


def test_a_pair_without_play_gets_none_wanted(pinion, wheel):
    """Nearer than the teeth of the design allow: the wear is taken up to no backlash, not to less than none."""
    at = C - 0.2
    design = normal_backlash(pinion, wheel, at)
    assert design < 0.0
    found = take_up(pinion, wheel, at, (design + 0.3, design + 0.3), 0.3 / math.cos(math.radians(20)))

    assert (found.tightest.backlash, found.jam) == (0.0, 0.0)
    assert found.tightest.centre_distance == pytest.approx(
        zero_backlash_centre_distance(pinion, wheel, 0.3 / math.cos(math.radians(20)))
    )


def test_gathered_result_at_the_design_distance(pinion, wheel):
    found = exact_meshing(pinion, wheel, C)

    assert math.degrees(found.working_pressure_angle) == pytest.approx(20.0, abs=1e-12)
    assert (found.pitch_radius_pinion, found.pitch_radius_gear) == (pytest.approx(38.1), pytest.approx(76.2))
    assert found.backlash.normal == pytest.approx(0.0, abs=1e-13)
    assert found.path.contact_ratio == pytest.approx(1.242204, abs=5e-7)
    assert found.interference_pinion.overrun == pytest.approx(1.984, abs=5e-4)
    assert found.interference_gear.overrun < 0
    assert found.tip_clearance_pinion == pytest.approx(1.5875, abs=1e-12)


@pytest.mark.parametrize(("apart", "in_the_way"), [(0.0004, False), (0.010, True)])
def test_teeth_a_hundredth_of_a_millimetre_apart_are_not_worn_alike(pinion, wheel, apart, in_the_way):
    """The least play taken up, ten micrometres of the others are in the way; below half a micrometre nothing is."""
    told = take_up_words(take_up(pinion, wheel, C, (0.1, 0.1 + apart), 0.2))
    assert ("of tooth in the way" in told) is in_the_way
    assert told.startswith("The wear is taken up") is not in_the_way

"""Backlash and centre distance: the reference's table, published pairs, and that every relation undoes its inverse."""

import dataclasses
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from gearwear.meshing.backlash import (
    backlash,
    backlash_from_normal,
    centre_distance_for_backlash,
    normal_backlash,
    operating_pitch_radii,
    working_pressure_angle,
    zero_backlash_centre_distance,
)

C = 114.3


@pytest.mark.parametrize(
    ("change", "angle_deg", "circumferential", "normal"),
    [
        (0.1, 20.1372, 0.073098, 0.068629),
        (0.5, 20.6747, 0.371508, 0.347582),
        (1.0, 21.3234, 0.757847, 0.705967),
        (2.0, 22.5519, 1.573719, 1.453381),
        (2.4225, 23.0461, 1.935288, 1.780832),
        (3.0, 23.7004, 2.445317, 2.239078),
    ],
)
def test_backlash_of_the_standard_pair_moved_apart(pinion, wheel, change, angle_deg, circumferential, normal):
    found = backlash(pinion, wheel, C + change)

    assert math.degrees(working_pressure_angle(pinion, wheel, C + change)) == pytest.approx(angle_deg, abs=5e-5)
    assert found.circumferential == pytest.approx(circumferential, abs=5e-7)
    assert found.normal == pytest.approx(normal, abs=5e-7)


@pytest.mark.parametrize(
    ("change", "short"), [(0.1, -0.004), (0.5, -0.020), (1.0, -0.039), (2.0, -0.075), (2.4225, -0.089), (3.0, -0.107)]
)
def test_how_much_the_first_order_formula_is_short(pinion, wheel, change, short):
    first_order = 2 * change * math.tan(math.radians(20))

    assert first_order / backlash(pinion, wheel, C + change).circumferential - 1 == pytest.approx(short, abs=5e-4)


def test_backlash_at_the_printed_centre_distance(pinion, wheel):
    assert normal_backlash(pinion, wheel, 116.722) == pytest.approx(1.780441, abs=5e-7)


def test_standard_pair_at_its_standard_distance_has_none(pinion, wheel):
    assert normal_backlash(pinion, wheel, C) == pytest.approx(0.0, abs=1e-13)


def test_angular_backlash_turns_each_gear_by_the_same_length_on_its_base_circle(pinion, wheel):
    found = backlash(pinion, wheel, C + 0.1)

    assert math.degrees(found.angular_pinion) == pytest.approx(0.10983, abs=5e-6)
    assert math.degrees(found.angular_gear) == pytest.approx(0.10983 / 2, abs=3e-6)


def test_the_thicknesses_and_the_gaps_share_the_operating_pitch(pinion, wheel):
    """Another way to j_wt: what two teeth leave free of the operating circular pitch."""
    at = C + 1.7
    r1, r2 = operating_pitch_radii(pinion, wheel, at)
    free = 2 * math.pi * r1 / 12 - float(pinion.thickness(r1)) - float(wheel.thickness(r2))

    assert backlash(pinion, wheel, at).circumferential == pytest.approx(free, abs=1e-12)


def test_shafts_closed_by_the_exact_radial_backlash_touch_on_both_flanks(pinion, wheel):
    found = backlash(pinion, wheel, C + 2.0)

    assert found.radial_closing == pytest.approx(2.0, abs=1e-12)
    assert found.radial == pytest.approx(1.573719 / (2 * math.tan(math.radians(22.5519))), abs=2e-5)


def test_zero_backlash_distance_of_a_pinion_thinned_by_the_papers_loss(pinion, wheel):
    thinned = Gear.from_spec(dataclasses.replace(pinion.spec, thinning=1.992))

    assert zero_backlash_centre_distance(thinned, wheel) == pytest.approx(111.21263, abs=5e-6)
    assert zero_backlash_centre_distance(pinion, wheel, thickness_loss=1.992) == pytest.approx(
        zero_backlash_centre_distance(thinned, wheel), abs=1e-11
    )


@pytest.mark.parametrize(
    ("kind", "distance", "angle_deg"),
    [("operating", 116.5231, 22.815), ("reference", 116.5638, 22.862)],
)
def test_the_papers_backlash_inverted_exactly(pinion, wheel, kind, distance, angle_deg):
    found = centre_distance_for_backlash(pinion, wheel, 1.7634, kind)

    assert found == pytest.approx(distance, abs=5e-5)
    assert math.degrees(working_pressure_angle(pinion, wheel, found)) == pytest.approx(angle_deg, abs=5e-4)


def test_total_play_with_the_allowance_besides(pinion, wheel):
    found = centre_distance_for_backlash(pinion, wheel, 1.992 + 0.2286, "reference")

    assert found == pytest.approx(117.110, abs=5e-4)
    assert math.degrees(working_pressure_angle(pinion, wheel, found)) == pytest.approx(23.49, abs=5e-3)


@st.composite
def pairs(draw):
    module = draw(st.floats(0.5, 20.0))
    # Together at most 0.35 modules of arc are missing from the teeth: fewer than inv 20° · 28 teeth = 0.42, so they do touch.
    teeth = draw(st.integers(14, 80)), draw(st.integers(14, 200))
    shifts = draw(st.floats(-0.1, 0.6)), draw(st.floats(-0.1, 0.5))
    thinning = draw(st.floats(0.0, 0.1)) * module
    first, second = (
        Gear.from_spec(GearSpec(n, z, module, 20.0, profile_shift=x, addendum=0.8, thinning=t))
        for n, z, x, t in zip("ab", teeth, shifts, (thinning, 0.0), strict=True)
    )
    return first, second


@settings(max_examples=60, deadline=None)
@given(pairs(), st.floats(0.0, 1.0), st.sampled_from(["reference", "operating", "normal"]), st.floats(0.0, 0.1))
def test_the_distance_for_a_backlash_gives_that_backlash(gears, amount, kind, loss):
    first, second = gears
    module = first.transverse_module
    wanted, loss = amount * module, loss * module
    at = centre_distance_for_backlash(first, second, wanted, kind, loss)
    normal = normal_backlash(first, second, at) + loss * math.cos(first.transverse_pressure_angle)
    found = backlash_from_normal(first, second, at, normal)
    by_kind = {"reference": found.circumferential_reference, "operating": found.circumferential, "normal": found.normal}

    assert by_kind[kind] == pytest.approx(wanted, abs=1e-12 * at)


@settings(max_examples=40, deadline=None)
@given(pairs(), st.floats(-0.3, 1.0))
def test_swapping_the_gears_swaps_only_their_names(gears, moved):
    first, second = gears
    at = zero_backlash_centre_distance(first, second) + moved * first.transverse_module
    one, other = backlash(first, second, at), backlash(second, first, at)

    assert one.normal == pytest.approx(other.normal, abs=1e-12 * at)
    assert one.circumferential == pytest.approx(other.circumferential, abs=1e-12 * at)
    assert one.angular_pinion == pytest.approx(other.angular_gear, abs=1e-12)
    assert operating_pitch_radii(first, second, at) == pytest.approx(operating_pitch_radii(second, first, at)[::-1], rel=1e-14)
    assert sum(operating_pitch_radii(first, second, at)) == pytest.approx(at, rel=1e-14)


@settings(max_examples=40, deadline=None)
@given(pairs(), st.floats(0.0, 1.0), st.floats(0.001, 1.0))
def test_further_apart_means_more_angle_and_more_backlash(gears, moved, further):
    first, second = gears
    near = zero_backlash_centre_distance(first, second) + moved * first.transverse_module
    far = near + further * first.transverse_module

    assert working_pressure_angle(first, second, far) > working_pressure_angle(first, second, near)
    assert normal_backlash(first, second, far) > normal_backlash(first, second, near)


def test_radial_closing_is_none_when_the_base_circles_meet_first(pinion, wheel):
    normal = normal_backlash(pinion, wheel, C) + 10.0

    assert backlash_from_normal(pinion, wheel, C, normal).radial_closing is None


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p, g: working_pressure_angle(p, g, 107.0), r"centre distance = 107 mm: must be above .* 107\.4069 mm"),
        (lambda p, g: working_pressure_angle(p, g, math.nan), "must be above"),
        (lambda p, g: centre_distance_for_backlash(p, g, -0.1), r"backlash = -0\.1 mm: must be 0 or more"),
        (lambda p, g: centre_distance_for_backlash(p, g, 0.1, "radial"), "one of reference, operating, normal would be right"),
        (lambda p, g: zero_backlash_centre_distance(p, g, 8.0), "no centre distance gives it"),
    ],
)
def test_refusals(pinion, wheel, call, message):
    with pytest.raises(InputError, match=message):
        call(pinion, wheel)


def test_gears_of_different_module_are_refused(pinion):
    other = Gear.from_spec(GearSpec("gear", 24, 6.0, 15.0))

    with pytest.raises(InputError, match=r"base pitches 18\.746035 and"):
        normal_backlash(pinion, other, 120.0)

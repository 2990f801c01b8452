"""Path of contact and sliding: the reference's limits and table, a published pair, and the geometry of two circles."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from gearwear.meshing.path import path_of_contact, radius_at_roll, sliding

C = 114.3


def pair(rack_tip_radius):
    return [Gear.from_spec(GearSpec(n, z, 6.35, 15.0, rack_tip_radius=rack_tip_radius)) for n, z in (("p", 12), ("g", 24))]


@pytest.mark.parametrize(
    ("rack_tip_radius", "length", "ratio"), [(0.25, 23.286, 1.242), (0.30, 23.516, 1.254), (0.38, 23.893, 1.275)]
)
def test_undercut_ends_the_path_at_the_form_circle(rack_tip_radius, length, ratio):
    path = path_of_contact(*pair(rack_tip_radius), C)

    assert path.length == pytest.approx(length, abs=5e-4)
    assert path.contact_ratio == pytest.approx(ratio, abs=5e-4)
    assert path.limit_pinion == "form circle"
    assert path.limit_gear == "mate's tip"


def test_contact_ratio_of_the_reference_pair(pinion, wheel):
    assert path_of_contact(pinion, wheel, C).contact_ratio == pytest.approx(1.242204, abs=5e-7)


def test_limits_at_the_design_distance(pinion, wheel):
    path = path_of_contact(pinion, wheel, C)
    lowest, highest = path.single_contact_pinion

    assert radius_at_roll(pinion, path.start_pinion) == pytest.approx(35.9326, abs=5e-5)
    assert radius_at_roll(pinion, path.end_pinion) == pytest.approx(pinion.tip_radius, abs=1e-12)
    assert radius_at_roll(wheel, [path.start_gear, path.end_gear]) == pytest.approx([72.7307, 80.1609], abs=5e-5)
    assert (lowest, highest) == (pytest.approx(7.598, abs=5e-4), pytest.approx(21.803, abs=6e-4))
    assert radius_at_roll(pinion, [lowest, highest]) == pytest.approx([36.600, 41.919], abs=5e-4)


def test_at_the_printed_distance_the_mates_tip_ends_the_path(pinion, wheel):
    path = path_of_contact(pinion, wheel, 116.722)

    assert path.limit_pinion == "mate's tip"
    assert radius_at_roll(pinion, path.start_pinion) == pytest.approx(36.0986, abs=5e-5)
    assert path.length == pytest.approx(21.728108, abs=5e-7)
    assert path.contact_ratio == pytest.approx(1.159, abs=5e-4)


def test_no_path_is_longer_than_from_the_interference_point_to_the_pinions_tip(pinion):
    """Reference A5: 26.344 mm, 1.405 base pitches."""
    assert pinion.tip_roll == pytest.approx(26.344, abs=5e-4)
    assert pinion.tip_roll / pinion.base_pitch == pytest.approx(1.405, abs=5e-4)


def test_the_outer_part_of_the_gear_has_no_partner(pinion, wheel):
    """Reference B4: 2.39 mm below its tip."""
    end = float(radius_at_roll(wheel, path_of_contact(pinion, wheel, C).end_gear))

    assert wheel.tip_radius - end == pytest.approx(2.39, abs=5e-3)


@settings(max_examples=60, deadline=None)
@given(st.integers(9, 60), st.integers(15, 120), st.floats(0.0, 0.6), st.floats(0.0, 0.4))
def test_rolls_add_up_to_the_line_and_swapping_mirrors_the_path(teeth, mate_teeth, shift, apart):
    first = Gear.from_spec(GearSpec("a", teeth, 3.0, 20.0, profile_shift=shift, addendum=0.8))
    second = Gear.from_spec(GearSpec("b", mate_teeth, 3.0, 20.0, addendum=0.8))
    at = first.reference_radius + second.reference_radius + 3.0 * (shift + apart)
    path, mirrored = path_of_contact(first, second, at), path_of_contact(second, first, at)

    bases = first.base_radius + second.base_radius
    line = math.sqrt((at - bases) * (at + bases))
    tolerance = 1e-12 * at
    assert path.line == pytest.approx(line, abs=tolerance)
    for pinion_roll, gear_roll in (
        (path.start_pinion, path.end_gear),
        (path.end_pinion, path.start_gear),
        (path.pitch_pinion, path.pitch_gear),
        *zip(path.single_contact_pinion, reversed(mirrored.single_contact_pinion), strict=True),
    ):
        assert pinion_roll + gear_roll == pytest.approx(line, abs=tolerance)
    assert path.approach + path.recess == pytest.approx(path.length, abs=tolerance)
    assert mirrored.length == pytest.approx(path.length, abs=tolerance)
    assert (mirrored.start_gear, mirrored.limit_gear) == (pytest.approx(path.start_pinion, abs=tolerance), path.limit_pinion)
    assert first.form_roll <= path.start_pinion < path.end_pinion <= first.tip_roll


def pairs_in_contact(path, roll):
    """By counting: a pair is in contact where its place lies on the path."""
    places = roll + path.base_pitch * np.arange(-4, 5)
    return int(((places >= path.start_pinion) & (places <= path.end_pinion)).sum())


@settings(max_examples=60, deadline=None)
@given(st.floats(0.5, 1.4), st.floats(0.5, 1.4), st.sampled_from([14.5, 20.0, 25.0]))
def test_where_one_pair_is_alone_by_counting_pairs(addendum, mate_addendum, degrees):
    first, second = (
        Gear.from_spec(GearSpec(n, z, 3.0, 20.0, math.radians(degrees), addendum=a, dedendum=1.5, rack_tip_radius=0.1))
        for n, z, a in (("a", 40, addendum), ("b", 60, mate_addendum))
    )
    path = path_of_contact(first, second, 150.3)
    alone = path.alone_pinion
    rolls = np.linspace(path.start_pinion, path.end_pinion, 203)[1:-1]
    counted = np.array([pairs_in_contact(path, roll) for roll in rolls]) == 1
    if alone is None:
        assert path.contact_ratio >= 2.0
        assert not counted.any()
    else:
        clear = np.abs(rolls[:, None] - alone).min(axis=1) > 1e-9
        np.testing.assert_array_equal(counted[clear], ((rolls > alone[0]) & (rolls < alone[1]))[clear])
        assert path.alone_gear == pytest.approx((path.line - alone[1], path.line - alone[0]), abs=1e-12)


@pytest.mark.parametrize(
    ("roll", "radius", "velocity", "own", "mate", "equivalent"),
    [
        (3.05745, 35.93, -14.96, -4.89, 0.830, 2.82),
        (5.64, 36.244, -11.09, -1.97, 0.66, 4.83),
        (8.0, 36.685, -7.55, -0.943, 0.485, 6.36),
        (18.0, 40.072, 7.45, 0.414, -0.707, 9.71),
        (21.8, 41.91, 13.15, 0.603, -1.52, 9.64),
        (26.343853, 44.45, 19.97, 0.758, -3.13, 8.59),
    ],
)
def test_sliding_table(pinion, wheel, roll, radius, velocity, own, mate, equivalent):
    """Table B7 of the reference, to its printed digits."""
    found = sliding(pinion, wheel, C, [roll])

    assert radius_at_roll(pinion, roll) == pytest.approx(radius, abs=1e-2)  # 41.917 is printed as 41.91
    assert found.velocity[0] == pytest.approx(velocity, abs=6e-3)
    assert found.specific_pinion[0] == pytest.approx(own, abs=6e-3)
    assert found.specific_gear[0] == pytest.approx(mate, abs=6e-3)
    assert found.equivalent_radius[0] == pytest.approx(equivalent, abs=6e-3)


def test_nothing_slides_at_the_pitch_point(pinion, wheel):
    path = path_of_contact(pinion, wheel, C)
    found = sliding(pinion, wheel, C, [path.pitch_pinion])

    assert path.pitch_pinion == pytest.approx(13.030967, abs=5e-7)
    for value in (found.velocity, found.specific_pinion, found.specific_gear):
        assert value[0] == pytest.approx(0.0, abs=1e-13)
    assert found.equivalent_radius[0] == pytest.approx(8.69, abs=5e-3)


def test_sliding_velocity_is_what_two_turning_discs_have_at_one_point(pinion, wheel):
    """Velocities by ω × r of both gears at points on the line of action; the pinion turns at 1 rad/s."""
    at = C + 1.3
    alpha = math.acos((pinion.base_radius + wheel.base_radius) / at)
    rolls = np.linspace(4.0, 24.0, 9)
    normal = np.array([math.sin(alpha), math.cos(alpha)])
    start = pinion.base_radius * np.array([math.cos(alpha), -math.sin(alpha)])
    point = start + rolls[:, None] * normal
    first = np.stack([-point[:, 1], point[:, 0]], axis=1)
    arm = point - [at, 0.0]
    second = -0.5 * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    relative = first - second
    to_root = np.array([-normal[1], normal[0]])  # along the pinion's flank, against its radius

    np.testing.assert_allclose(relative @ normal, 0.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(sliding(pinion, wheel, at, rolls).velocity, relative @ to_root, rtol=0, atol=1e-12)


def test_specific_sliding_is_unbounded_at_the_base_circle(pinion, wheel):
    found = sliding(pinion, wheel, C, [0.0])

    assert found.specific_pinion[0] == -math.inf
    assert found.specific_gear[0] == 1.0


def test_roll_outside_the_line_is_refused(pinion, wheel):
    with pytest.raises(InputError, match=r"must lie from 0 to 39\.0929 mm, got -1 … 5"):
        sliding(pinion, wheel, C, [-1.0, 5.0])


def test_gears_that_do_not_reach_each_other(pinion, wheel):
    with pytest.raises(InputError, match="path of contact is empty"):
        path_of_contact(pinion, wheel, 130.0)

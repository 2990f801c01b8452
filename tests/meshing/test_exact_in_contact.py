"""The exact relations against rigid contact of the same flanks, which knows nothing of them: pairs of every kind, drawn at random."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwear.design import Gear, GearSpec
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.backlash import zero_backlash_centre_distance
from gearwear.meshing.clearance import bottoming_centre_distance, closest_centre_distance, interference
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.path import radius_at_roll, sliding


@st.composite
def pairs(draw):
    """Shifted, thinned, chamfered gears of any ratio, u = 1 and u < 1 with them, nearer and farther than they were designed for."""
    module = draw(st.sampled_from([0.5, 2.0, 6.35, 12.0]))
    angle = math.radians(draw(st.sampled_from([17.5, 20.0, 25.0])))
    teeth = draw(st.integers(8, 60))
    other = draw(st.one_of(st.integers(8, 90), st.just(teeth)))
    try:
        first, second = (
            Gear.from_spec(
                GearSpec(
                    name, z, module, 10.0, angle, profile_shift=draw(st.floats(-0.2, 0.7)), addendum=draw(st.floats(0.7, 1.1)),
                    dedendum=draw(st.floats(1.25, 1.4)), rack_tip_radius=draw(st.sampled_from([0.1, 0.25, 0.38])),
                    thinning=draw(st.floats(0.0, 0.12)) * module, tip_chamfer=draw(st.sampled_from([0.0, 0.08])) * module,
                )
            )
            for name, z in (("pinion", teeth), ("gear", other))
        )  # fmt: skip
        at = zero_backlash_centre_distance(first, second) + draw(st.floats(-0.1, 0.5)) * module
        exact = exact_meshing(first, second, at)
    except InputError:
        assume(False)
    assume(min(exact.tip_clearance_pinion, exact.tip_clearance_gear) > 1e-3 * module)
    return first, second, exact


def contact(first, second, exact, side=Side.LEFT, positions=5):
    return mesh_contact(
        nominal_profiles(first),
        nominal_profiles(second),
        exact.centre_distance,
        side,
        positions_per_pitch=positions,
        cycle="pitch",
    )


@pytest.mark.long
@settings(max_examples=8, deadline=None)
@given(pairs(), st.sampled_from(list(Side)))
def test_backlash_and_error_are_what_the_flanks_do(pair, side):
    first, second, exact = pair
    found = contact(first, second, exact, side)
    digs = max(exact.interference_pinion.penetration, exact.interference_gear.penetration)
    if digs == 0.0 and exact.path.contact_ratio >= 1.0:
        assert np.abs(found.transmission_error).max() < 1e-7 * first.transverse_module
        np.testing.assert_allclose(found.backlash, exact.backlash.normal, rtol=0, atol=1e-7 * first.transverse_module)
    elif digs > 1e-4 * first.transverse_module:
        found = contact(first, second, exact, side, 40)  # a corner may be in the fillet for a small part of a pitch
        assert found.transmission_error_max.value > 0.0, "a corner in the fillet pushes the mate ahead"
    else:
        assert found.transmission_error.max() < 1e-3 * first.transverse_module, "nothing in the way: no flank runs ahead"


@pytest.mark.long
@settings(max_examples=15, deadline=None)
@given(pairs())
def test_contact_stays_on_the_active_profiles(pair):
    first, second, exact = pair
    clear = max(exact.interference_pinion.penetration, exact.interference_gear.penetration) == 0.0
    assume(clear and exact.path.contact_ratio >= 1.0)
    found = contact(first, second, exact)
    tolerance = 1e-3 * first.transverse_module
    for radius, gear, start, end in (
        (found.driver_radius, first, exact.path.start_pinion, exact.path.end_pinion),
        (found.driven_radius, second, exact.path.start_gear, exact.path.end_gear),
    ):
        low, high = radius_at_roll(gear, [start, end])
        assert low - tolerance <= radius.min() and radius.max() <= high + tolerance


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(pairs())
def test_swapping_the_gears_swaps_everything(pair):
    first, second, exact = pair
    other = exact_meshing(second, first, exact.centre_distance)
    assert other.tip_clearance_gear == exact.tip_clearance_pinion
    assert other.interference_gear == exact.interference_pinion
    assert other.path.length == pytest.approx(exact.path.length, abs=1e-12 * exact.centre_distance)
    assert (other.path.limit_gear, other.path.limit_pinion) == (exact.path.limit_pinion, exact.path.limit_gear)
    roll = np.linspace(exact.path.start_pinion, exact.path.end_pinion, 7)[1:-1]
    one, two = (
        sliding(first, second, exact.centre_distance, roll),
        sliding(second, first, exact.centre_distance, exact.path.line - roll),
    )
    np.testing.assert_allclose(one.specific_pinion, two.specific_gear, rtol=1e-9, atol=1e-9)
    # The same sliding, seen from the other gear, whose angular velocity is u times less.
    np.testing.assert_allclose(
        one.velocity, -two.velocity * first.teeth / second.teeth, rtol=1e-9, atol=1e-9 * exact.centre_distance
    )
    np.testing.assert_allclose(one.equivalent_radius, two.equivalent_radius, rtol=1e-9)


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(pairs(), st.floats(0.01, 0.4))
def test_moving_apart_shortens_the_path_and_opens_everything(pair, further):
    first, second, exact = pair
    try:
        far = exact_meshing(first, second, exact.centre_distance + further * first.transverse_module)
    except InputError:
        return  # out of reach
    if exact.path.limit_pinion == exact.path.limit_gear == "mate's tip":  # ended by form circles, it first grows
        assert far.path.length <= exact.path.length + 1e-12 * exact.centre_distance
    assert far.backlash.normal > exact.backlash.normal
    assert far.tip_clearance_pinion > exact.tip_clearance_pinion
    assert far.interference_pinion.overrun < exact.interference_pinion.overrun
    assert far.interference_pinion.penetration <= exact.interference_pinion.penetration + 1e-9 * first.transverse_module


@pytest.mark.long
@settings(max_examples=20, deadline=None)
@given(pairs())
def test_the_closest_distance_is_where_the_first_touch_is(pair):
    first, second, _ = pair
    closest = closest_centre_distance(first, second)
    bottom = max(
        bottoming_centre_distance(first, second), first.base_radius + second.base_radius
    )  # or the base circles meet first
    step = 1e-4 * first.transverse_module
    touching = [
        max(interference(first, second, at).penetration, interference(second, first, at).penetration)
        for at in (closest - step, closest + step)
        if at > first.base_radius + second.base_radius
    ]
    assert closest >= bottom
    assert touching[-1] == 0.0
    assert closest < bottom + step or touching[0] > 0.0

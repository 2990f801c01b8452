"""What a message gives as the limit is kept by who follows it, and never reads like the value that is refused."""

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwear.design import Gear, GearSpec, PairSpec
from gearwear.design.involute import inverse_involute, involute_function
from gearwear.design.pair import CENTRE_ROUNDING, check_pair
from gearwear.design.profiles import nominal_profiles
from gearwear.design.quantity import at_least, at_most, not_zero
from gearwear.errors import InputError
from gearwear.inspection import Settings
from gearwear.inspection.prepared import check_settings
from gearwear.meshing.contact import mesh_contact

GEAR = GearSpec("gear", 31, 1.0 + 1.0 / 3.0, 15.0)
ALONE = Gear.from_spec(GEAR)


@given(st.floats(-1e6, 1e6), st.integers(0, 6))
def test_limits_are_rounded_to_their_safe_side(limit, digits):
    last, noise = 10.0**-digits, 1e-6 * 10.0**-digits + 1e-9 * abs(limit)
    assert -noise <= float(at_least(limit, digits)) - limit < last + noise
    assert -noise <= limit - float(at_most(limit, digits)) < last + noise


@given(st.floats(-1.0, 1.0), st.integers(0, 6))
def test_nothing_that_is_not_zero_reads_zero(value, digits):
    assert (float(not_zero(value, digits)) == 0.0) == (value == 0.0)
    assert not re.fullmatch(r"-0\.?0*", not_zero(value, digits))


def _pair(ring: bool, loss: float) -> tuple[Gear, Gear, float]:
    """A pair and its distance without backlash: inv α0 = inv α ∓ loss / 2C, C0 = C cos α / cos α0."""
    module, alpha, teeth = 2.0, math.radians(20.0), (19, 60) if ring else (19, 30)
    pinion = Gear.from_spec(GearSpec("pinion", teeth[0], module, 15.0, thinning=loss))
    gear = Gear.from_spec(GearSpec("gear", teeth[1], module, 15.0, internal=ring, addendum=0.6 if ring else 1.0))
    centre, way = 0.5 * module * (teeth[1] - teeth[0] if ring else sum(teeth)), -1.0 if ring else 1.0
    without = involute_function(alpha) - way * loss / (2.0 * centre)
    return pinion, gear, centre * math.cos(alpha) / math.cos(inverse_involute(without))


@pytest.mark.parametrize("ring", [False, True])
@pytest.mark.parametrize("digits", [3, 4, 5])
def test_a_distance_without_backlash_is_taken_as_it_is_written(ring, digits):
    rounded = math.ceil if ring else math.floor  # the side on which teeth overlap
    for loss in (0.01, 0.0237, 0.0451, 0.1):
        pinion, gear, zero = _pair(ring, loss)
        nearest = round(zero, digits)
        beyond = rounded(zero * 10**digits) / 10**digits if digits > 3 else nearest
        for written in {nearest, beyond}:
            check_pair(pinion, gear, PairSpec(written))
            assert abs(written - zero) <= CENTRE_ROUNDING


@pytest.mark.parametrize("ring", [False, True])
@pytest.mark.parametrize("beyond", [5.1e-4, 6e-4, 1e-2])
def test_teeth_that_jam_are_told_by_how_much_and_what_would_do(ring, beyond):
    pinion, gear, zero = _pair(ring, 0.0451)
    with pytest.raises(InputError) as refused:
        check_pair(pinion, gear, PairSpec(zero + beyond if ring else zero - beyond))
    said = str(refused.value)
    play, right = (float(part) for part in re.search(r"would be (\S+) mm;.* \(at \w+ (\S+) mm\)", said).groups())
    # ∂j/∂a = 2 tan α_w on the working circles; the decimals that are told
    assert play == pytest.approx(
        -2.0 * beyond * math.tan(math.acos(abs(gear.base_radius + (-1 if ring else 1) * pinion.base_radius) / zero)),
        rel=0.01,
        abs=5e-5,
    )
    check_pair(pinion, gear, PairSpec(right))


def test_tips_that_touch_the_root_to_the_digits_of_the_distance_turn():
    """Half-depth teeth: tip on root at the distance 31.0001234, that the drawing rounds; the contact takes it too."""
    spec = GearSpec("pinion", 31, 1.0, 15.0, addendum=1.0, dedendum=1.0 - 1.234e-4, rack_tip_radius=0.0, thinning=0.05)
    pinion = Gear.from_spec(spec)
    gear = Gear.from_spec(replace(spec, name="gear"))
    with pytest.raises(InputError, match="needed"):
        check_pair(pinion, gear, PairSpec(30.9994))
    flanks = [nominal_profiles(g, np.linspace(g.form_radius, g.tip_radius, 40), np.array([7.5])) for g in (pinion, gear)]
    assert mesh_contact(*flanks, 31.0, cycle="pitch").backlash.min() > 0.0
    with pytest.raises(InputError, match="tips meet roots"):
        mesh_contact(*flanks, 30.9994, cycle="pitch")


def _settings(**given: object) -> None:
    check_settings(Settings(**given), ALONE)


def _thickness(radius: float) -> None:
    nominal_profiles(ALONE, np.linspace(ALONE.root_radius, ALONE.tip_radius, 9), np.array([7.5])).thickness(radius)


LIMITS: list[tuple[str, Callable[[float], object], float, float]] = [
    ("bore_diameter, below", lambda value: Gear.from_spec(replace(GEAR, bore_diameter=value)), 2.0 * ALONE.root_radius, 1.0),
    ("pitch_roll", lambda value: _settings(pitch_roll=value), ALONE.tip_roll, 1.0),
    ("pitch_roll below", lambda value: _settings(pitch_roll=value), ALONE.form_roll, -1.0),
    ("radius", _thickness, ALONE.tip_radius, 1.0),
]


@pytest.mark.parametrize(("name", "check", "limit", "way"), LIMITS, ids=[row[0] for row in LIMITS])
@pytest.mark.parametrize("beyond", [2e-6, 1e-5, 1e-3])
def test_the_value_refused_and_its_limit_are_told_apart(name, check, limit, way, beyond):
    with pytest.raises(InputError) as refused:
        check(limit + way * beyond)
    told = re.findall(r"-?\d+\.?\d*", str(refused.value))
    value = min(told, key=lambda number: abs(float(number) - limit - way * beyond))
    kept = [float(number) for number in told if number != value and abs(float(number) - limit) < 1.1e-3]
    assert kept
    for right in kept:
        assert way * (float(value) - right) > 0.0
        check(right - 1e-9 if "below" in str(refused.value) else right)

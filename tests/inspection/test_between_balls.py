"""Between pins and balls of rings: a published case, a ball laid in the space, and thinner teeth measured."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from gearwear.inspection.dimensions import measured_over_pins, over_pins, pins_touching, span
from gearwear.inspection.estimate import Estimate
from tests.design.test_ring import helicoid

RINGS = {
    name: Gear.from_spec(GearSpec("gear", teeth, 2.0, 20.0, helix_angle=math.radians(degrees), internal=True, **more))
    for name, teeth, degrees, more in (
        ("spur", 44, 0.0, {"addendum": 0.7}),
        ("odd, thin teeth", 51, 0.0, {"addendum": 0.8, "profile_shift": -0.3}),
        ("left 20", 60, -20.0, {"profile_shift": 0.2, "addendum": 0.8}),
        ("right 30", 48, 30.0, {"addendum": 0.8, "thinning": 0.1}),
    )
}
every_ring = pytest.mark.parametrize("gear", RINGS.values(), ids=RINGS.keys())


def test_published_measurement_between_pins():
    """z 12, DP 24, 20°, thickness half the pitch, pins of 0.060 inch: 0.444260 inch between them (a reference calculator's)."""
    gear = Gear.from_spec(GearSpec("gear", 12, 25.4 / 24.0, 10.0, addendum=0.3, internal=True))
    assert over_pins(gear, 0.060 * 25.4).length / 25.4 == pytest.approx(0.444260, abs=6e-7)


@every_ring
@pytest.mark.parametrize("share", [0.15, 0.35])
def test_a_ball_in_the_space_touches_both_flanks(gear, share):
    """Its centre, laid at mid-face on the space's middle, is half its diameter from the helicoids on both sides."""
    pins = pins_touching(gear, gear.tip_roll + share * (gear.form_roll - gear.tip_roll))
    assert pins is not None
    middle = 0.5 * gear.pitch_angle
    centre = np.array([pins.centre_radius * math.cos(middle), pins.centre_radius * math.sin(middle), 0.5 * gear.face_width])
    for side, tooth in ((1, 0), (-1, 1)):
        best = least_squares(
            lambda at, s=side, k=tooth: helicoid(gear, s, k, at[0], at[1]) - centre,
            [pins.roll, 0.5 * gear.face_width],
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
        assert np.linalg.norm(best.fun) == pytest.approx(0.5 * pins.diameter, abs=1e-10)
        assert best.x[0] == pytest.approx(pins.roll, abs=1e-5)
    odd = math.cos(0.5 * math.pi / gear.teeth) if gear.teeth % 2 else 1.0
    assert pins.length == pytest.approx(2.0 * pins.centre_radius * odd - pins.diameter, rel=1e-14)


@every_ring
def test_thinner_teeth_are_measured_as_those_of_a_thinner_design(gear):
    """Less metal on both sides: balls sink outwards, the measure between them grows."""
    thinner = Gear.from_spec(replace(gear.spec, thinning=gear.spec.thinning + 0.08))
    pins = over_pins(gear)
    lost = gear.base_radius * (gear.base_half_angle - thinner.base_half_angle)
    flanks = Estimate.plain(np.full((gear.teeth, 2), -lost), np.full((gear.teeth, 2), 1e-3))
    found = measured_over_pins(flanks, gear, pins).value
    assert found == pytest.approx(np.full_like(found, over_pins(thinner, pins.diameter).length), abs=1e-11)
    assert found[0] > pins.length


def test_what_cannot_be_measured_is_refused_by_name():
    gear = RINGS["spur"]
    with pytest.raises(InputError, match="a span of internal gears"):
        span(gear)
    for diameter, said in ((1.0, "touches at a roll length"), (2.0, "does not stand out of the tip"), (12.0, "does not go into")):
        with pytest.raises(InputError, match=said):
            over_pins(gear, diameter)

"""The published calculation as printed."""

import math

import pytest

from gearwear.design import Baseline, Gear, GearSpec
from gearwear.errors import InputError
from gearwear.meshing.published import contact_length, published_meshing

ALLOWANCE = 0.2286


def test_the_papers_own_numbers(pinion, wheel):
    found = published_meshing(pinion, wheel, 114.3, 1.992, ALLOWANCE)

    assert found.backlash == pytest.approx(1.7634, abs=1e-12)
    assert found.centre_distance_change == pytest.approx(-2.42245, abs=5e-6)
    assert found.centre_distance == pytest.approx(116.72245, abs=5e-6)
    assert math.degrees(found.pressure_angle) == pytest.approx(23.0461, abs=5e-5)
    assert found.contact_length_design == pytest.approx(28.327550, abs=5e-7)


def test_what_follows_from_the_printed_centre_distance(pinion, wheel):
    """The paper goes on with 116.722; a loss that leads there gives its later numbers."""
    loss = 2 * 2.422 * math.tan(math.radians(20)) + ALLOWANCE
    found = published_meshing(pinion, wheel, 114.3, loss, ALLOWANCE)

    assert found.centre_distance == pytest.approx(116.722, abs=1e-12)
    assert math.degrees(found.pressure_angle) == pytest.approx(23.0456, abs=5e-5)
    assert found.pitch_radius_pinion == pytest.approx(38.9073, abs=5e-5)
    assert found.pitch_radius_gear == pytest.approx(77.8147, abs=5e-5)
    assert found.contact_length_worn == pytest.approx(21.728108, abs=5e-7)


@pytest.mark.parametrize(
    ("tip_radii", "base_radii", "design", "worn"),
    [
        ((44.5, 82.6), None, 28.512218, 21.912776),
        ((44.5, 82.55), None, 28.412, 21.812),
        ((44.45, 82.55), (35.8, 71.6), 28.339, 21.750),
        ((44.5, 82.6), (35.8, 71.6), 28.523, 21.934),
    ],
)
def test_contact_lengths_with_rounded_inputs(pinion, wheel, tip_radii, base_radii, design, worn):
    at = 116.722
    bases = base_radii or (pinion.base_radius, wheel.base_radius)
    angle = math.acos((pinion.base_radius + wheel.base_radius) / at)
    digits = 5e-7 if base_radii is None and tip_radii == (44.5, 82.6) else 6e-4

    assert contact_length(*tip_radii, *bases, 114.3, math.radians(20)) == pytest.approx(design, abs=digits)
    if base_radii is None:
        assert contact_length(*tip_radii, *bases, at, angle) == pytest.approx(worn, abs=digits)


def test_contact_length_with_both_roundings(pinion, wheel):
    at = 116.722
    found = contact_length(44.5, 82.6, pinion.base_radius, wheel.base_radius, at, math.radians(23.04))

    assert found == pytest.approx(21.923203, abs=5e-7)


@pytest.mark.parametrize(
    ("baseline", "backlash"),
    [(Baseline.ZERO_BACKLASH, 1.7634), (Baseline.WITH_ALLOWANCE, 2.2206), (Baseline.PRE_WEAR_SCAN, 2.2206)],
)
def test_the_baseline_decides_how_the_allowance_counts(pinion, wheel, baseline, backlash):
    found = published_meshing(pinion, wheel, 114.3, 1.992, ALLOWANCE, baseline)

    assert found.backlash == pytest.approx(backlash, abs=1e-12)
    assert found.centre_distance_change == pytest.approx(-backlash / (2 * math.tan(math.radians(20))), abs=1e-12)


def test_nothing_lost_and_nothing_allowed_changes_nothing(pinion, wheel):
    found = published_meshing(pinion, wheel, 114.3, 0.0)

    assert found.centre_distance == 114.3
    assert found.contact_length_worn == found.contact_length_design


def test_any_pair_starts_from_its_own_working_angle():
    first = Gear.from_spec(GearSpec("pinion", 20, 2.0, 10.0, profile_shift=0.3))
    second = Gear.from_spec(GearSpec("gear", 40, 2.0, 10.0))
    found = published_meshing(first, second, 60.6, 0.1)
    angle = math.acos(60.0 * math.cos(math.radians(20)) / 60.6)

    assert found.centre_distance == pytest.approx(60.6 + 0.1 / (2 * math.tan(angle)), abs=1e-12)
    assert found.pitch_radius_gear == pytest.approx(2 * found.pitch_radius_pinion, rel=1e-14)


def test_a_thicker_tooth_is_a_negative_loss(pinion, wheel):
    thicker, worn = (published_meshing(pinion, wheel, 114.3, loss) for loss in (-0.01, 0.01))

    assert thicker.centre_distance_change == -worn.centre_distance_change


@pytest.mark.parametrize("loss", [math.nan, math.inf])
def test_a_loss_that_is_no_number_is_refused(pinion, wheel, loss):
    with pytest.raises(InputError, match=r"thickness loss = (nan|inf) mm: must be a finite number"):
        published_meshing(pinion, wheel, 114.3, loss)

"""How a helical pair ran, asked back of maps worn by another model of elastic teeth: no scan, and no part of the fit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.running.conditions import Conditions, over_common_face
from gearwear.running.study import law_basis
from gearwear.wear_law.archard import LoadSharing
from tests.running.helical_maps import AMOUNT_UM, SLICES, STRIPS, map_of, ran, runs_on, traced


@pytest.mark.long
def test_misalignment_is_asked_back():
    """On a left-hand gear; below, the other side of the other hand is the mirror image."""
    gap = -30.0
    found = traced(ran(-15.0, gap_um=gap))
    named = found.effect("misalignment")
    assert {effect.name for effect in found.effects} == {"misalignment"} and named is not None
    size = named.parameters["gap_um"]
    assert isinstance(size.value, float) and isinstance(size.std, float)
    assert abs(size.value - gap) < min(10.0, 2.0 * size.std)
    assert found.after.held_out < 0.3 * found.before.held_out
    assert 1e3 * found.amount == pytest.approx(AMOUNT_UM, rel=0.15)  # what the other model's compliance moves it by


@pytest.mark.long
def test_nothing_askew_is_named_where_the_pair_ran_aligned():
    found = traced(ran())
    assert {effect.name for effect in found.effects} <= {"elastic_sharing"}
    assert 1e3 * found.amount == pytest.approx(AMOUNT_UM, rel=0.1)
    assert math.isnan(found.before.double_contact)  # no place of a helical flank carries alone


@pytest.mark.long
def test_a_gap_the_other_way_is_no_mirror_image_and_the_other_side_of_the_other_hand_is_one():
    """Seen in a mirror across the axis a right-hand gear's left flanks are a left-hand one's right flanks; a gap along the axis stays."""
    place, other = (map_of(ran(beta, side=side)) for beta, side in ((20.0, 1), (-20.0, -1)))
    runs, mirrored = runs_on(place, ran(20.0)), runs_on(other, ran(-20.0, side=-1))
    askew = Conditions(misalignment=0.03)
    np.testing.assert_allclose(runs.of(askew), mirrored.of(askew), atol=1e-9)
    up, down = (runs.of(replace(askew, misalignment=gap))[-1].reshape(SLICES, STRIPS) for gap in (0.03, -0.03))
    assert up.mean() == pytest.approx(down.mean(), rel=0.05)
    assert np.abs(up[::-1] - down).max() > 0.1 * up.max()


def test_what_meets_no_mate_is_not_worn():
    """A pinion 24 mm wide on a mate of 16: mid-faces stand at one height, of spur gears too."""
    met = [0.0, 1.0, 1.0, 1.0, 1.0, 0.0]
    for beta in (20.0, 0.0):
        one, two = (Gear.from_spec(GearSpec(n, z, 2.5, b, helix_angle=w * math.radians(beta))) for n, z, b, w in (("p", 17, 24.0, 1), ("g", 31, 16.0, -1)))  # fmt: skip
        place = replace(map_of(ran()), gear=one)
        for slices in (1, 6):
            np.testing.assert_allclose(over_common_face(place, two, slices).sum(axis=1), met, atol=1e-12)
        basis = law_basis(place, two, one.reference_radius + two.reference_radius, LoadSharing.NONE).reshape(SLICES, STRIPS, 3)
        assert (basis[np.array(met) == 0.0] == 0.0).all() and (basis[np.array(met) == 1.0, :, 1] == 1.0).all()

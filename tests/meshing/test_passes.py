"""Which pairs of teeth are worked out, and that a position is what it is however it is asked for."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.profiles import ToothProfiles, nominal_profiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.meshing.passes import Passes
from gearwear.meshing.slices import Slices
from gearwear.meshing.tooth_pair import ToothPairs

N = 5


def worn(name: str, teeth: int, helix: float) -> ToothProfiles:
    gear = Gear.from_spec(GearSpec(name, teeth, 2.0, 10.0, helix_angle=math.radians(helix)))
    profiles = nominal_profiles(gear, np.linspace(gear.root_radius, gear.tip_radius, 40), np.linspace(1.0, 9.0, 3))
    profiles.half_angle[...] -= 0.02 / gear.base_radius * np.random.default_rng(teeth).random(profiles.half_angle.shape)
    return profiles


@pytest.fixture(scope="module", params=[0.0, 25.0], ids=["spur", "helical"])
def run(request: pytest.FixtureRequest) -> Passes:
    pair = worn("pinion", 17, request.param), worn("gear", 23, -request.param)
    centre = 40.05 / math.cos(math.radians(request.param))
    return Passes.of(*Slices.of(*pair).cut(*pair), centre, Side.RIGHT, N, 4)


def test_a_position_by_itself_is_that_of_its_pass(run: Passes) -> None:
    passes, _ = run.positions(run.block(2, 5), 0.0)
    alone, _ = run.positions(run.places(np.arange(2 * N, 5 * N) / N), 0.0)
    for field in fields(passes):
        a, b = getattr(passes, field.name), getattr(alone, field.name)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-12, err_msg=field.name)


def test_the_pairs_that_no_position_of_a_pass_has_are_not_worked_out(run: Passes) -> None:
    block = run.block(7, 8)
    begin, end = block.picked()
    contact = run.contact(run.side, block)
    row = np.arange(len(block.tooth) * block.slices)
    picked = (row >= begin[:, None]) & (row < end[:, None])
    assert picked.mean() == pytest.approx(1.0 / len(run.columns()))
    assert not np.isfinite(contact.advance[~picked]).any()
    ahead = run.side * run.phase
    every = ToothPairs.of(*run.flanks(run.side, block.tooth), run.centre, ahead).contact(block.angles)
    assert np.isfinite(every.advance[~picked]).any()
    for name in ("advance", "radius", "mate_radius"):
        np.testing.assert_array_equal(getattr(contact, name)[picked], getattr(every, name)[picked])
        np.testing.assert_array_equal(block.by_position(getattr(contact, name)), block.by_position(getattr(every, name)))

"""Points inside teeth: none that is deep is left out by the bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import flank_points
from gearwear.wear.inside_tooth import depth_inside, perhaps_inside
from tests.placing.placing import designed
from tests.synthetic import GearNumbers, Recipe, make_scan
from tests.synthetic.edges import bevelled, height_of

GEARS = {
    "spur": GearSpec("", 25, 3.0, 20.0),
    "undercut": GearSpec("", 9, 4.0, 12.0),
    "helical": GearSpec("", 20, 2.0, 15.0, helix_angle=0.35),
    "ring": GearSpec("", 60, 2.0, 10.0, internal=True),
}


@pytest.mark.parametrize("kind", GEARS)
def test_all_that_are_deep_are_asked(kind):
    gear, random = Gear.from_spec(GEARS[kind]), np.random.default_rng(1)
    low, high = sorted((gear.root_radius, gear.tip_radius))
    radius, angle = random.uniform(0.98 * low, 1.02 * high, 200_000), random.uniform(-np.pi, np.pi, 200_000)
    z = random.uniform(-0.1, 1.1, 200_000) * gear.face_width
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])
    least = 0.03 * gear.transverse_module
    tooth, depth, _ = depth_inside(points, gear)
    same, asked = perhaps_inside(points, gear, least)
    np.testing.assert_array_equal(same, tooth)
    deep = depth > least
    assert deep.sum() > 10_000
    assert np.isin(np.flatnonzero(deep), asked).all()
    assert len(asked) < 1.2 * deep.sum()  # or it would save nothing


def test_a_bevel_of_the_tip_is_no_place_inside():
    """As deep as 0.38 mm below the flank drawn on; off the straight line from flank to land by its bend, some hundredths."""
    numbers = GearNumbers(20, 3.0, 20.0, 20.0, 0.1)
    sharp, height = designed(numbers), height_of(numbers, 0.45)
    half = [float(sharp.half_angle(radius)) for radius in (sharp.tip_radius - height, sharp.tip_radius)]
    leg = (half[0] - half[1]) * sharp.tip_radius + 0.45
    gear = Gear.from_spec(replace(sharp.spec, tip_chamfer=height, tip_chamfer_land=leg))
    points = bevelled(make_scan(Recipe(gear=numbers, noise_um=0.0, pose="none").of_size(20_000), 1).points, numbers, 0.45, 0.45)
    on_bevel = np.hypot(*points[:, :2].T) > gear.flank_end_radius
    assert on_bevel.sum() > 500
    assert depth_inside(points[on_bevel], sharp)[1].max() > 0.1
    assert np.abs(depth_inside(points[on_bevel], gear)[1]).max() < 0.03


@pytest.mark.parametrize("key", ["end_chamfer", "end_rounding"])
def test_an_end_edge_as_drawn_is_no_place_inside(key):
    """On a chamfer of 0.4 mm points lie to 0.2 mm below flank and end both: on the plane through its edges they are on the surface, and 0.3 mm under
    it they are as deep as that. A rounding lies outside that plane."""
    size = 0.4
    sharp, gear = Gear.from_spec(GEARS["spur"]), Gear.from_spec(replace(GEARS["spur"], **{key: size}))
    roll, share = np.linspace(gear.form_roll + 1.0, gear.tip_roll - 1.5, 36), np.tile(np.linspace(0.1, 0.9, 9), 4)
    number, sides = np.arange(36) % gear.teeth, np.arange(36) % 2 * 2 - 1
    for end in (0, 1):
        height = share * size
        flank = flank_points(gear, number, sides, roll, np.full(36, 5.0))
        points = flank.position - ((1.0 - share) * size)[:, None] * flank.normal
        points[:, 2] = np.where(end, gear.face_width - height, height)
        assert depth_inside(points, sharp)[1].max() == pytest.approx(0.5 * size)
        np.testing.assert_allclose(depth_inside(points, gear)[1], 0.0, atol=1e-9)
        under = points - 0.3 * np.sqrt(0.5) * (flank.normal + np.array([0.0, 0.0, 1.0 if end else -1.0]))
        np.testing.assert_allclose(depth_inside(under, gear)[1], np.minimum(0.3, depth_inside(under, sharp)[1]), atol=1e-9)

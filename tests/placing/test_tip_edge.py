"""Edges between flanks and tips that nobody drew: found where they begin, and not where there are none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK, locate
from gearwear.placing.tip_edge import STEP, fit_tip_edge
from tests.placing.placing import designed
from tests.synthetic import Effect, GearNumbers, Recipe, SlidingWear, make_scan
from tests.synthetic.edges import bevelled, height_of

NUMBERS = GearNumbers(20, 3.0, 20.0, 20.0, 0.1)
GEAR = designed(NUMBERS)
NOISE_UM = 6.0


@cache
def points(*wear, effects=(), noise_um=NOISE_UM):
    """A scan in the design's frame; `effects` as pairs of name and parameters."""
    named = tuple(Effect(name, dict(parameters)) for name, parameters in effects)
    recipe = Recipe(gear=NUMBERS, jitter=1.0, noise_um=noise_um, wear=wear, effects=named, pose="none")
    return make_scan(recipe.of_size(80_000), 4).points


def found(cloud, gear=GEAR, noise_um=NOISE_UM):
    return fit_tip_edge(locate(cloud, gear), gear, 1e-3 * noise_um)


@pytest.mark.parametrize(
    ("flank", "land", "slid"),
    [(0.30, 0.15, 0.0), (0.45, 0.45, 0.0), (0.8, 0.4, 0.0), (0.2, 0.3, 0.0), (0.45, 0.45, 80.0), (0.8, 0.4, 80.0)],
    ids=str,
)
def test_where_a_bevel_begins_and_how_deep_it_is(flank, land, slid):
    """Where it ends on the land, it lies below the drawn flank, along its normal, by r_b times the angle."""
    edge = found(bevelled(points(*[SlidingWear(slid, 1)] * (slid > 0.0)), NUMBERS, flank, land))
    begins, depth = height_of(NUMBERS, flank), land * GEAR.base_radius / GEAR.tip_radius
    assert -0.5 * STEP * 3.0 < edge.height - begins < 1.5 * STEP * 3.0
    assert abs(edge.depth - depth) < 1.5 * STEP * 3.0
    assert edge.gear.flank_end_radius == pytest.approx(GEAR.tip_radius - edge.height, abs=1e-9)
    assert "chamfered or rounded" in edge.words() and f"{edge.height:.2f} mm" in edge.words()


@pytest.mark.parametrize(
    "cloud",
    [
        lambda: points(),
        lambda: points(SlidingWear(150.0, 1)),
        lambda: points(SlidingWear(80.0, 1), SlidingWear(60.0, -1)),
        lambda: points(effects=(("tip_relief", (("amount_um", 65.0), ("start_mm", 16.0))),)),
        lambda: bevelled(points(), NUMBERS, 0.45, 0.45, np.arange(40).reshape(20, 2) % 2 == 0),
        lambda: bevelled(points(), NUMBERS, 0.45, 0.45, np.arange(40).reshape(20, 2) % 4 > 1),
        lambda: bevelled(points(), NUMBERS, 0.05, 0.05),
        lambda: bevelled(points(), NUMBERS, 0.3, 0.05),
    ],
    ids=["none", "one side slid", "both sides slid", "tip relief", "one side's", "every second tooth's", "small", "shallow"],
)
def test_what_is_no_edge_of_all_flanks(cloud):
    edge = found(cloud())
    assert edge.fits_design and edge.gear is GEAR and edge.words() == ""


@pytest.mark.parametrize(("drawn", "kept"), [(0.38, True), (0.25, False), (0.60, True)])
def test_an_edge_that_is_drawn_is_not_looked_for_again(drawn, kept):
    """The bevel ends 0.38 mm below the tip."""
    gear = Gear.from_spec(replace(GEAR.spec, tip_chamfer=drawn))
    edge = found(bevelled(points(), NUMBERS, 0.45, 0.45), gear)
    assert edge.fits_design is kept
    assert height_of(NUMBERS, 0.45) == pytest.approx(0.38, abs=0.01)


@pytest.mark.parametrize(("deep", "reach"), [(0.03, 0.3), (0.045, 0.4)], ids=str)
def test_of_a_scan_that_was_smoothed_a_shallow_rounding_is_an_edge_to_where_it_ends(deep, reach):
    """A parabola along the flank to its tip: below 5 µm it cannot be seen to go on, and does."""
    on = locate(points(), GEAR)
    along = (GEAR.tip_roll**2 - on.roll**2) / (2.0 * GEAR.base_radius)
    fall = np.where(on.surface == FLANK, deep * np.clip(1.0 - along / reach, 0.0, 1.0) ** 2, 0.0)
    cloud = points() - fall[:, None] * on.normal
    assert found(cloud).fits_design
    edge = fit_tip_edge(locate(cloud, GEAR), GEAR, 1e-3 * NOISE_UM, smoothed=True)
    ends = GEAR.tip_roll**2 - 2.0 * GEAR.base_radius * reach
    height = GEAR.tip_radius - np.hypot(GEAR.base_radius, np.sqrt(ends))
    assert abs(edge.height - height) < 2.0 * STEP * 3.0
    sharp = fit_tip_edge(locate(points(), GEAR), GEAR, 1e-3 * NOISE_UM, smoothed=True)
    assert sharp.fits_design


def test_too_few_points_say_nothing():
    cloud = bevelled(points(), NUMBERS, 0.45, 0.45)
    assert found(cloud[:: len(cloud) // 500]).fits_design
    low = cloud[np.hypot(*cloud[:, :2].T) < GEAR.tip_radius - 2.5]
    assert found(low).fits_design and found(cloud[:0]).fits_design

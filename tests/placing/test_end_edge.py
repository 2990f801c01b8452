"""Edges at the ends of the face that nobody drew: found where they begin, and not where there are none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK, locate
from gearwear.placing.end_edge import fit_end_edge
from gearwear.placing.tip_edge import STEP
from tests.placing.placing import designed
from tests.synthetic import GearNumbers, Recipe, SlidingWear, make_scan
from tests.synthetic.edges import bevelled_ends

NUMBERS = GearNumbers(20, 3.0, 20.0, 20.0, 0.1)
GEAR = designed(NUMBERS)
NOISE = 0.006
EVERYWHERE = np.ones((2, 2))
ACUTE = np.array([[0.0, 1.0], [1.0, 0.0]])
"""Of right-hand helical teeth: right at the low end, left at the high one."""
BIN = STEP * GEAR.transverse_module


@cache
def points(*wear, size=80_000):
    """A scan in the design's frame."""
    recipe = Recipe(gear=NUMBERS, jitter=1.0, noise_um=1e3 * NOISE, wear=wear, pose="none")
    return make_scan(recipe.of_size(size), 4).points


def found(cloud, gear=GEAR):
    return fit_end_edge(locate(cloud, gear), gear, NOISE)


def relieved(cloud, most: float, length: float):
    """Flanks of both sides fall by so much, mm, over so much of the face at either end: a bevel that shallow."""
    return bevelled_ends(cloud, NUMBERS, length * EVERYWHERE, most * EVERYWHERE)


@pytest.mark.parametrize(
    ("reach", "depth"),
    [
        (0.3 * EVERYWHERE, 0.3 * EVERYWHERE),
        (0.5 * EVERYWHERE, 0.5 * EVERYWHERE),
        (1.0 * EVERYWHERE, 0.6 * EVERYWHERE),
        (np.array([[0.8, 0.8], [0.0, 0.0]]), np.array([[0.8, 0.8], [0.0, 0.0]])),
        (0.3 + 0.5 * ACUTE, 0.3 + 0.5 * ACUTE),
        (0.6 * ACUTE, 0.6 * ACUTE),
    ],
    ids=["0.3", "0.5", "flat", "one end", "acute ones larger", "acute ones alone"],
)
@pytest.mark.parametrize("slid", [(), (SlidingWear(80.0, 1),)], ids=["unworn", "slid"])
def test_where_bevels_begin_and_how_deep_they_are(reach, depth, slid):
    edge = found(bevelled_ends(points(*slid), NUMBERS, reach, depth))
    there = reach > 0.0
    seen, deep = np.array(edge.reach), np.array(edge.depth)
    assert ((seen > 0.0) == there).all()
    assert (np.abs(seen - reach)[there] < 2.0 * BIN).all()
    # Told a bin from the end, where a bevel has lost that much of its depth.
    assert (
        np.abs(deep - depth * (1.0 - 1.5 * BIN / np.maximum(reach, BIN)))[there]
        < 2.0 * BIN * (depth / np.maximum(reach, BIN))[there]
    ).all()
    assert (np.array(edge.gear.spec.end_edges)[there] > seen[there]).all()
    ends = "both ends" if there.any(axis=1).all() else "the low end"
    assert f"flanks at {ends} of the face" in edge.words()


def test_thin_scans_show_them_too():
    edge = found(bevelled_ends(points(size=30_000), NUMBERS, 0.4 * EVERYWHERE, 0.4 * EVERYWHERE))
    assert (np.abs(np.array(edge.reach) - 0.4) < 3.0 * BIN).all()


def test_of_a_scan_that_was_smoothed_a_shallow_rounding_is_an_edge_to_where_it_ends():
    """A parabola of 80 µm over 0.4 mm at either end, and on a third of the teeth less than half as deep."""
    on = locate(points(), GEAR)
    along = np.minimum(on.position[:, 2], GEAR.face_width - on.position[:, 2])
    deep = 0.08 * np.where(on.tooth % 3 == 0, 0.3, 1.0)
    fall = np.where(on.surface == FLANK, deep * np.clip(1.0 - along / 0.4, 0.0, 1.0) ** 2, 0.0)
    cloud = points() - fall[:, None] * on.normal
    assert found(cloud).fits_design
    edge = fit_end_edge(locate(cloud, GEAR), GEAR, NOISE, smoothed=True)
    assert (np.abs(np.array(edge.reach) - 0.4) < 2.0 * BIN).all()
    assert fit_end_edge(locate(points(), GEAR), GEAR, NOISE, smoothed=True).fits_design


@pytest.mark.parametrize(
    "cloud",
    [
        lambda: points(),
        lambda: points(SlidingWear(150.0, 1)),
        lambda: points(SlidingWear(80.0, 1), SlidingWear(60.0, -1)),
        lambda: relieved(points(), 0.04, 2.0),
        lambda: bevelled_ends(points(), NUMBERS, 0.5 * EVERYWHERE, 0.5 * EVERYWHERE, np.arange(20) % 2 == 0),
        lambda: bevelled_ends(points(), NUMBERS, 0.5 * EVERYWHERE, 0.5 * EVERYWHERE, np.arange(20) < 3),
        lambda: bevelled_ends(points(), NUMBERS, 0.5 * EVERYWHERE, 0.5 * EVERYWHERE, np.arange(20) < 13),
        lambda: relieved(points(), 0.055, 0.3),
        lambda: bevelled_ends(points(), NUMBERS, np.diag([0.6, 0.0]), np.diag([0.6, 0.0])),
        lambda: bevelled_ends(points(), NUMBERS, np.array([[0.6, 0.0], [0.6, 0.0]]), np.array([[0.6, 0.0], [0.6, 0.0]])),
        lambda: bevelled_ends(points(), NUMBERS, 0.07 * EVERYWHERE, 0.07 * EVERYWHERE),
        lambda: points()[:: len(points()) // 500],
        lambda: points()[:0],
    ],
    ids=["none", "one side slid", "both slid", "end relief", "every second tooth's", "three teeth's", "thirteen teeth's", "shallow", "one side at one end", "one side at both", "small", "few", "no"],
)  # fmt: skip
def test_what_is_no_edge_of_all_flanks(cloud):
    edge = found(cloud())
    assert edge.fits_design and edge.gear is GEAR and edge.words() == ""


def test_an_end_face_that_is_not_plane_is_no_edge():
    """Points of it reach 0.2 mm up into the teeth, as on small moulded parts."""
    random = np.random.default_rng(3)
    cloud = points().copy()
    radius = np.sqrt(random.uniform(GEAR.form_radius**2, GEAR.tip_radius**2, 40_000))
    share, tooth = random.uniform(-1.0, 1.0, 40_000), random.integers(0, 20, 40_000)
    angle = tooth * GEAR.pitch_angle + share * GEAR.half_angle(radius)
    face = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), random.uniform(0.0, 0.2, 40_000)])
    assert found(np.vstack([cloud, face])).fits_design


@pytest.mark.parametrize(("drawn", "kept"), [(0.5, True), (0.3, False), (0.8, True)])
def test_an_edge_that_is_drawn_is_not_looked_for_again(drawn, kept):
    gear = Gear.from_spec(replace(GEAR.spec, end_chamfer=drawn))
    assert found(bevelled_ends(points(), NUMBERS, 0.5 * EVERYWHERE, 0.5 * EVERYWHERE), gear).fits_design is kept


def test_of_the_flank_what_is_left_is_as_it_was():
    """Points past the bevels are the flank's as before, those on bevels of nothing; each side has its own."""
    reach = 0.3 + 0.5 * ACUTE
    cloud = bevelled_ends(points(), NUMBERS, reach, reach)
    gear = found(cloud).gear
    before, after = locate(cloud, GEAR), locate(cloud, gear)
    z, kept = cloud[:, 2], after.surface == FLANK
    assert np.array_equal(after.deviation[kept], before.deviation[kept])
    assert np.abs(after.deviation[kept]).max() < 6.0 * NOISE + 0.03
    for index, side in enumerate((1, -1)):
        flank = (before.surface == FLANK) & (before.side == side)
        inside = (z > reach[0, index] + 4.0 * BIN) & (z < 20.0 - reach[1, index] - 4.0 * BIN)
        assert kept[flank & inside].all()

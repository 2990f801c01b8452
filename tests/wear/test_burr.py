"""A burr beside sliding wear: kept apart, and not made where there is none."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.side_maps import infill
from gearwear.wear.burr import without_burrs
from gearwear.wear.regions import find_wear
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

GEAR = designed()
NOISE = 0.003
SIZE = 1.2
WORN = frozenset({Side.LEFT})
NARROW = 0.2
"""Width of a narrow burr, mm."""


def worn_flanks(random, burr):
    """Left flanks 20 µm worn at the form circle and 12 µm at the tip; `burr` (mm) high on average in half of the cells at the tip."""
    cells = every_cell(GEAR, SIZE)
    flank = flanks_of(cells)
    flank[:, 0] -= np.linspace(0.020, 0.012, flank.shape[3])
    ridge = 2.0 * burr * (random.random(flank[:, 0, :, -1].shape) < 0.5)
    flank[:, 0, :, -1] += ridge
    flank += NOISE / 2.0 * random.standard_normal(flank.shape)
    return with_flanks(cells, flank), ridge


def test_a_burr_is_not_taken_off_the_wear():
    cells, ridge = worn_flanks(np.random.default_rng(1), 0.030)
    plain, _ = worn_flanks(np.random.default_rng(1), 0.0)
    wear, without = (find_wear(one, NOISE, WORN, limits=False) for one in (cells, plain))
    (burr,) = wear.burrs
    true = float(ridge.sum()) * float(wear.side_maps.area[-1])
    assert burr.side is Side.LEFT
    assert abs(burr.volume - true) < 3.0 * burr.std
    lost, truth = (float((one.depth * one.side_maps.area)[..., cells.grid.fillet :].sum()) for one in (wear, without))
    assert abs(lost - truth) < 3.0 * burr.std < true / 3.0


@pytest.mark.parametrize("seed", range(6))
def test_wear_without_a_burr_stays_as_it_is(seed):
    cells, _ = worn_flanks(np.random.default_rng(seed), 0.0)
    wear = find_wear(cells, NOISE, WORN, limits=False)
    assert wear.burrs == ()


def test_wear_that_ends_below_the_tip_is_no_burr():
    """Contact that does not reach the tip leaves it as made: higher than the wear below it, and proud of nothing."""
    cells, _ = worn_flanks(np.random.default_rng(3), 0.006)
    flank = cells.grid.flank_shape(cells.points.deviation).copy()
    flank[:, 0, :, -1] = NOISE / 2.0 * np.random.default_rng(4).standard_normal(flank[:, 0, :, -1].shape)
    assert find_wear(with_flanks(cells, flank), NOISE, WORN, limits=False).burrs == ()


def test_only_worn_sides_are_looked_at():
    cells, _ = worn_flanks(np.random.default_rng(1), 0.030)
    sheets = find_wear(cells, NOISE, frozenset(), limits=False).side_maps
    same, burrs, std = without_burrs(sheets, infill(sheets), cells, NOISE, ())
    assert same is sheets and burrs == () and not std.any()


def points_on_worn_flanks(random, ridge, strays=0.002, number=10_000):
    """Cells of points at random on flanks worn as above on the left, with a ridge of 0.2 mm (1/e) along their tips, and strays up as often as down."""
    tooth, side = random.integers(GEAR.teeth, size=number), random.choice([1, -1], number)
    square = random.uniform(GEAR.form_roll**2, GEAR.tip_roll**2, number)
    to_tip = (GEAR.tip_roll**2 - square) / (2.0 * GEAR.base_radius)  # along the profile
    arc = (GEAR.tip_roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius)
    deviation = np.where(side == 1, ridge * np.exp(-((to_tip / NARROW) ** 2)) - 0.012 - 0.008 * to_tip / arc, 0.0)
    deviation += NOISE * random.standard_normal(number)
    deviation[random.random(number) < strays] += 5.0 * NOISE * random.choice([1.0, -1.0])
    points = flank_points(GEAR, tooth, side, np.sqrt(square), random.uniform(0.0, GEAR.face_width, number))
    return bin_points(points.with_deviation(deviation), CellGrid.for_scan(GEAR, number, size=SIZE))


@pytest.mark.parametrize("seed", range(4))
def test_a_burr_much_narrower_than_a_cell_shows_in_single_points(seed):
    """A ridge of 35 µm: on the mean of a cell it comes to 5, less than the wear is deep there. Its cross section is √π / 2 · height · width."""
    wear = find_wear(points_on_worn_flanks(np.random.default_rng(seed), 0.035), NOISE, WORN, limits=False)
    (burr,) = wear.burrs
    assert abs(burr.volume - GEAR.teeth * GEAR.face_width * 0.035 * NARROW * np.sqrt(np.pi) / 2.0) < 3.0 * burr.std


@pytest.mark.parametrize("seed", range(6))
def test_strays_at_the_tip_are_no_burr(seed):
    assert find_wear(points_on_worn_flanks(np.random.default_rng(seed), 0.0), NOISE, WORN, limits=False).burrs == ()


def test_without_the_points_the_narrow_burr_is_netted_against_the_wear():
    """The counterpart: means alone do not show it."""
    cells = points_on_worn_flanks(np.random.default_rng(0), 0.035)
    assert find_wear(replace(cells, highest=None), NOISE, WORN, limits=False).burrs == ()

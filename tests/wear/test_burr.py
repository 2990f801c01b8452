"""A burr beside sliding wear: kept apart, and not made where there is none."""

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.placing.side_maps import infill
from gearwear.wear.burr import without_burrs
from gearwear.wear.regions import find_wear
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

GEAR = designed()
NOISE = 0.003
SIZE = 1.2
WORN = frozenset({Side.LEFT})


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
    same, burrs, std = without_burrs(sheets, infill(sheets), cells.grid, NOISE, ())
    assert same is sheets and burrs == () and not std.any()

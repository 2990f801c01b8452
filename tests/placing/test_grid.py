"""Cells of a scan are as fine as its points lie, wherever there are any."""

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import FLANK, locate
from gearwear.placing.cells import CellGrid

GEAR = Gear.from_spec(GearSpec("gear", 25, 3.0, 20.0))


def flanks(teeth, on_each=2000, seed=1):
    """Points on the left flanks of some teeth, evenly over the face."""
    random = np.random.default_rng(seed)
    tooth, roll = np.repeat(teeth, on_each), random.uniform(GEAR.form_roll, GEAR.tip_roll, on_each * len(teeth))
    radius = np.hypot(GEAR.base_radius, roll)
    angle = tooth * GEAR.pitch_angle + GEAR.half_angle(radius)
    position = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), random.uniform(0.0, 20.0, len(roll))])
    return locate(position, GEAR, workers=1)


@pytest.mark.parametrize("teeth", [[4], [4, 5, 6], [0, 5, 10, 15, 20], range(24)])
def test_cells_of_a_few_teeth_are_those_of_all(teeth):
    whole, some = flanks(range(25)), flanks(list(teeth))
    size = CellGrid.for_scan(GEAR, len(whole)).size
    assert CellGrid.for_located(whole, GEAR, len(whole)).size == size
    assert CellGrid.for_located(some, GEAR, len(some)).size == pytest.approx(size, rel=1e-3)
    # as a sample of ten times as many points
    assert CellGrid.for_located(some, GEAR, 10 * len(some)).size == pytest.approx(size / np.sqrt(10.0), rel=1e-3)


def test_a_tooth_seen_thirty_times_as_thinly_is_seen():
    thin = [flanks([tooth], 2000 // (30 if tooth % 2 else 1), tooth) for tooth in range(25)]
    position = np.concatenate([one.position for one in thin])
    uneven = locate(position, GEAR, workers=1)
    assert (np.bincount(uneven.tooth[uneven.surface == FLANK]) > 0).all()
    assert CellGrid.for_located(uneven, GEAR, len(uneven)).size == CellGrid.for_scan(GEAR, len(uneven)).size


def test_without_any_flank_the_points_are_those_of_the_scan():
    nothing = flanks([3]).take(np.zeros(2000, dtype=bool))
    assert CellGrid.for_located(nothing, GEAR, 5000).size == CellGrid.for_scan(GEAR, 5000).size

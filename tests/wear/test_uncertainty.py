"""What the points of a cell, and holes, leave unknown of a volume: closed forms on surfaces laid flat by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.wear import regions
from gearwear.wear.regions import find_wear
from gearwear.wear.uncertainty import sampling_covariance
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

GEAR = designed()
NOISE = 0.001


def flat(size: float = 0.5):
    """Side maps of it without noise of their own."""
    return find_wear(every_cell(GEAR, size), NOISE)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_slope_leaves_the_variance_of_a_place_in_a_cell(axis):
    """Points alone in cells, anywhere in them: the surface at such a place has the variance slope² / 12, of which half is left once means
    are taken to the centres."""
    maps = flat(0.25).side_maps
    random = np.random.default_rng(0)
    shape = maps.deviation.shape
    maps = replace(
        maps, offset=0.4 * random.choice([-1.0, 1.0], (2, *shape)), torn=np.full(shape, NOISE), count=np.full(shape, 4.0)
    )
    slope = 0.003
    filled = np.broadcast_to(slope * np.arange(float(shape[2 + axis]))[(...,) + (None,) * (1 - axis)], shape).copy()
    region = np.zeros((1, *shape), dtype=bool)
    region[0, 3, 0, 5:7, maps.fillet + 5 : maps.fillet + 7] = True
    area = maps.area[maps.fillet + 5]
    expected = 4 * 0.5 * slope**2 / 12.0 * area**2
    assert sampling_covariance(maps, filled, NOISE, region)[0, 0] == pytest.approx(expected, rel=0.08)


def test_a_hole_may_hide_a_fourth_of_what_the_depths_round_it_span_alike_in_its_cells():
    """On a plane of slope g the depths beside a cell span 2 g: two cells of a hole hide 2 · 2 g / 4 of their area, together."""
    maps = flat().side_maps
    count = maps.count.copy()
    place = (3, 0, slice(5, 7), maps.fillet + 6)
    count[place] = 0.0
    slope = 0.003
    filled = np.broadcast_to(slope * np.arange(float(count.shape[3])), count.shape).copy()
    region = np.zeros((1, *count.shape), dtype=bool)
    region[(0, *place)] = True
    holed = replace(maps, count=count, torn=np.full_like(maps.torn, NOISE))
    assert holed.fillet > 0
    hidden = 2.0 * slope * 0.5 * maps.area[maps.fillet + 6]
    assert sampling_covariance(holed, filled, NOISE, region)[0, 0] == pytest.approx(hidden**2, rel=1e-9)


@pytest.mark.parametrize(("size", "window"), [(0.50, 1), (0.25, 2), (0.17, 3), (0.125, 4)])
def test_the_deepest_place_is_a_mean_over_half_a_millimetre(size, window):
    """A patch of 0.1 mm with a pit of 0.5 mm in one cell: of a window of k × k cells the pit is one."""
    cells = every_cell(GEAR, size)
    grid, flank = cells.grid, flanks_of(cells)
    rows, columns = slice(grid.rows // 4, 3 * grid.rows // 4), slice(grid.flank // 4, 3 * grid.flank // 4)
    flank[4, 0, rows, columns] = -0.1
    flank[4, 0, grid.rows // 2, grid.flank // 2] = -0.5
    wear = find_wear(with_flanks(cells, flank), NOISE)
    (region,) = wear.regions
    assert (region.tooth, region.side.index) == (4, 0)
    expected = 0.1 + 0.4 / window**2
    # What a curve that is known in cells may hide between them is added where the window is one cell, and stands in its ±.
    assert expected * 0.98 < region.max_depth
    assert region.max_depth - expected < 0.02 * expected + 2.0 * region.max_depth_std


def test_a_region_must_be_five_standard_deviations_large(monkeypatch):
    """The same patch, with what chance comes to set to just less and just more than a fifth of its volume; its own ± decides nothing."""
    cells = every_cell(GEAR, 0.5)
    flank = flanks_of(cells)
    flank[4, 0, 8:20, 4:16] = -0.1
    patch = with_flanks(cells, flank)
    volume = find_wear(patch, NOISE).volume
    assert volume == pytest.approx(0.1 * 144 * find_wear(patch, NOISE).side_maps.area[-1], rel=1e-3)
    for share, number in ((4.9, 0), (5.1, 1)):
        chance, own = np.array([[(volume / share) ** 2]]), np.array([[volume**2]])
        monkeypatch.setattr(regions, "_volumes", lambda *_, c=chance, o=own: (np.array([volume]), c, o))
        assert len(find_wear(patch, NOISE).regions) == number


@pytest.mark.parametrize(("high", "low"), [(0.004, 0.004), (0.004, 0.0), (0.003, 0.001)])
def test_what_the_same_cells_come_to_on_sides_without_wear_is_in_it(high, low):
    """Material too much, half of the sides by `high` and half by `low`: their mean, which all sides share, and their variance come to it."""
    cells = every_cell(GEAR, 0.5)
    patch = (slice(5, 23), slice(1, 19))  # the region and the rim that is summed with it
    variance = {}
    for share in (0.0, 1.0):
        flank = flanks_of(cells)
        for side in range(24):
            flank[side // 2, side % 2, *patch] = share * (high if side % 4 < 2 else low)
        flank[4, 0] = 0.0
        flank[4, 0, 8:20, 4:16] = -0.1
        wear = find_wear(with_flanks(cells, flank), NOISE)
        (region,) = wear.regions
        variance[share] = region.volume_std**2
    area = wear.side_maps.area[-1]
    rim = round(regions.RIM * GEAR.transverse_module / cells.grid.size)
    number = (12 + 2 * rim) ** 2
    each = np.array([high if side % 4 < 2 else low for side in range(24) if side != 8]) * area * number
    white = number * (NOISE * area) ** 2 / 4.0  # four points a cell: what is known of the noise is not counted twice
    expected = each.mean() ** 2 + max(each.var() - white, 0.0)
    assert variance[1.0] - variance[0.0] == pytest.approx(expected, rel=0.01)

"""What decides on a region and its ±: closed forms on surfaces laid flat by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.diagnose.covariance import CellCovariance
from gearwear.placing.side_maps import SideMaps
from gearwear.wear import places, regions
from gearwear.wear.regions import common_level_std, deepest_to_mean, find_wear
from gearwear.wear.uncertainty import CellErrors, edge_covariance, torn_beyond
from gearwear.wear.volume import Volumes
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

GEAR = designed()
NOISE = 0.001


@pytest.mark.parametrize("size", [0.50, 0.25, 0.17, pytest.param(0.125, marks=pytest.mark.long)])
def test_the_deepest_place_is_a_mean_over_half_a_millimetre(size):
    """A patch of 0.1 mm with a pit of 0.5 mm in one cell: of half a millimetre square it takes what the cell does."""
    cells = every_cell(GEAR, size)
    grid, flank = cells.grid, flanks_of(cells)
    rows, columns = slice(grid.rows // 4, 3 * grid.rows // 4), slice(grid.flank // 4, 3 * grid.flank // 4)
    flank[4, 0, rows, columns] = -0.1
    flank[4, 0, grid.rows // 2, grid.flank // 2] = -0.5
    wear = find_wear(with_flanks(cells, flank), NOISE)
    (region,) = wear.regions
    assert (region.tooth, region.side.index) == (4, 0)
    height, width = GEAR.face_width / grid.rows, float(wear.side_maps.area[-1]) * grid.rows / GEAR.face_width
    expected = 0.1 + 0.4 * min(height, 0.5) * min(width, 0.5) / 0.25
    # What a curve that is known in cells may hide between them is added where the window is one cell, and stands in its ±.
    assert expected * 0.98 < region.max_depth
    assert region.max_depth - expected < 0.02 * expected + 2.0 * region.max_depth_std


@pytest.mark.parametrize(
    ("certainty", "of_all", "deep", "hollow", "number"),
    [
        (4.9, 9.0, 0.1, False, 0),
        (5.1, 9.0, 0.0, False, 1),
        (9.0, 2.9, 0.0, False, 0),
        (9.0, 3.1, 0.0, False, 1),
        (9.0, 2.9, 0.1, False, 1),
        (9.0, 2.9, math.nan, False, 0),
        (4.9, 9.0, 0.1, True, 1),
        (4.9, 2.9, 0.0, True, 0),
    ],
    ids=str,
)
def test_a_region_is_five_of_its_cells_standard_deviations_and_three_of_all(monkeypatch, certainty, of_all, deep, hollow, number):
    """The same patch, with what its cells come to by chance, and all of its ±, set to just more and just less; with or without a deepest place, or
    too narrow for its surface to have one; and standing out of its flank or not."""
    cells = every_cell(GEAR, 0.5)
    flank = flanks_of(cells)
    flank[4, 0, 8:20, 4:16] = -0.1
    patch = with_flanks(cells, flank)
    known = find_wear(patch, NOISE)
    volume = known.volume
    assert volume == pytest.approx(0.1 * 144 * known.side_maps.area[-1], rel=1e-3)
    filled = -float(deep != 0.0) * known.depth
    given = Volumes(
        np.array([volume]),
        np.array([certainty]),
        np.array([certainty]),
        np.array([[(volume / of_all) ** 2]]),
        filled,
        np.array([[deep, 0.001 + 0.0 * deep]]),
        np.zeros(1, dtype=bool),
        np.zeros(1),
        np.zeros(2),
    )
    monkeypatch.setattr(regions, "region_volumes", lambda *_: given)
    monkeypatch.setattr(places, "hollowed_sides", lambda local: np.full(local.shape[:2], hollow))
    assert len(find_wear(patch, NOISE).regions) == number


def test_a_foot_too_shallow_to_be_seen_is_summed_with_what_is_seen():
    """Round a patch of 50 µm a foot of 2 µm, three cells wide, that 10 µm of noise hides: all that is missing is in the volume, but for the arc of a
    parallel 50 µm further in (0.1 %). The one cell next to the patch, and one more, would be 1 % short."""
    cells = every_cell(GEAR, 0.5)
    flank = flanks_of(cells)
    flank[4, 0, 5:23, 2:20] = -0.002
    flank[4, 0, 8:20, 5:17] = -0.05
    wear = find_wear(with_flanks(cells, flank), 0.01)
    assert wear.volume == pytest.approx(-flank.sum() * wear.side_maps.area[-1], rel=0.002)


def test_what_volumes_of_a_side_have_in_common_is_how_high_it_stands():
    """Four flanks of one side that share 9 µm of level and have noise of their own, three of the other that share nothing, and one by itself."""
    random = np.random.default_rng(5)
    area, side = random.uniform(20.0, 60.0, 8), np.array([0, 0, 1, 0, 1, 0, 1, 2])
    shared = np.where((side[:, None] == side) & (side == 0), 0.009**2, 0.0)
    covariance = np.outer(area, area) * shared + np.diag(random.uniform(0.1, 2.0, 8))
    np.testing.assert_allclose(common_level_std(covariance, area, side), np.where(side == 0, 0.009, 0.0), rtol=1e-12)


def test_what_is_common_may_have_the_shape_of_the_loss():
    """Three flanks that are 2, 3 and 30 times as deep at their deepest place as on average, one of the other side that is even, one of no depth known."""
    deepest, mean = np.array([0.2, 0.3, 3.0, 0.05, np.nan]), np.array([0.1, 0.1, 0.1, 0.1, 0.1])
    np.testing.assert_allclose(deepest_to_mean(deepest, mean, np.array([0, 0, 0, 1, 2])), [3.0, 3.0, 3.0, 1.0, 1.0])


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
    rim = round(places.RIM * GEAR.transverse_module / cells.grid.size)
    number = (12 + 2 * rim) ** 2
    each = np.array([high if side % 4 < 2 else low for side in range(24) if side != 8]) * area * number
    white = number * (NOISE * area) ** 2 / 4.0  # four points a cell: what is known of the noise is not counted twice
    expected = each.mean() ** 2 + max(each.var() - white, 0.0)
    assert variance[1.0] - variance[0.0] == pytest.approx(expected, rel=0.01)


def test_an_effect_whose_form_is_not_known_errs_alike_in_all_volumes():
    """That it is off by so many of its fields is one number each for the whole gear: (Σ a f)² of each, and what two volumes have of it in common."""
    random, cells = np.random.default_rng(1), every_cell(GEAR, 0.5)
    grid, count = cells.grid, len(cells.count)
    none, fields = np.zeros((count, 0)), random.normal(0.0, 1e-3, (count, 2))
    white = CellCovariance(grid, NOISE**2 / np.maximum(cells.count, 1.0), 0.0, 0.0, 0.0)
    weights = random.uniform(0.0, 0.25, (3, *grid.side_shape)) * (random.random((3, *grid.side_shape)) < 0.1)
    sums = np.array([[float(np.sum(one * grid.sides(field))) for field in fields.T] for one in weights])
    by_noise, by_form = (
        CellErrors(white, none, none[:0], none, none[:0], hidden).covariance_of(weights) for hidden in (none, fields)
    )
    assert by_form - by_noise == pytest.approx(np.outer(sums[:, 0], sums[:, 0]) + np.outer(sums[:, 1], sums[:, 1]), rel=1e-9)
    assert (np.diag(by_form) > 1.01 * np.diag(by_noise)).any()


def torn_maps(offset) -> tuple[SideMaps, np.ndarray]:
    """Side maps of cells of four points with these offsets, and slopes along the profile."""
    maps = find_wear(every_cell(GEAR, 0.5), NOISE).side_maps
    shape = maps.deviation.shape
    slope = np.zeros((2, *shape))
    slope[1] = 0.01
    return replace(maps, offset=offset(shape), torn=np.full(shape, 0.05)), slope


def edge_weights(maps: SideMaps) -> np.ndarray:
    """Ten cells of one column on each of two teeth."""
    weights = np.zeros((2, *maps.deviation.shape))
    weights[0, 3, 0, 5:15, maps.fillet + 5] = 0.25
    weights[1, 4, 0, 5:15, maps.fillet + 5] = 0.25
    return weights


def test_edges_steeper_than_a_cell_leave_what_points_at_random_scatter_there():
    """One point's place tells as much as any: Σ a² s², and nothing in common between teeth."""
    random = np.random.default_rng(0)
    maps, slope = torn_maps(lambda shape: 0.5 * random.uniform(-1.0, 1.0, (2, *shape)))
    covariance = edge_covariance(maps, np.full(maps.deviation.shape, 0.04**2), slope, edge_weights(maps))
    assert np.diag(covariance) == pytest.approx(10 * 0.25**2 * 0.04**2, rel=0.1)
    assert abs(covariance[0, 1]) < 0.1 * covariance[0, 0]


def test_points_of_a_lattice_err_alike_along_an_edge_and_on_every_tooth():
    """All off by 0.3 cells: as single places are known to ± 1 / √12, 12 · 0.3² of s² is left; alike in ten cells, and on both teeth."""
    maps, slope = torn_maps(lambda shape: np.full((2, *shape), 0.25))
    covariance = edge_covariance(maps, np.full(maps.deviation.shape, 0.04**2), slope, edge_weights(maps))
    assert covariance == pytest.approx(np.full((2, 2), (10 * 0.25 * 0.04) ** 2 * 12.0 * 0.25**2), rel=1e-6)


def test_what_noise_and_slope_explain_is_no_edge():
    maps, _ = torn_maps(lambda shape: np.zeros((2, *shape)))
    filled = np.broadcast_to(0.12 * np.arange(float(maps.deviation.shape[3])), maps.deviation.shape)
    torn, slope = torn_beyond(maps, filled, NOISE)
    assert slope[1] == pytest.approx(0.12)
    assert torn == pytest.approx(0.05**2 - 0.12**2 / 12.0 - NOISE**2)
    assert not torn_beyond(maps, 2.0 * filled, NOISE)[0].any()

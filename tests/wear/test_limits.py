"""From what depth on wear would have shown: patches put in, and found."""

import math
from dataclasses import replace
from statistics import NormalDist
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from scipy.stats import binom

from benchmarks.loop_study.fitting import registered
from gearwear.comparison.closing import find_effects
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, locate
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.placing.side_maps import FALSE_ALARM, make_side_maps
from gearwear.wear.limits import BEST_OF, BEST_STD, PATCH, common_loss, even_depth, even_part, faint_sides, upper_limit
from gearwear.wear.regions import find_wear
from tests.diagnose.plain import plain_effects
from tests.placing.placing import designed, true_pose
from tests.synthetic import Recipe, make_scan

GEAR = designed()


SCAN = make_scan(Recipe(jitter=1.0, pose="none", noise_um=8.0).of_size(40_000), 5)
LOCATED = locate(true_pose(SCAN).apply(SCAN.points), GEAR)
GRID = CellGrid.for_scan(GEAR, len(LOCATED))


def with_patches(limits, share, random):
    """The scan with a patch anywhere on each of some flanks, of a share of the depth that would have been found."""
    square = (LOCATED.roll + LOCATED.deviation) ** 2
    low, high = GEAR.form_roll**2, GEAR.tip_roll**2
    deviation = LOCATED.deviation.copy()
    for limit in limits:
        width = min(math.sqrt(limit.area), 0.98 * (high - low) / (2.0 * GEAR.base_radius))
        height, step = limit.area / width, width * 2.0 * GEAR.base_radius
        z, q = random.uniform(0.0, GEAR.face_width - height), random.uniform(low, high - step)
        own = (LOCATED.surface == FLANK) & (LOCATED.tooth == limit.tooth) & (LOCATED.side == limit.side)
        own &= (square >= q) & (square <= q + step) & (np.abs(LOCATED.position[:, 2] - z - 0.5 * height) <= 0.5 * height)
        deviation[own] -= share * limit.depth
    return bin_points(LOCATED.with_deviation(deviation), GRID)


@pytest.mark.long
def test_patches_of_the_depth_stated_are_found():
    """96 patches of the stated mean depth and area anywhere on their flanks: refused at odds of 1 in 1,000 were 96 % of them found."""
    random, found, put = np.random.default_rng(7), 0, 0
    cells = bin_points(LOCATED, GRID)
    scatter = noise(cells)
    wear = find_wear(cells, scatter)
    assert wear.regions == ()
    for turn in range(16):
        there = [limit for limit in wear.flanks if (limit.tooth + turn) % 4 == 0]
        seen = find_wear(with_patches(there, 1.0, random), scatter, limits=False)
        found += len({(one.tooth, one.side) for one in seen.regions} & {(one.tooth, one.side) for one in there})
        put += len(there)
    assert put == 96
    assert found >= binom.ppf(0.001, put, 0.96)


@pytest.mark.parametrize("looks", [200, 5000])
def test_the_deepest_mean_of_a_patch_lies_below_its_depth_by_what_draws_say(looks):
    """A patch of 6 × 6 cells that begins anywhere in a cell, as deep as means over 3 × 3 cells must be among so many to be no chance: most that are found
    are about so deep. 4000 draws tell the mean to 0.011 standard deviations of a mean, and the scatter to 0.008; with the depth the mean moves by 0.02."""
    depth = NormalDist().inv_cdf(1.0 - FALSE_ALARM / looks)
    random = np.random.default_rng(1)
    at, low = np.arange(PATCH + 6), 3.0 + random.uniform(-0.5, 0.5, (4000, 2, 1))
    cover = np.clip(np.minimum(at + 1.0, low + PATCH) - np.maximum(at, low), 0.0, 1.0)
    cells = 3.0 * random.normal(size=(4000, len(at), len(at))) - depth * cover[:, 0, :, None] * cover[:, 1, None]
    deepest = -sliding_window_view(cells, (3, 3), axis=(1, 2)).mean(axis=(3, 4)).min(axis=(1, 2))
    assert pytest.approx(deepest.mean() - depth, abs=0.05) == BEST_OF
    assert pytest.approx(deepest.std(), abs=0.03) == BEST_STD


@pytest.mark.parametrize("share", [0.3, pytest.param(0.6, marks=pytest.mark.long)])
def test_what_is_too_faint_to_be_found_is_within_what_it_may_come_to(share):
    """Six patches of a share of the depth that is found, eight times: the missing part of the total lies within its limit at least as often as 19 of 20
    allows (odds of 1 in 1,000), and without any patch the limit is less than they come to."""
    random = np.random.default_rng(8)
    cells = bin_points(LOCATED, GRID)
    scatter = noise(cells)
    plain = find_wear(cells, scatter)
    held = []
    for turn in range(8):
        there = [limit for limit in plain.flanks if (limit.tooth + turn) % 4 == 0]
        true = share * sum(limit.depth * limit.area for limit in there)
        wear = find_wear(with_patches(there, share, random), scatter, limits=False)
        assert wear.volume < true
        held.append(wear.volume + wear.faint >= true)
        assert plain.faint < true
    assert sum(held) >= binom.ppf(0.001, len(held), 0.95)


def test_a_flank_that_was_not_seen_says_nothing_and_a_thin_one_less():
    scan = make_scan(Recipe(jitter=1.0, pose="none", noise_um=8.0).of_size(60_000), 6)
    located = locate(true_pose(scan).apply(scan.points), GEAR)
    random = np.random.default_rng(2)
    keep = ~((located.tooth == 3) & (located.side > 0)) & ~((located.tooth == 5) & (random.random(len(located)) < 0.9))
    grid = CellGrid.for_scan(GEAR, len(located))
    cells = bin_points(located.take(keep), grid)
    limits = {(one.tooth, int(one.side)): one for one in find_wear(cells, noise(cells)).flanks}
    assert not limits[3, 1].says
    typical = float(np.median([one.depth * math.sqrt(one.area) for one in limits.values() if one.says]))
    assert limits[5, 1].says and limits[5, 1].depth * math.sqrt(limits[5, 1].area) > 1.5 * typical
    worst = replace(limits[5, 1])
    assert worst.seen > 0.5


def test_a_form_that_all_teeth_have_would_be_a_loss_below_its_highest_place():
    """A slope of 20 µm from form circle to tip on the right flanks: half of it on average over the roll, times their area; nothing on a side that
    is worn anyway."""
    sheets = make_side_maps(bin_points(LOCATED, GRID))
    flank = sheets.area[sheets.fillet :]
    way = np.linspace(0.0, 1.0, len(flank))
    shared = np.zeros(sheets.deviation.shape)
    shared[:, Side.RIGHT.index, :, sheets.fillet :] = 0.02 * way
    lost = 0.02 * ((1.0 - way) * flank).sum() * GEAR.teeth * GRID.rows
    assert common_loss(sheets, shared, GRID.toothed, frozenset()) == pytest.approx(lost)
    assert common_loss(sheets, shared, GRID.toothed, frozenset({Side.LEFT})) == pytest.approx(lost)
    assert common_loss(sheets, shared, GRID.toothed, frozenset({Side.RIGHT})) == 0.0
    half = np.arange(GRID.rows) < GRID.rows // 2  # the other rows are a groove's
    assert common_loss(sheets, shared, half, frozenset()) == pytest.approx(lost * half.sum() / GRID.rows)


def known_to(std):
    """A loop that tells how high flanks were made to `std`, mm, of a gear that does not slide at the reference circle."""
    context = SimpleNamespace(pitch_roll=GEAR.reference_roll, sliding=lambda roll: 1.0 - GEAR.reference_roll / roll)
    return SimpleNamespace(as_made_std=(std, std), context=context)


def slid(parts=100):
    """Way from the pitch point, of its roll, in the mean over each column."""
    return np.abs(GRID.rolls(2 * parts)[1::2] / GEAR.reference_roll - 1.0).reshape(-1, parts).mean(axis=1)


@pytest.mark.parametrize("even", [0.0, 0.015])
def test_the_even_part_of_a_loss_is_what_its_least_place_has_lost(even):
    """Sliding wear, nothing at the pitch point, beside an even loss: teeth that lost unalike have as much of it all the same."""
    way = slid()
    deviation = np.zeros(GRID.count)
    flank = GRID.flank_shape(deviation)
    share = np.linspace(0.5, 1.5, GEAR.teeth)[:, None, None]
    flank[:, Side.LEFT.index] = -0.05 * share * way - even
    cells = bin_points(LOCATED, GRID).with_deviation(deviation)
    sheets = make_side_maps(cells)
    area = GEAR.teeth * GRID.rows * float(sheets.area[sheets.fillet :].sum())
    found = even_part(sheets, frozenset({Side.LEFT}), GRID, known_to(0.001))
    assert found == pytest.approx(even * area, rel=0.02)  # no column is the pitch point itself: the profile goes on to it
    depth = even_depth(sheets, Side.LEFT, GRID, known_to(0.001))
    assert depth == pytest.approx(even, rel=0.02)
    assert even_depth(sheets, Side.RIGHT, GRID, known_to(0.001)) == 0.0
    assert even_part(sheets, frozenset(), GRID, known_to(0.001)) == 0.0
    assert even_part(sheets, frozenset({Side.LEFT}), GRID, known_to(0.02)) == 0.0


def test_how_low_the_least_place_lies_is_told_by_the_profile_and_not_by_a_cell():
    """Scatter of the cells leaves the even loss where it is: the highest of many single cells would be several of its own deviations high. Nor has the column
    next to the pitch point slid by nothing."""
    way = slid()
    deviation = np.random.default_rng(5).normal(0.0, 0.015, GRID.count)
    GRID.flank_shape(deviation)[:, Side.LEFT.index] -= 0.05 * way + 0.015
    sheets = make_side_maps(bin_points(LOCATED, GRID).with_deviation(deviation))
    depth = even_depth(sheets, Side.LEFT, GRID, known_to(0.001))
    strip = 1.2533 * 0.015 / math.sqrt(GEAR.teeth * GRID.rows)  # of a mean of medians
    assert abs(depth - 0.015) < 2.0 * strip


def test_a_loss_that_is_not_sure_is_in_the_range_with_what_its_doubt_leaves_open():
    """Three flanks, of which two are asked of: their sum and 1.96 standard deviations of it, correlated as they are."""
    lost, std = np.array([5.0, 1.0, 0.5]), np.array([0.3, 0.4, 0.2])
    covariance = np.outer(std, std) * np.array([[1.0, 0.9, 0.9], [0.9, 1.0, 0.5], [0.9, 0.5, 1.0]])
    which = np.array([False, True, True])
    expected = 1.5 + 1.96 * np.sqrt(0.4**2 + 0.2**2 + 2.0 * 0.5 * 0.4 * 0.2)
    assert upper_limit(lost, covariance, which) == pytest.approx(expected)
    assert upper_limit(-4.0 * lost, covariance, which) == 0.0
    assert upper_limit(lost, covariance, np.zeros(3, dtype=bool)) == 0.0


def test_faint_wear_of_a_whole_side_is_within_what_it_may_come_to():
    """Sliding wear put under flanks whose effects were found without it: what it may come to holds it and grows by what is added; without any, and
    where no cell is looked at, it is none."""
    with plain_effects():
        measured = find_effects(registered(SCAN.points, GEAR), frozenset())  # that no side looks worn is another test's question
    cells, loop = measured.as_made, measured.loop
    assert loop is not None
    sheets = make_side_maps(cells)
    none = np.zeros(sheets.deviation.shape, dtype=bool)
    points = cells.points
    right = cells.seen & (points.surface == FLANK) & (points.side == int(Side.RIGHT))
    sliding = np.where(right, np.abs(1.0 - GEAR.reference_roll / np.maximum(np.nan_to_num(points.roll), 0.5)), 0.0)
    area = cells.grid.on_cells(np.broadcast_to(sheets.area, none.shape))
    volume = 0.001 * float((sliding * area).sum())

    def limit(times):
        worn = cells.with_deviation(points.deviation - 0.001 * times * sliding)
        return faint_sides(worn, measured.noise, loop, none, sheets.area)

    assert limit(0.0) == 0.0
    for times in (3.0, 6.0, 10.0):
        assert times * volume < limit(times) < times * volume + 0.002 * GEAR.teeth * sheets.flank_row * sheets.count.shape[2]
    assert 0.9 * 20.0 * volume < limit(40.0) - limit(20.0) < 1.5 * 20.0 * volume
    everywhere = ~none
    assert faint_sides(cells.with_deviation(points.deviation - sliding), measured.noise, loop, everywhere, sheets.area) == 0.0

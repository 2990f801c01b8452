"""From what depth on wear would have shown: patches put in, and found."""

import math
from dataclasses import replace

import numpy as np
from scipy.stats import binom

from gearwear.design.surface import FLANK, locate
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.wear.regions import find_wear
from tests.placing.placing import designed, true_pose
from tests.synthetic import Recipe, make_scan

GEAR = designed()


def test_patches_of_the_depth_stated_are_found():
    """96 patches of the stated mean depth and area anywhere on their flanks: refused at odds of 1 in 1,000 were 96 % of them found."""
    random, found, put = np.random.default_rng(7), 0, 0
    scan = make_scan(Recipe(jitter=1.0, pose="none", noise_um=8.0).of_size(40_000), 5)
    located = locate(true_pose(scan).apply(scan.points), GEAR)
    grid = CellGrid.for_scan(GEAR, len(located))
    cells = bin_points(located, grid)
    scatter = noise(cells)
    wear = find_wear(cells, scatter)
    assert wear.regions == ()
    square = (located.roll + located.deviation) ** 2
    low, high = GEAR.form_roll**2, GEAR.tip_roll**2
    for turn in range(16):
        deviation, there = located.deviation.copy(), []
        for limit in wear.flanks:
            if (limit.tooth + turn) % 4:
                continue
            width = min(math.sqrt(limit.area), 0.98 * (high - low) / (2.0 * GEAR.base_radius))
            height, step = limit.area / width, width * 2.0 * GEAR.base_radius
            z, q = random.uniform(0.0, GEAR.face_width - height), random.uniform(low, high - step)
            own = (located.surface == FLANK) & (located.tooth == limit.tooth) & (located.side == limit.side)
            own &= (square >= q) & (square <= q + step) & (np.abs(located.position[:, 2] - z - 0.5 * height) <= 0.5 * height)
            deviation[own] -= limit.depth
            there.append((limit.tooth, limit.side))
        seen = find_wear(bin_points(located.with_deviation(deviation), grid), scatter, limits=False)
        found += len({(one.tooth, one.side) for one in seen.regions} & set(there))
        put += len(there)
    assert put == 96
    assert found >= binom.ppf(0.001, put, 0.96)


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

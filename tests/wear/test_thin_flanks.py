"""Hollows on a flank of which a dozen points were seen, on a scan that is dense elsewhere: their volume, and whether its ± is true."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.wear.regions import WearRegion, find_wear
from tests.placing.placing import designed

GEAR = designed()
ARC = (GEAR.tip_roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius)
WIDTH, TOOTH, NOISE, POINTS = GEAR.face_width, 4, 0.0085, 24_000


def hollow(random, wide):
    """Its depth, mm, as a function of places along profile and face, mm; `wide` as the flank, or half of that."""
    middle = random.uniform(0.3, 0.7, 2) * (ARC, WIDTH)
    half = (
        (random.uniform(0.7, 1.3), random.uniform(0.5, 0.8)) if wide else (random.uniform(0.25, 0.6), random.uniform(0.2, 0.45))
    )
    half, deep = np.multiply(half, (ARC, WIDTH)), random.uniform(0.1, 0.25)

    def depth(along, height):
        off = [1.0 - ((at - centre) / reach) ** 2 for at, centre, reach in zip((along, height), middle, half, strict=True)]
        return deep * np.prod(np.clip(off, 0.0, None), axis=0) ** 2

    return depth


def seen_thinly(seed: int, least: int, most: int, wide: bool = True) -> tuple[WearRegion | None, float]:
    """What is found of a hollow on a flank with so many points, and its true volume: summed over 300 × 300 places."""
    random = np.random.default_rng(seed)
    tooth, side = random.integers(GEAR.teeth, size=POINTS), random.choice([1, -1], POINTS)
    roll = np.sqrt(random.uniform(GEAR.form_roll**2, GEAR.tip_roll**2, POINTS))
    height, own = random.uniform(0.0, WIDTH, POINTS), (tooth == TOOTH) & (side == 1)
    kept = np.ones(POINTS, dtype=bool)
    kept[random.permutation(np.flatnonzero(own))[int(random.integers(least, most)) :]] = False
    tooth, side, roll, height, own = (values[kept] for values in (tooth, side, roll, height, own))
    depth, middles = hollow(random, wide), (np.arange(300) + 0.5) / 300
    true = depth(*np.meshgrid(middles * ARC, middles * WIDTH)).mean() * ARC * WIDTH
    lost = np.where(own, depth((roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius), height), 0.0)
    points = flank_points(GEAR, tooth, side, roll, height).with_deviation(NOISE * random.standard_normal(len(tooth)) - lost)
    wear = find_wear(bin_points(points, CellGrid.for_scan(GEAR, len(tooth)), clip=6.0 * NOISE), NOISE, limits=False)
    return next((one for one in wear.regions if one.tooth == TOOTH and int(one.side) == 1), None), float(true)


def test_hollows_of_which_a_dozen_points_were_seen_lie_within_their_deviation():
    """They were filled from what was next to them, known to a tenth and off by a third: pulls of 7 in the mean square, up to 56."""
    pulls = [(one.volume - true) / one.volume_std for one, true in (seen_thinly(seed, 12, 18) for seed in range(40)) if one]
    assert len(pulls) > 35
    assert np.mean(np.square(pulls)) < 2.0
    assert np.mean(np.abs(pulls) < 1.96) > 0.75


@pytest.mark.long
@pytest.mark.parametrize(("least", "most", "held"), [(18, 28, 0.9), (28, 40, 0.9), (40, 60, 0.9)])
def test_with_more_points_nine_in_ten_hold(least, most, held):
    pulls = [(one.volume - true) / one.volume_std for one, true in (seen_thinly(seed, least, most) for seed in range(120)) if one]
    assert np.mean(np.abs(pulls) < 1.96) > held

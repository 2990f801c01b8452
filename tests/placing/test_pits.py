"""Small pits and grooves among strays: random points on exact flanks, with depths put in by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import binom

from gearwear.design.side import Side
from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.in_cells import InCells
from gearwear.placing.pits import find_far_points
from gearwear.wear.regions import _hidden_pits, find_wear
from tests.placing.placing import designed

GEAR = designed()
NOISE = 0.005
POINTS = 24_000
FLANK_ARC = (GEAR.tip_roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius)


def random_points(random, strays=0.002):
    """Points at random per unit of area on all flanks, and strays that are as often above as below, up to a module."""
    tooth, side = random.integers(GEAR.teeth, size=POINTS), random.choice([1, -1], POINTS)
    roll = np.sqrt(random.uniform(GEAR.form_roll**2, GEAR.tip_roll**2, POINTS))
    points = flank_points(GEAR, tooth, side, roll, random.uniform(0.0, GEAR.face_width, POINTS))
    deviation = NOISE * random.standard_normal(POINTS)
    stray = random.random(POINTS) < strays
    far = np.exp(random.uniform(np.log(0.02), 0.0, POINTS)) * GEAR.transverse_module
    return points.with_deviation(np.where(stray, far * random.uniform(-1.0, 1.0, POINTS), deviation))


def with_pits(points, tooth, side, random, number=25, radius=0.5, depth=0.15):
    """A cluster of flat-bottomed pits that do not touch, and its volume."""
    centres = [(random.uniform(0.3, 0.7) * FLANK_ARC, random.uniform(0.25, 0.75) * GEAR.face_width)]
    while len(centres) < number:
        one = random.uniform(0.2, 0.8) * FLANK_ARC, random.uniform(0.2, 0.8) * GEAR.face_width
        if all(np.hypot(one[0] - a, one[1] - z) > 2.0 * radius for a, z in centres):
            centres.append(one)
    arc = (points.roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius)
    own = (points.tooth == tooth) & (points.side == side)
    inside = np.any([np.hypot(arc - a, points.position[:, 2] - z) < radius for a, z in centres], axis=0)
    deep = own & inside
    # The point stays where it was met: its foot moves up by what is missing.
    moved = replace(points, roll=np.where(deep, points.roll + depth, points.roll))
    return moved.with_deviation(points.deviation - depth * deep), number * np.pi * radius**2 * depth


def binned(points):
    lying = InCells.of(points, CellGrid.for_scan(GEAR, POINTS, size=1.6), 6.0 * NOISE)
    return lying.means()[0], find_far_points(points, lying.cell, lying.grid)[1]


def test_strays_alone_are_seldom_pits():
    """40 scans: refused at odds of 1 in 1,000 were there pits in no more than 5 % of them."""
    alarms = sum(bool(binned(random_points(np.random.default_rng(seed)))[0].far.hung.any()) for seed in range(40))
    assert alarms <= binom.ppf(0.999, 40, 0.01)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_cluster_of_small_pits_is_found_where_it_is_and_as_large(seed):
    random = np.random.default_rng(seed)
    plain = random_points(random)
    points, true = with_pits(plain, 4, -1, random)
    cells, belongs = binned(points)
    hung = cells.grid.sides(cells.far.hung)
    assert {(int(tooth), int(half)) for tooth, half in np.argwhere(hung.any(axis=(2, 3)))} == {(4, 1)}
    deep = (points.deviation < plain.deviation) & (np.abs(plain.deviation) < 5.0 * NOISE)
    assert belongs[deep].mean() > 0.95
    assert not belongs[(points.tooth != 4) | (points.side != -1)].any()
    (region,) = find_wear(cells, NOISE, limits=False).regions
    assert (region.tooth, int(region.side)) == (4, -1)
    assert abs(region.volume - true) < 3.0 * region.volume_std
    assert region.volume_std < 0.4 * true


def test_without_the_points_of_the_pits_they_would_be_lost():
    """The counterpart: by the distance from their cell's centre alone these points are strays."""
    random = np.random.default_rng(1)
    points, true = with_pits(random_points(random), 4, -1, random)
    cells = bin_points(points, CellGrid.for_scan(GEAR, POINTS, size=1.6), clip=6.0 * NOISE)
    wear = find_wear(cells, NOISE, limits=False)
    assert wear.volume < true - 4.0 * wear.volume_std


def test_a_point_three_times_as_deep_as_the_pits_is_a_stray_among_them():
    random = np.random.default_rng(2)
    points, _ = with_pits(random_points(random, strays=0.0), 4, -1, random)
    own = np.flatnonzero((points.tooth == 4) & (points.side == -1) & (points.deviation > -0.1))
    deviation = points.deviation.copy()
    deviation[own[0]] = -0.5
    _, belongs = binned(points.with_deviation(deviation))
    assert belongs[own[1:]].all()
    assert not belongs[own[0]]


def test_points_deeper_than_a_tenth_of_a_module_are_no_pits():
    """Eight points 0.8 mm below one flank, of a module of 6.35 mm: something else was scanned."""
    random = np.random.default_rng(3)
    points = random_points(random, strays=0.0)
    own = np.flatnonzero((points.tooth == 4) & (points.side == -1))[:8]
    for depth, there in ((0.4, True), (0.8, False)):
        deviation = points.deviation.copy()
        deviation[own] = -depth
        assert binned(points.with_deviation(deviation))[0].far.hung.any() == there


def test_grooves_along_the_profile_are_found_and_points_proud_of_the_flank_are_not():
    random = np.random.default_rng(5)
    points = random_points(random)
    z = points.position[:, 2]
    groove = (points.tooth == 7) & (points.side == 1) & (np.abs(np.mod(z, 3.0) - 1.5) < 0.15)
    sunk, _ = binned(points.with_deviation(points.deviation - 0.05 * groove))
    proud, _ = binned(points.with_deviation(points.deviation + 0.05 * groove))
    assert {tuple(place) for place in np.argwhere(sunk.grid.sides(sunk.far.hung).any(axis=(2, 3)))} == {(7, 0)}
    assert not proud.far.hung.any()


def test_what_pits_may_hide_elsewhere_covers_a_flank_with_too_few():
    """Five flanks with pits and one with so few that it is not found: its volume lies within what is told of it."""
    random = np.random.default_rng(10)
    points = random_points(random, strays=0.0)
    for tooth in range(5):
        points, _ = with_pits(points, tooth, 1, random)
    points, missed = with_pits(points, 9, -1, random, number=1, radius=0.3, depth=0.04)
    wear = find_wear(binned(points)[0], NOISE, limits=False)
    assert {(one.tooth, int(one.side)) for one in wear.regions} == {(tooth, 1) for tooth in range(5)}
    assert missed < wear.hidden_pits < 0.5 * wear.volume


def test_what_pits_may_hide_covers_chance_in_39_cases_of_40():
    """Poisson counts below and above of a flank whose pits are known to make 30 points, beside one where 100 points stand for 10 mm³."""
    random, draws, true, strays = np.random.default_rng(4), 4000, 30, 40
    shape = (2, 2, 1, 1)
    sheets = SimpleNamespace(area=np.ones(shape), seen=np.ones(shape, dtype=bool))
    mask = np.zeros(shape, dtype=bool)
    mask[0] = mask[1, 1] = True
    regions, covered = [SimpleNamespace(tooth=0, side=Side.LEFT, volume=10.0)], 0
    for low, high in zip(random.poisson(true + strays, draws), random.poisson(strays, draws), strict=True):
        below, above = np.zeros(shape), np.zeros(shape)
        below[0, 0], below[1, 0], above[1, 0] = 100.0, low, high
        far = SimpleNamespace(below=below, above=above, depth=1.0)
        cells = SimpleNamespace(far=far, count=np.full(shape, 5.0), grid=SimpleNamespace(sides=lambda values: values))
        covered += _hidden_pits(cells, sheets, mask, regions) >= 0.1 * true
    # 97.5 % within four standard deviations of 4000 draws: 1 %
    assert abs(covered / draws - 0.975) < 0.01

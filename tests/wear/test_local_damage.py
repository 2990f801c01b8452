"""Damage that is scattered over a flank: caps and grooves of known volume put into random points, and what the rest of a flank adds."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import exp1
from scipy.stats import norm

from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid
from gearwear.placing.in_cells import InCells
from gearwear.wear.regions import find_wear
from gearwear.wear.volume import share_of_rest
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed

GEAR = designed()
NOISE = 0.005
POINTS = 24_000
ARC = (GEAR.tip_roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius)
WIDTH = GEAR.face_width
TOOTH = 4


def scanned(random, damage):
    """Cells of points at random per unit of area on all flanks; `damage` gives the depth at arc and height of those of the left flank of a tooth."""
    tooth, side = random.integers(GEAR.teeth, size=POINTS), random.choice([1, -1], POINTS)
    roll = np.sqrt(random.uniform(GEAR.form_roll**2, GEAR.tip_roll**2, POINTS))
    height = random.uniform(0.0, WIDTH, POINTS)
    own = (tooth == TOOTH) & (side == 1)
    depth = np.where(own, damage((roll**2 - GEAR.form_roll**2) / (2.0 * GEAR.base_radius), height), 0.0)
    points = flank_points(GEAR, tooth, side, roll, height).with_deviation(NOISE * random.standard_normal(POINTS) - depth)
    grid = CellGrid.for_scan(GEAR, POINTS, size=1.6)
    return InCells.of(points, grid, 6.0 * NOISE).means()[0]


def grooves(places, wide, deep):
    """Grooves along the whole profile with the cross section of a triangle, and their volume."""

    def damage(arc, height):
        return sum(deep * np.clip(1.0 - np.abs(height - z) / (0.5 * wide), 0.0, None) for z in places)

    return damage, len(places) * 0.5 * wide * deep * ARC


def caps(centres, radius, deep):
    """Spherical caps, and their volume π h² (3 R − h) / 3."""
    sphere = (radius**2 + deep**2) / (2.0 * deep)

    def damage(arc, height):
        far2 = [(arc - a) ** 2 + (height - z) ** 2 for a, z in centres]
        return sum(np.clip(np.sqrt(np.maximum(sphere**2 - one, 0.0)) - (sphere - deep), 0.0, None) for one in far2)

    return damage, len(centres) * np.pi * deep**2 * (3.0 * sphere - deep) / 3.0


@pytest.mark.parametrize("seed", range(4))
def test_grooves_all_over_a_flank_of_which_few_stand_out(seed):
    """Two deep ones side by side and twelve of two standard deviations of a point elsewhere: more than half of what is lost stands out nowhere."""
    places = np.linspace(0.06, 0.94, 14) * WIDTH
    deep, lost = grooves(places[:2], 0.8, 0.05)
    shallow, more = grooves(places[2:], 0.8, 0.01)
    cells = scanned(np.random.default_rng(seed), lambda arc, height: deep(arc, height) + shallow(arc, height))
    (region,) = find_wear(cells, NOISE, limits=False).regions
    assert (region.tooth, int(region.side)) == (TOOTH, 1)
    assert more > lost
    assert abs(region.volume - lost - more) < 3.0 * region.volume_std < 0.75 * (lost + more)


@pytest.mark.parametrize("seed", range(3))
def test_caps_in_a_cluster_are_as_large_as_spheres_have_them(seed):
    random = np.random.default_rng(seed)
    centres = [(a * ARC, z * WIDTH) for a in (0.3, 0.5, 0.7) for z in (0.35, 0.5, 0.65)]
    damage, lost = caps(centres, 0.9, 0.08)
    (region,) = find_wear(scanned(random, damage), NOISE, limits=False).regions
    assert abs(region.volume - lost) < 3.0 * region.volume_std < 0.75 * lost


def test_the_rest_of_a_flank_counts_as_far_as_it_stands_out_of_its_scatter():
    assert share_of_rest(np.array([-5.0, 0.5, 1.0, 2.0, 10.0]), np.ones(5)) == pytest.approx([0.0, 0.0, 0.0, 0.75, 0.99])
    # Beside wear that stands alone it is chance: ∫ (t − 1/t) φ(t) dt from 1 on, in standard deviations.
    chance = 3.0 * np.random.default_rng(1).standard_normal(1_000_000)
    added = share_of_rest(chance, np.full(len(chance), 9.0)) * chance
    assert added.mean() == pytest.approx(3.0 * (norm.pdf(1.0) - exp1(0.5) / np.sqrt(8.0 * np.pi)), abs=4.0 * added.std() / 1e3)


def test_wear_that_lies_in_one_place_stays_as_it_is():
    """A patch on a flank that is otherwise like all others: its volume is that of the patch, and its area too."""
    cells = every_cell(GEAR, 0.8)
    flank = flanks_of(cells)
    flank += NOISE / 2.0 * np.random.default_rng(2).standard_normal(flank.shape)
    flank[TOOTH, 0, 6:12, 6:12] -= 0.1
    wear = find_wear(with_flanks(cells, flank), NOISE, limits=False)
    (region,) = wear.regions
    true = 36 * 0.1 * float(wear.side_maps.area[-1])
    assert abs(region.volume - true) < 3.0 * region.volume_std < 0.1 * true
    assert region.area < 0.5 * ARC * WIDTH


def test_an_even_loss_beside_a_deep_place_is_counted_and_its_area_is_the_flank():
    cells = every_cell(GEAR, 0.8)
    flank = flanks_of(cells)
    flank += NOISE / 2.0 * np.random.default_rng(3).standard_normal(flank.shape)
    flank[TOOTH, 0] -= 0.002
    flank[TOOTH, 0, 6:12, 6:12] -= 0.1
    wear = find_wear(with_flanks(cells, flank), NOISE, limits=False)
    (region,) = wear.regions
    true = (36 * 0.1 + flank[TOOTH, 0].size * 0.002) * float(wear.side_maps.area[-1])
    assert abs(region.volume - true) < 3.0 * region.volume_std < 0.1 * true
    assert region.area == pytest.approx(ARC * WIDTH, rel=0.01)
    assert region.patches == 1

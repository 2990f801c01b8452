"""Strays are neither the deepest wear nor a fracture: points thrown about on flanks of known depth, and inside teeth that are whole."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FLANK, locate
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.placing.registration import stray_limit
from gearwear.placing.side_maps import infill, make_side_maps
from gearwear.wear.breakage import find_fractures
from gearwear.wear.cell_means import CellMeans
from gearwear.wear.inside_tooth import depth_inside
from gearwear.wear.regions import find_wear
from gearwear.wear.volume import _deepest_pit
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed, true_pose
from tests.synthetic import Recipe, make_scan
from tests.wear.sections import section_thickness

GEAR = designed()
LEFT = frozenset({Side.LEFT})
DEPTH = 0.04
"""mm, of wear at the tip; in proportion to the way from the pitch point."""


def scanned(points=20_000, seed=4):
    scan = make_scan(Recipe(jitter=1.0, pose="none", noise_um=8.0).of_size(points), seed)
    return true_pose(scan).apply(scan.points)


def worn(points=20_000, seed=4):
    """Located points of a gear whose left flanks have slid."""
    located = locate(scanned(points, seed), GEAR)
    roll = np.nan_to_num(located.roll)
    way = np.abs(roll - GEAR.reference_roll) / (GEAR.tip_roll - GEAR.reference_roll)
    own = (located.surface == FLANK) & (located.side == int(Side.LEFT))
    return located.with_deviation(located.deviation - np.where(own, DEPTH * np.minimum(way, 1.0), 0.0)), own


def deepest(located):
    """Greatest stated depths, mm, of all worn flanks, the deepest first."""
    cells = bin_points(located, CellGrid.for_scan(GEAR, len(located)), clip=stray_limit(located))
    regions = find_wear(cells, noise(cells), LEFT, limits=False).regions
    return sorted((region.max_depth for region in regions), reverse=True), len(regions)


@pytest.mark.parametrize(
    ("points", "seed", "share"),
    [
        (20_000, 7, 0.01),
        (40_000, 4, 0.0),
        pytest.param(90_000, 5, 0.01, marks=pytest.mark.long),
        pytest.param(90_000, 6, 0.003, marks=pytest.mark.long),
    ],
)
def test_the_deepest_wear_is_not_that_of_strays_nor_of_noise(points, seed, share):
    """Of thousands of windows of few points each, at 8 µm, the lowest lies 20 µm too deep by chance, and a stray by 0.15 to 0.5 mm."""
    located, own = worn(points, seed)
    random = np.random.default_rng(seed)
    stray = own & (random.random(len(own)) < share)
    located = located.with_deviation(located.deviation - np.where(stray, random.uniform(0.15, 0.5, len(own)), 0.0))
    depths, number = deepest(located)
    assert number == GEAR.teeth
    assert 0.9 * DEPTH < depths[0] < 1.15 * DEPTH


@pytest.mark.long
def test_a_pit_of_many_points_is_the_deepest_wear():
    located, own = worn(120_000)
    square = (np.abs(located.position[:, 2] - 7.0) < 0.6) & (np.abs(located.roll - 1.1 * GEAR.reference_roll) < 0.9)
    pit = own & (located.tooth == 5) & square
    assert pit.sum() > 10
    depths, _ = deepest(located.with_deviation(located.deviation - np.where(pit, 0.12, 0.0)))
    assert depths[0] == pytest.approx(0.12 + DEPTH * 0.1 * GEAR.reference_roll / (GEAR.tip_roll - GEAR.reference_roll), abs=0.02)
    assert depths[1] < 1.4 * DEPTH


def test_strays_inside_a_tooth_are_no_fracture_and_a_thin_fracture_is_one():
    """As many points of one tooth: in all of it, and on a plane through it."""
    points, random = scanned(60_000), np.random.default_rng(8)
    box = np.column_stack(
        [
            random.uniform(GEAR.form_radius, GEAR.tip_radius, 40_000),
            random.uniform(-5.0, 5.0, 40_000),
            random.uniform(0.0, 15.0, 40_000),
        ]
    )
    tooth, depth, _ = depth_inside(box, GEAR)
    inside = box[(tooth == 0) & (depth > 0.3)]
    strays = inside[:: len(inside) // 40]
    assert find_fractures(np.vstack([points, strays]), GEAR) == []
    plane = inside.copy()
    plane[:, 2] = 11.0 + 0.4 * (plane[:, 0] - GEAR.form_radius)
    gone = (depth_inside(points, GEAR)[0] == 0) & (points[:, 2] > 11.0 + 0.4 * (points[:, 0] - GEAR.form_radius))
    of_plane = plane[(plane[:, 2] < 14.5)]
    thin = of_plane[:: len(of_plane) // 60]
    found = find_fractures(np.vstack([points[~gone], thin]), GEAR)
    assert [tooth for tooth, _ in found] == [0]


def test_sections_that_are_gone_have_no_thickness_and_are_not_the_thinnest():
    located = locate(scanned(60_000), GEAR)
    edge = (located.tooth == 3) & (located.position[:, 2] > 12.0) & (located.surface == FLANK)
    torn = section_thickness(located.with_deviation(located.deviation - np.where(edge, 0.5, 0.0)), GEAR, 0.008)
    assert torn.thinnest().tooth == 3
    gone = np.zeros(torn.arc.shape, dtype=bool)
    gone[3, torn.z > 12.0] = True
    whole = torn.without(gone)
    assert np.isnan(whole.arc[gone]).all()
    assert np.array_equal(np.delete(whole.arc, 3, axis=0), np.delete(torn.arc, 3, axis=0), equal_nan=True)
    assert whole.thinnest().value > torn.thinnest().value + 0.5
    assert torn.without(np.zeros_like(gone)) is torn


@pytest.mark.parametrize("around", [1, 2, 3])
def test_a_pit_stands_out_the_same_whichever_end_is_up(around):
    random = np.random.default_rng(around)
    for _ in range(20):
        count, scatter = random.integers(1, 6, (8, 5)).astype(float), np.full((8, 5), 0.006)
        deeper, inside = random.normal(0.0, 0.01, (8, 5)), random.random((8, 5)) < 0.6
        one = _deepest_pit(deeper, count, scatter, 0.006, 0.0, around, inside)
        other = _deepest_pit(deeper[::-1], count[::-1], scatter, 0.006, 0.0, around, inside[::-1])
        assert one == pytest.approx(other, rel=1e-9)


@pytest.mark.parametrize("row", [0, 6, -1])
def test_a_stray_beside_steep_wear_is_none_of_the_surface(row):
    """Of cells of one point on flanks that have lost 0.15 mm at their form circle and nothing at the pitch point, each tooth otherwise: the point that lies
    0.12 mm too deep next to the steep columns does not stand out of the cells round it, but of what all flanks have there."""
    cells, random = every_cell(GEAR, 0.9, times=1), np.random.default_rng(9)
    grid, flank = cells.grid, flanks_of(cells)
    way = np.clip(1.0 - grid.rolls(2)[1::2] / GEAR.reference_roll, 0.0, None)
    share = random.uniform(0.7, 1.3, (GEAR.teeth, 1, 1))
    flank[:, Side.LEFT.index] = -0.15 * share * (way / way.max()) ** 3
    flank += random.normal(0.0, 0.003, flank.shape)
    column = int(np.argmin(way > 0.3 * way.max()))
    assert flank[4, Side.LEFT.index, row, column - 2] < -0.05
    flank[4, Side.LEFT.index, row, column] -= 0.12
    put = with_flanks(cells, flank)
    sheets = make_side_maps(put)
    means = CellMeans.of(put, sheets, infill(sheets), 0.003, None, np.array([[4, Side.LEFT.index]]))
    left_out = ~means.held[..., grid.fillet :]
    assert left_out[4, Side.LEFT.index, row, column]
    assert left_out.sum() == 1


def test_a_stray_fills_no_neighbours_for_itself():
    """At the end of the face, where nothing was seen on one side of it: what is filled there says nothing of it, the cells on the other side do."""
    cells, random = every_cell(GEAR, 0.9), np.random.default_rng(10)
    flank = flanks_of(cells) + random.normal(0.0, 0.003, flanks_of(cells).shape)
    flank[4, Side.LEFT.index, -1, 6] -= 0.05
    put = with_flanks(cells, flank)
    number = put.grid.sides(put.count).copy()
    hole = number[4, Side.LEFT.index, -3:, put.grid.fillet + 4 : put.grid.fillet + 7]
    hole[...], hole[-1, -1] = 0.0, 2.0
    seen = replace(put, count=put.grid.on_cells(number))
    sheets = make_side_maps(seen)
    means = CellMeans.of(seen, sheets, infill(sheets), 0.003, None, np.array([[4, Side.LEFT.index]]))
    held = means.held[4, Side.LEFT.index, -3:, put.grid.fillet + 4 :]
    assert not held[:, :3].any() and held[:, 3:].all()

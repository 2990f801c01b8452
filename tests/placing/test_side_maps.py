"""Worn cells: the limits of normal statistics, from just inside and just outside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from gearwear.placing.side_maps import SideMaps, common_fillet, in_blocks, infill, make_side_maps, worn_cells
from tests.placing.cells import every_cell
from tests.placing.placing import designed

SHAPE = (12, 2, 20, 20)
NOISE, NUMBER = 0.01, 36.0
WHITE = NOISE / np.sqrt(NUMBER)
"""Standard deviation of a mean of so many points, mm."""
LIMIT = norm.isf(0.01 * 9.0 / np.prod(SHAPE))
"""In standard deviations: a gear of independent 3 × 3 windows passes it anywhere in one case of a hundred."""


def worn(depths: dict[tuple[int, int], float], number: dict[tuple[int, int], float] | None = None, caution: float = 1.0):
    """Which of these cells of a flank are worn, by their depth in `WHITE`, on a gear that is flat elsewhere; and the limit in `WHITE`."""
    local, count = np.zeros(SHAPE), np.full(SHAPE, NUMBER)
    for cell, depth in depths.items():
        local[3, 1, *cell] = -depth * WHITE
    for cell, points in (number or {}).items():
        count[3, 1, *cell] = points
    mask, spread, limit = worn_cells(local, count, NOISE, caution)
    assert spread == pytest.approx(WHITE)
    assert not np.delete(mask, 3, axis=0).any()
    return {cell for cell in np.ndindex(SHAPE[2:]) if mask[3, 1, *cell]}, limit / WHITE


def test_the_limit_lets_one_unworn_gear_of_a_hundred_pass():
    assert worn({})[1] == pytest.approx(LIMIT, rel=1e-9)
    assert worn({(5, 5): 0.99 * LIMIT})[0] == set()
    assert worn({(5, 5): 1.01 * LIMIT})[0] == {(5, 5)}


def test_a_region_takes_neighbours_in_from_two_and_a_half_standard_deviations():
    assert worn({(5, 5): 2.0 * LIMIT, (5, 6): 2.6, (6, 6): 2.6, (6, 7): 2.4, (10, 10): 2.6})[0] == {(5, 5), (5, 6), (6, 6)}


def test_caution_multiplies_both():
    depths = {(5, 5): 1.9 * LIMIT, (8, 8): 2.1 * LIMIT, (8, 9): 4.9, (9, 9): 5.1}
    assert worn(depths, caution=2.0) == ({(8, 8), (9, 9)}, pytest.approx(2.0 * LIMIT))


def test_a_mean_of_a_quarter_of_the_points_scatters_twice_as_much():
    few = {(5, 5): NUMBER / 4.0, (10, 10): NUMBER / 4.0}
    assert worn({(5, 5): 1.9 * LIMIT, (10, 10): 2.1 * LIMIT}, few)[0] == {(10, 10)}


@pytest.mark.parametrize(("points", "seen"), [(3, False), (5, True)])
def test_a_cell_with_less_than_a_quarter_of_the_usual_points_is_not_seen(points, seen):
    cells = every_cell(designed(), 0.5, 16)
    flank = cells.grid.flank_shape(cells.count)
    flank[4, 1, 6, 7] = points
    maps = make_side_maps(replace(cells, count=cells.count))
    assert maps.seen[4, 1, 6, maps.fillet + 7] == seen
    assert maps.seen[4, 1, 6, maps.fillet + 8]


@pytest.mark.parametrize("hole", [[(9, 11)], [(9, 11), (9, 12), (10, 12)]], ids=["one cell", "three"])
def test_a_hole_takes_the_quadratic_through_the_cells_round_it(hole):
    """Any quadratic comes back exactly, whatever the points of the cells; at the edge of a flank there is no such ring, nor where its other
    cells are unseen too."""
    random = np.random.default_rng(2)
    z, x = np.indices((20, 20))
    bent = 1e-3 * (x - 12.0) ** 2 - 2e-3 * (z - 8.0) * x + 5e-4 * z**2
    seen = np.ones((2, 2, 20, 20), dtype=bool)
    for cell in [*hole, (0, 14), (15, 6), (4, 15), (4, 16), (4, 17)]:
        seen[1, 0, *cell] = False
    count = np.where(seen, random.integers(1, 9, seen.shape), 0.0)
    nothing = np.full((*seen.shape, 3), np.nan)
    sheets = SideMaps(
        np.where(seen, bent, np.nan), count, nothing, np.ones(20), 6, nothing[None, ..., 0].repeat(2, 0), nothing[..., 0]
    )
    assert np.array_equal(sheets.seen, seen)
    filled = infill(sheets)
    assert [filled[1, 0, *cell] for cell in hole] == pytest.approx([bent[cell] for cell in hole], abs=1e-12)
    assert (
        abs(filled[1, 0, 0, 14] - bent[0, 14]) > 1e-6 and abs(filled[1, 0, 15, 6] - bent[15, 6]) > 1e-6
    )  # means of their neighbours


def test_the_form_of_all_fillets_is_known_whatever_a_few_of_them_lost():
    """50 µm too little beside the root and none at the flank on every fillet, and 0.2 mm off the fillets of one tooth besides; flanks have no say."""
    cells = every_cell(designed(), 0.5)
    grid = cells.grid
    sides = np.zeros((grid.gear.teeth, 2, grid.rows, grid.fillet + grid.flank))
    form = np.linspace(-0.05, 0.0, grid.fillet)
    sides[..., : grid.fillet] = form
    sides[3, :, :, : grid.fillet] -= 0.2
    sides[..., grid.fillet :] = -0.1
    scan = replace(cells, count=np.ones(grid.count)).with_deviation(grid.on_cells(sides))
    found = grid.sides(common_fillet(scan))
    np.testing.assert_allclose(found[..., : grid.fillet], np.broadcast_to(form, found[..., : grid.fillet].shape))
    assert not found[..., grid.fillet :].any()


def test_blocks_are_the_same_from_either_end():
    for length in range(1, 40):
        for number in range(1, length + 1):
            block = in_blocks(length, number)
            assert (block == block[-1] - block[::-1]).all()
            assert block[0] == 0 and set(np.diff(block)) <= {0, 1} and block[-1] + 1 in (number, number - 1)

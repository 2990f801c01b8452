"""The scan's own noise from the scatter inside cells, against what was put in."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.surface import FILLET, FLANK, flank_points, locate
from gearwear.placing.cells import CellGrid, Cells, bin_points, noise
from gearwear.placing.registration import stray_limit
from tests.placing.placing import designed, true_pose
from tests.synthetic import Effect, Patch, Recipe, SlidingWear, Texture, make_scan

PINION = designed()
SURE = 4.0
"""Standard deviations 1 / sqrt(2 ν) of a noise from ν degrees of freedom that are allowed: a false alarm in 16,000 for each assertion."""


def scan_in_cells(points: int, **recipe) -> Cells:
    scan = make_scan(Recipe(jitter=1.0, **recipe).of_size(points), 1)
    located = locate(true_pose(scan).apply(scan.points), PINION)
    return bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=max(stray_limit(located), 1e-4))


def freedom(cells: Cells) -> float:
    """Points that say something on scatter: all but one a cell, on tooth sides."""
    several = (cells.count >= 2) & (cells.points.surface <= FILLET)
    return float((cells.count[several] - 1.0).sum())


@pytest.mark.parametrize("points", [1_000, 8_000, 60_000])
@pytest.mark.parametrize("noise_um", [5.0, 20.0])
def test_short_range_scatter_is_the_noise_put_in(points, noise_um):
    """Whatever the density: cells of two points are no less sure of it than cells of fifteen."""
    cells = scan_in_cells(points, noise_um=noise_um)
    assert noise(cells) == pytest.approx(1e-3 * noise_um, rel=SURE / math.sqrt(2.0 * freedom(cells)))


@pytest.mark.parametrize("count", [2, 3, 5, 15])
def test_cells_of_any_count_say_the_same(count):
    """Normal deviations, so many in each flank cell."""
    grid = CellGrid.for_scan(PINION, 100_000)
    start, size = grid.blocks[FLANK]
    scatter, number = np.full(grid.count, np.nan), np.zeros(grid.count)
    scatter[start : start + size] = np.random.default_rng(count).normal(0.0, 0.008, (size, count)).std(axis=1, ddof=1)
    number[start : start + size] = count
    one = np.ones(1, np.int64)
    empty = bin_points(flank_points(PINION, one, one, np.array([10.0]), np.array([5.0])), grid)
    found = noise(replace(empty, count=number, scatter=scatter))
    # What is left out above the limit costs less than half of the information: the χ² of a cell is cut at four times its mean.
    assert found == pytest.approx(0.008, rel=SURE / math.sqrt(size * (count - 1)))


def test_wear_and_texture_are_not_noise():
    """The edge of a worn patch tears few cells; a texture longer than a cell, a coat and a wave of the table move cells as a whole."""
    plain = noise(scan_in_cells(40_000))
    for other in (
        {"wear": (Patch(2, 1, 400.0, (37.0, 43.0), (-5.0, 6.0), 1.0),)},
        {"texture": Texture(6.0, 6.0)},
        {"effects": (Effect("coating", {"thickness_um": 25.0}), Effect("turntable_angle", {"order": 3, "amplitude_deg": 0.02, "phase_deg": 40.0}))},
        {"outliers": 0.002},
    ):  # fmt: skip
        assert noise(scan_in_cells(40_000, **other)) == pytest.approx(plain, rel=0.02), other


def test_a_whole_side_that_is_worn_adds_only_its_slope_in_a_cell():
    """Of sliding wear 100 µm deep over 20 mm of flank, 1 mm cells hold the rise over a millimetre and no more."""
    cells = scan_in_cells(40_000, wear=(SlidingWear(100.0, 1),))
    outline = make_scan(Recipe(), 1).truth.outline
    steepest = 0.1 / (outline.reference_roll - outline.form_roll)  # per mm of roll length
    slope = np.sqrt(np.mean((steepest * np.diff(cells.grid.roll_edges)) ** 2) / 12.0)
    assert 0.0099 < noise(cells) < math.hypot(0.0101, slope)


def test_a_scan_without_noise_has_none():
    assert noise(scan_in_cells(8_000, noise_um=0.0, pose="none")) < 1e-6

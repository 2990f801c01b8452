"""Two layers in one file: told by what points of a cell scatter, on flanks and tips alike."""

from functools import cache

import numpy as np
import pytest

from gearwear.design.surface import FLANK, TIP, locate
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.layers import UNEASY, how_far_apart, layers_apart, said_of_layers
from tests.placing.placing import designed
from tests.synthetic import Recipe, make_scan

GEAR = designed()
APART = 0.04
SECTOR = range(3, 7)


@cache
def located():
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none").of_size(40_000), 3)
    return locate(scan.points, GEAR)


def cells_of(moved, by=APART):
    """In cells, every second of some points `by` mm off, as in a view that does not fit."""
    points = located()
    every_second = np.arange(len(points)) % 2 == 0
    deviation = points.deviation + np.where(moved(points) & every_second, by, 0.0)
    return bin_points(points.with_deviation(deviation), CellGrid.for_scan(GEAR, len(points)))


def of_sector(points):
    return np.isin(points.tooth, SECTOR)


def test_a_view_that_does_not_fit_shows_on_the_teeth_it_holds():
    cells = cells_of(lambda points: of_sector(points) & np.isin(points.surface, (FLANK, TIP)))
    apart = layers_apart(cells)
    assert np.flatnonzero(apart).tolist() == list(SECTOR)
    (said,) = said_of_layers(cells, apart)
    # Half the points 40 µm higher scatter by 20 µm, with 6 µm of noise by 21; the median deviation of four points is nine tenths of 6 µm.
    assert said.startswith("on 4 of 12 teeth points scatter by 2") and "on the others by 5 µm" in said


def test_views_a_little_out_of_place_are_no_layers_and_make_uneasy():
    """Half the points 12 µm higher, with 6 µm of noise: 1.4 times the scatter."""
    cells = cells_of(lambda points: of_sector(points) & np.isin(points.surface, (FLANK, TIP)), 0.012)
    assert not layers_apart(cells).any()
    assert np.flatnonzero(layers_apart(cells, UNEASY)).tolist() == list(SECTOR)


@pytest.mark.parametrize(
    "moved",
    [
        lambda points: np.zeros(len(points), dtype=bool),
        lambda points: (points.surface == FLANK) & (points.side == 1),
        lambda points: of_sector(points) & (points.surface == FLANK),
        lambda points: of_sector(points) & (points.surface == TIP),
        lambda points: (points.tooth == 5) & np.isin(points.surface, (FLANK, TIP)),
    ],
    ids=["quiet", "a rough side", "rough flanks", "burrs on tips", "one damaged tooth"],
)
def test_rough_wear_burrs_and_one_damaged_tooth_are_no_layers(moved):
    cells = cells_of(moved)
    assert not layers_apart(cells).any() and not layers_apart(cells, UNEASY).any()
    assert said_of_layers(cells, layers_apart(cells)) == ()


def test_how_far_layers_lie_from_their_mean_is_half_of_how_far_they_lie_apart():
    """Half the points 12 or 40 µm higher: 6 or 20 µm about the mean; the median over cells of few points is some tenths less."""
    for by in (0.012, APART):
        cells = cells_of(lambda points: of_sector(points) & np.isin(points.surface, (FLANK, TIP)), by)
        assert 0.7 * 0.5 * by < how_far_apart(cells) < 1.1 * 0.5 * by
    assert how_far_apart(cells_of(lambda points: np.zeros(len(points), dtype=bool))) == 0.0

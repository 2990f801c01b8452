"""Strays of a cell, on flanks whose points are known."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.surface import SurfacePoints, flank_points
from gearwear.placing.cells import CellGrid
from gearwear.placing.registration import stray_limit
from gearwear.placing.strays import near_centre
from tests.placing.placing import designed

PINION = designed()
GRID = CellGrid.for_scan(PINION, 30_000)
CLIP = 0.02


def flanks(each: int = 6) -> SurfacePoints:
    """Some points in every cell of all left flanks, without deviations."""
    edges, z = GRID.roll_edges, GRID.z_edges
    random = np.random.default_rng(3)
    tooth, row, column, _ = (at.ravel() for at in np.indices((PINION.teeth, GRID.rows, GRID.flank, each)))
    share = random.uniform(0.02, 0.98, (2, len(tooth)))
    roll = edges[column] + share[0] * (edges[column + 1] - edges[column])
    return flank_points(PINION, tooth, np.ones(len(tooth), np.int64), roll, z[row] + share[1] * (z[row + 1] - z[row]))


def test_wear_by_sliding_has_no_strays_however_steep_at_the_form_circle():
    """Depth in proportion to the specific sliding, 1 / L − 1 / L_C: within the first cell it falls by more than cells beside it differ."""
    points = flanks()
    depth = 0.6 * np.maximum(1.0 / points.roll - 1.0 / PINION.reference_roll, 0.0)
    cell = GRID.index(points)
    first = points.roll < GRID.roll_edges[1]
    assert np.ptp(depth[first]) > 3.0 * CLIP
    assert near_centre(-depth, cell, GRID, CLIP).all()


@pytest.mark.parametrize("count", [1, 2])
def test_few_points_far_off_are_strays_and_do_not_hide_those_beside_them(count):
    """A cell of one or two points, half a millimetre too low among sound ones, says neither that it is worn nor that wear is steep there."""
    points = flanks()
    place = (PINION.teeth // 2, GRID.rows // 2, GRID.flank // 2)
    cell = GRID.index(points)
    of = lambda tooth, row, column: np.flatnonzero(  # noqa: E731
        (points.tooth == tooth)
        & (np.digitize(points.position[:, 2], GRID.z_edges) - 1 == row)
        & (np.digitize(points.roll, GRID.roll_edges) - 1 == column)
    )
    alone, beside = of(*place), of(place[0], place[1], place[2] + 1)
    deviation = np.zeros(len(points))
    deviation[alone] = -0.5
    deviation[beside[0]] = -0.2
    cell[alone[count:]] = -1
    kept = near_centre(deviation, cell, GRID, CLIP)
    assert not kept[alone[:count]].any() and not kept[beside[0]]
    assert kept[beside[1:]].all()


def test_noise_has_no_strays_and_what_lies_ten_times_as_far_off_is_one():
    """Of 40,000 normal deviations the farthest lies at some 4.2 standard deviations; beyond six there is one in 500 million."""
    points = flanks()
    noise = 0.007 * np.random.default_rng(5).standard_normal(len(points))
    assert np.abs(noise).max() < stray_limit(replace(points, deviation=noise)) < 0.07

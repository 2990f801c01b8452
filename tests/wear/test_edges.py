"""Where flanks end along z: where a scan stops, and not where it thins out."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.edges import end_strip, end_zone, seen_places
from gearwear.wear.regions import find_wear
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Patch

GEAR = Helical(teeth=20, helix=0.0, width=18.0, shift=0.0)
DESIGN = designed(GEAR)


def zone(share):
    """Rows of the zone along the middle columns of the flanks, of a scan of which the `share` (a function of z) of all points is kept."""
    cloud, random = scan(GEAR, 80_000, noise=0.004, seed=3), np.random.default_rng(4)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    points = points[random.random(len(points)) < share(points[:, 2])]
    grid = CellGrid.for_scan(DESIGN, 50_000)
    cells = bin_points(locate(points, DESIGN), grid)
    found = end_zone(make_side_maps(cells), cells)
    return found[:, :, grid.fillet + 1 : -1], 0.5 * (grid.z_edges[1:] + grid.z_edges[:-1]), grid.row_height


@pytest.mark.parametrize("fewer", [1.0, 10.0, 30.0])
def test_a_scan_that_thins_out_along_the_face_ends_where_the_face_does(fewer):
    found, z, height = zone(lambda at: fewer ** -np.clip(at / GEAR.width, 0.0, 1.0))
    middle = np.minimum(z, GEAR.width - z) > end_strip(DESIGN) + 2.0 * height
    assert not found[:, middle].any()
    assert found[:, 0].all() and found[:, -1].mean() > 0.5


@pytest.mark.parametrize(("cells", "rows"), [(1_000, 1), (4_000, 1), (6_000, 2), (50_000, 3)])
def test_the_cells_that_the_strip_reaches_into_and_one_more_are_edges(cells, rows):
    """On cells twice the strip's width and more the second was a flank's, and how an edge was rounded wear of it. Of few rows half of the face is left."""
    cloud = scan(GEAR, 80_000, noise=0.004, seed=3)
    grid = CellGrid.for_scan(DESIGN, cells)
    binned = bin_points(locate((cloud.points - cloud.translation) @ cloud.rotation, DESIGN), grid)
    found = end_zone(make_side_maps(binned), binned)[:, :, grid.fillet + 1 : -1]
    assert (end_strip(DESIGN), DESIGN.face_width) == (0.9, 18.0)
    assert grid.rows - 2 * rows >= grid.rows / 3
    assert found[:, :rows].all() and found[:, grid.rows - rows :].all()
    assert not found[:, rows : grid.rows - rows].any()


@pytest.mark.parametrize("fewer", [1.0, 10.0])
def test_a_scan_that_stops_short_ends_there(fewer):
    last = 13.0
    found, z, height = zone(lambda at: np.where(at < last, fewer ** -np.clip(at / GEAR.width, 0.0, 1.0), 0.0))
    strip = (z < last) & (z > last - end_strip(DESIGN))
    assert found[:, strip].all()
    assert not found[:, (z > end_strip(DESIGN) + 2.0 * height) & (z < last - end_strip(DESIGN) - 3.0 * height)].any()


@pytest.mark.parametrize("low", [13.0, 0.0])
def test_what_was_not_seen_has_no_volume(low):
    """A hill that the scan saw above a circle alone: the closed form of that part, and the whole within what it may come to."""
    patch = Patch(4, 1, 0.08, (8.0, 18.0), (3.0, 15.0))
    cloud, design = scan(GEAR, 60_000, noise=0.004, seed=5, wear=(patch,)), designed(GEAR)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    points = points[np.hypot(points[:, 0], points[:, 1]) > np.hypot(GEAR.base, low)]
    wear = find_wear(bin_points(locate(points, design), CellGrid.for_scan(design, len(points))), 0.004)
    (region,) = wear.regions
    roll, z = np.meshgrid(np.linspace(max(low, 8.0), 18.0, 400), np.linspace(3.0, 15.0, 400), indexing="ij")
    depth = patch.at(roll, z)
    seen = float((depth * roll / GEAR.base - depth**2 / (2.0 * GEAR.base)).mean() * (18.0 - max(low, 8.0)) * 12.0)
    # The cells that the circle goes through are in or out as a whole: half of their height.
    part = 0.5 * CellGrid.for_scan(design, len(points)).size * float(depth[0].mean()) * 12.0
    assert region.volume == pytest.approx(seen, abs=3.0 * region.volume_std + part)
    if low:
        assert region.volume + wear.unseen > GEAR.volume(patch)
    else:
        assert wear.unseen == 0.0


@pytest.mark.parametrize("lines", [1.0, 1.3, 1.5, 1.75, 1.85, 2.4, 7.0])
def test_a_scan_made_of_lines_goes_on_to_the_last_of_them(lines):
    """Lines at one distance over the whole face, a number of them in a row of cells that is not whole: every row was seen, wherever the first line lies."""
    rows = 20
    for first in np.linspace(0.0, 0.99, 23):
        at = (np.arange(lines * rows) + first) / lines
        number = np.histogram(at, np.arange(rows + 1.0))[0].astype(np.float64)
        number[[0, -1]] *= 0.9  # some are lost
        for other in (number, number[::-1]):
            count = np.broadcast_to(10.0 * other[None, None, :, None], (12, 2, rows, 9))
            assert seen_places(count, 3)[:, other > 0].all()


def test_a_row_of_which_a_third_was_scanned_is_none():
    count = np.full((12, 2, 20, 9), 9.0)
    count[:, :, 0] = 3.0
    assert not seen_places(count, 3)[:, 0].any() and seen_places(count, 3)[:, 1:].all()


def test_wear_at_the_end_of_a_face_that_was_scanned_in_lines_is_measured():
    patch = Patch(4, 1, 0.08, (8.0, 18.0), (12.0, 24.0))
    cloud, design = scan(GEAR, 60_000, noise=0.004, seed=5, wear=(patch,)), designed(GEAR)
    points = (cloud.points - cloud.translation) @ cloud.rotation
    grid = CellGrid.for_scan(design, len(points))
    # Two lines in one row of cells and one in the next, as the last has; of that some are lost.
    row, place = np.divmod(points[:, 2] / grid.row_height, 1.0)
    on_line = np.where(row % 2 == (grid.rows % 2), np.abs(np.abs(place - 0.5) - 0.25) < 0.1, np.abs(place - 0.5) < 0.1)
    points = points[on_line & ((row < grid.rows - 1) | (np.random.default_rng(2).random(len(points)) < 0.9))]
    wear = find_wear(bin_points(locate(points, design), grid), 0.004)
    (region,) = wear.regions
    assert region.volume == pytest.approx(0.5 * GEAR.volume(patch), abs=3.0 * region.volume_std)  # half of it lies beyond the end

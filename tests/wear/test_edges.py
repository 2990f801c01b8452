"""Where flanks end along z: where a scan stops, and not where it thins out."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.edges import end_strip, end_zone
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

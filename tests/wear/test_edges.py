"""Where flanks end along z: where a scan stops, and not where it thins out."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.edges import end_strip, end_zone
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed

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

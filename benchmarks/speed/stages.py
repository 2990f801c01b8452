"""The same way by gearwear, one process: reading, registration with the deviation of every point, wear, worn solid; no start is given.

python -m benchmarks.speed.stages DESIGN.toml SCAN.ply

Prints a JSON line: seconds of wall and processor time per stage, the pose found, the volumes.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the commands do

import numpy as np

from benchmarks.speed.timing import timed
from gearwear.design.files.toml import read_design
from gearwear.design.gear import Gear
from gearwear.design.side import sides_of
from gearwear.placing.cells import CellGrid, Cells, bin_points
from gearwear.placing.registration import stray_limit
from gearwear.placing.views import PlacedScan, place
from gearwear.scan.reading import read_scan
from gearwear.scan.types import Scan
from gearwear.wear.profiles import ProfileNodes, without_added_metal, worn_profiles
from gearwear.wear.regions import Wear, find_wear
from gearwear.wear.smooth import smooth_surface
from gearwear.wear.solid import Triangles, gear_triangles, nominal_like, worn_bodies


def read(scan: str) -> Scan:
    return read_scan([scan])[0]


def registered(scan: Scan, gear: Gear) -> PlacedScan:
    """The pose, and the deviation of every point in it."""
    return place([scan.points], gear, [scan.normals])


def cells_of(placed: PlacedScan, gear: Gear) -> Cells:
    grid = CellGrid.for_scan(gear, len(placed.located))
    return bin_points(placed.located, grid, clip=stray_limit(placed.located))


def wear_of(placed: PlacedScan, cells: Cells) -> Wear:
    return find_wear(cells, placed.registration.noise, sides_of(placed.registration.datum.worn_side))


def worn_solid(wear: Wear, cells: Cells, noise: float) -> tuple[Triangles, list[Triangles]]:
    """The worn gear, and a closed body per piece of missing metal."""
    surface = smooth_surface(wear, cells.grid, noise)
    profiles = worn_profiles(ProfileNodes.of(cells.grid), without_added_metal(surface.depth, wear.side_maps.area))
    worn = gear_triangles(profiles)
    return worn, worn_bodies(gear_triangles(nominal_like(profiles)), worn, wear.least_seen)


def main(design: str, file: str) -> dict[str, Any]:
    import manifold3d  # noqa: F401  the peers' packages are imported outside the clock too
    import scipy.spatial  # noqa: F401

    gear = read_design(design).gears["pinion"]
    scan, reading = timed(lambda: read(file))
    placed, registering = timed(lambda: registered(scan, gear))
    cells, binning = timed(lambda: cells_of(placed, gear))
    wear, finding = timed(lambda: wear_of(placed, cells))
    (_, bodies), solid = timed(lambda: worn_solid(wear, cells, placed.registration.noise))
    stages = {"reading": reading, "registration and deviation": registering, "wear": binning + finding, "worn solid": solid}
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = placed.registration.pose.rotation, placed.registration.pose.translation
    return {
        "stages": {name: [cost.wall, cost.cpu] for name, cost in stages.items()},
        "pose": pose.tolist(),
        "integral_mm3": sum(region.volume for region in wear.regions),
        "bodies_mm3": sum(body.volume for body in bodies),
        "bodies": len(bodies),
    }


if __name__ == "__main__":
    print(json.dumps(main(*sys.argv[1:])))

"""The practice scans and the outlines of real gears, read whole."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from gearwear.design import read_design
from gearwear.design.gear import Gear
from gearwear.scan import check_size, read_one, read_scan

pytestmark = pytest.mark.shared

CLOUDS = {
    "blind_a": 488_347,
    "blind_b": 488_829,
    "blind_c": 938_458,
    "open_tooth_b": 487_979,
    "open_turntable": 488_087,
    "open_unworn": 487_984,
}
"""Vertices, as their headers say."""


@pytest.mark.parametrize("name", CLOUDS)
def test_a_practice_cloud_reads_whole_and_fits_its_gear(shared: Path, pinion: Gear, wheel: Gear, name: str) -> None:
    scan = read_one(shared / "scans" / f"{name}.ply")
    assert scan.kind == "cloud"
    assert len(scan) + sum(scan.rejected.values()) == CLOUDS[name]
    check_size(scan, wheel if name == "blind_c" else pinion)


@pytest.mark.parametrize("name", ["open_tooth_b", "open_unworn"])
def test_only_points_off_the_part_are_called_outliers(shared: Path, name: str) -> None:
    """A stray thrown about by a metre in front of a practice scan is found; none of its own near the surface goes."""
    from gearwear.scan.clean import outliers

    points = read_one(shared / "scans" / f"{name}.ply").points
    truth = json.loads((shared / "scans" / f"{name}.truth.json").read_text())
    found = outliers(np.vstack([points, [[1000.0, 0.0, 0.0]]]))
    assert found[-1]
    part = (points[found[:-1]] - truth["pose"]["t"]) @ np.array(truth["pose"]["R"])
    radius, z = np.hypot(part[:, 0], part[:, 1]), part[:, 2]
    assert ((radius > 44.5) | (radius < 13.5) | (z < -0.1) | (z > 15.1)).all()


def test_the_views_keep_their_order(shared: Path, pinion: Gear) -> None:
    scans = read_scan([shared / "scans" / f"open_views_{i}.ply" for i in (1, 2, 3, 4)])
    assert [len(scan) for scan in scans] == [198_275] * 4
    assert [int(scan.view[0]) for scan in scans] == [0, 1, 2, 3]
    for scan in scans:
        check_size(scan, pinion)


def test_the_triangles_have_holes_and_normals_of_their_own(shared: Path, pinion: Gear) -> None:
    scan = read_one(shared / "scans" / "open_triangles.stl")
    assert scan.kind == "triangles" and scan.triangles is not None and scan.normals is not None
    assert len(scan.triangles) == 111_018
    edges = np.sort(scan.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    assert uses.max() == 2 and (uses == 1).any()  # shared vertices, and a boundary
    np.testing.assert_allclose(np.linalg.norm(scan.normals, axis=1), 1.0, rtol=0, atol=1e-12)
    tip = np.hypot(*scan.points[:, :2].T) > 44.3
    assert (np.einsum("ij,ij->i", scan.points[tip, :2], scan.normals[tip, :2]) > 0.0).all()
    check_size(scan, pinion)


@pytest.mark.parametrize(("number", "points"), [(1, 5941), (2, 9399), (3, 9863)])
def test_the_real_outlines_are_sections(shared: Path, number: int, points: int) -> None:
    scan = read_one(shared / "real" / f"flatbed_gear_{number}.csv")
    assert scan.kind == "section" and set(scan.rejected) <= {"duplicate"}
    assert len(scan) + scan.rejected.get("duplicate", 0) == points
    check_size(scan, read_design(shared / "real" / f"flatbed_gear_{number}.toml").gears["gear"])

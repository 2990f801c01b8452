"""What is taken out is counted, and what is a measurement stays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.errors import InputError
from gearwear.scan import read_one
from gearwear.scan.clean import clean, outliers
from gearwear.scan.contents import Contents
from gearwear.scan.unique import first_of_each
from tests.scan.writers import ball, ply, stl, torus, xyz
from tests.synthetic import Recipe, make_scan


@given(st.lists(st.tuples(*[st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-300, 2.5])] * 3), min_size=1, max_size=60))
@settings(max_examples=100, deadline=None)
def test_equal_points_are_found_as_python_finds_them(rows: list[tuple[float, float, float]]) -> None:
    """−0.0 equals 0.0 here as in Python."""
    first, label = first_of_each(np.array(rows))
    distinct = list(dict.fromkeys(rows))
    assert [rows[i] for i in first] == distinct
    assert [rows[i] for i in first] == [rows[rows.index(row)] for row in distinct]
    assert [distinct[i] for i in label] == rows


def test_repetitions_are_counted_and_the_first_stays(tmp_path: Path) -> None:
    points = ball(300)
    path = tmp_path / "a.ply"
    path.write_bytes(ply(np.vstack([points, points[:40], points[:40]])))
    scan = read_one(path)
    assert scan.rejected == {"duplicate": 80}
    np.testing.assert_array_equal(scan.points, points)


def test_what_is_not_finite_goes_with_its_normals_and_triangles(tmp_path: Path) -> None:
    points, faces = torus()
    holed = points.copy()
    holed[[3, 50]] = [[np.nan, 0, 0], [0, 0, np.inf]]
    path = tmp_path / "a.stl"
    path.write_bytes(stl(holed, faces))
    scan = read_one(path)
    assert scan.triangles is not None
    gone = np.isin(faces, [3, 50])
    assert scan.rejected["non_finite"] == gone.sum()  # an STL repeats a corner in each triangle
    assert len(scan.triangles) == (~gone.any(axis=1)).sum()
    assert {tuple(p) for p in scan.points.tolist()} == {tuple(p) for p in np.delete(points, [3, 50], axis=0).tolist()}


def test_vertices_of_no_triangle_are_counted() -> None:
    points, faces = torus()
    left, kind = clean(Contents(np.vstack([points, [[100.0, 0, 0]]]), None, faces))
    assert (kind, left.rejected) == ("triangles", {"unreferenced": 1})
    np.testing.assert_array_equal(left.points, points)


def test_normals_are_kept_where_there_are_any() -> None:
    points = ball(200)
    normals = 3.0 * points
    normals[5] = 0.0
    normals[6] = np.nan
    left, _ = clean(Contents(points, normals))
    assert left.normals is not None
    expected = points / np.linalg.norm(points, axis=1)[:, None]
    expected[[5, 6]] = 0.0
    np.testing.assert_allclose(left.normals, expected, rtol=0, atol=1e-15)
    assert clean(Contents(points, np.zeros_like(points)))[0].normals is None


@pytest.mark.parametrize("size", [1000, 20_000, 200_000])
def test_a_gear_of_any_size_loses_nothing_but_the_strays(size: int) -> None:
    """Noise ten times the usual, end faces at a fifth of the flanks' density, strays 30 mm and more off the gear."""
    points = make_scan(Recipe(noise_um=100.0, pose="any").of_size(size), seed=size).points
    assert not outliers(points).any()
    rng = np.random.default_rng(1)
    far = rng.normal(size=(max(size // 5000, 1), 3))
    far *= rng.uniform(90.0, 3000.0, (len(far), 1)) / np.linalg.norm(far, axis=1)[:, None]
    found = outliers(np.vstack([points, points.mean(axis=0) + far]))
    assert not found[: len(points)].any()
    assert found[len(points) :].all()


def test_strays_do_not_hide_behind_ones_still_farther() -> None:
    points = ball(20_000)
    far = np.array([[1e8, 0, 0], [0, -1e8, 0], [60.0, 0, 0], [0, 0, -60.0]])
    found = outliers(np.vstack([points, far]))
    assert found[-4:].all() and found.sum() == 4


def test_order_and_position_do_not_matter() -> None:
    points = np.vstack([ball(5000), [[70.0, 1, 2], [-70.0, 5, 0]]])
    found = outliers(points)
    assert found.tolist() == outliers(points[::-1])[::-1].tolist()
    assert found[-2:].all() and not found[:-2].any()


@pytest.mark.parametrize("name", ["a.xyz", "a.ply"])
def test_too_few_points(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(xyz(ball(99)) if name == "a.xyz" else ply(ball(99)))
    with pytest.raises(InputError, match=r"a\.\w+: holds 99 points: at least 100 would be right"):
        read_one(path)


def test_too_few_points_of_a_section_and_of_repetitions(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("".join(f"{i},{i * i}\n" for i in range(29)))
    with pytest.raises(InputError, match="holds 29 points: at least 30"):
        read_one(path)
    path.write_bytes(xyz(np.repeat(ball(60), 3, axis=0)))
    with pytest.raises(InputError, match="60 of its 180 points can be used: at least 100"):
        read_one(path)


def test_no_point_is_finite(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(np.full((500, 3), np.nan)))
    with pytest.raises(InputError, match="none of its 500 points is a finite number"):
        read_one(path)


def test_a_part_scanned_a_fiftieth_as_densely_is_kept():
    """Two squares side by side, one of 640² points and one of 90²: in the thin one a cell and its neighbours hold a seventh of a typical cell."""
    dense, thin = (np.stack(np.meshgrid(*2 * [(np.arange(n) + 0.5) / n]), axis=-1).reshape(-1, 2) for n in (640, 90))
    points = np.vstack([dense, thin + np.array([1.0, 0.0])])
    assert not outliers(np.column_stack([points, np.zeros(len(points))])).any()

"""What an independent writer puts in comes out."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearwear.scan import READERS, read_one, read_scan
from tests.scan.writers import CLOUDS, SURFACES, ball, ply, torus, xyz

ROUNDED = {"a.las": 0.51e-6, "a.laz": 0.51e-6}
"""LAS stores whole multiples of its scale, here 1e-6 mm."""


@pytest.mark.parametrize("name", CLOUDS)
@pytest.mark.parametrize("packed", [False, True], ids=["plain", "gzip"])
def test_a_cloud_comes_back_point_by_point(tmp_path: Path, name: str, packed: bool) -> None:
    points = ball()
    path = tmp_path / (name + ".gz" if packed else name)
    data = CLOUDS[name](points)
    path.write_bytes(gzip.compress(data) if packed else data)

    scan = read_one(path)

    assert (scan.kind, scan.triangles, scan.normals, scan.rejected) == ("cloud", None, None, {})
    assert scan.files == (str(path),)
    assert scan.points.dtype == np.float64 and scan.points.flags.c_contiguous
    np.testing.assert_allclose(scan.points, points, rtol=0, atol=ROUNDED.get(name, 0.0))


@pytest.mark.parametrize("line", [b"\n", b"\r\n"], ids=["LF", "CRLF"])
def test_a_comment_may_hold_the_word_that_ends_a_header(tmp_path: Path, line: bytes) -> None:
    head, body = ply(ball(), kind="f8").split(b"end_header\n")
    head = head.replace(b"\nelement", b"\ncomment no end_header yet\nelement", 1).replace(b"\n", line)
    path = tmp_path / "a.ply"
    path.write_bytes(head + b"end_header" + line + body)

    np.testing.assert_array_equal(read_one(path).points, ball())


def corners(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Triangles as coordinates, each turned to begin with its least corner, in a fixed order."""
    found = points[triangles]
    least = np.array([min(range(3), key=lambda i: tuple(t[i])) for t in found])
    turned = np.stack([found[np.arange(len(found)), (least + i) % 3] for i in range(3)], axis=1).reshape(-1, 9)
    return turned[np.lexsort(turned.T)]


@pytest.mark.parametrize("name", SURFACES)
def test_a_surface_comes_back_with_shared_vertices_and_its_side(tmp_path: Path, name: str) -> None:
    points, faces = torus()
    path = tmp_path / name
    path.write_bytes(SURFACES[name](points, faces))

    scan = read_one(path)

    assert (scan.kind, scan.rejected) == ("triangles", {})
    assert scan.triangles is not None and scan.normals is not None
    assert len(scan) == len(points)  # the torus has no boundary: V − E + F = 0 only with shared corners
    single = {"3mf": 1e-5, "obj": 0.0}.get(name.split(".")[1], 0.0)
    np.testing.assert_allclose(corners(scan.points, scan.triangles), corners(points, faces), rtol=0, atol=single)
    ring = scan.points * [1, 1, 0]
    ring *= 30.0 / np.linalg.norm(ring, axis=1)[:, None]
    outward = (scan.points - ring) / 8.0
    np.testing.assert_allclose(np.linalg.norm(scan.normals, axis=1), 1.0, rtol=0, atol=1e-12)
    assert (np.einsum("ij,ij->i", scan.normals, outward) > 0.99).all()  # facets of 15° and 36°


def test_every_format_is_written_by_a_test() -> None:
    written = {"." + name.split(".")[-1] for name in (*CLOUDS, *SURFACES)}
    assert written == set(READERS)


def test_ply_with_lists_polygons_normals_and_other_elements(tmp_path: Path) -> None:
    """An element with lists before the vertices, triangles mixed with a quadrilateral, in all three encodings."""
    from plyfile import PlyData, PlyElement

    points, faces = torus()
    outward = np.tile([0.0, 0.6, 0.8], (len(points), 1)).astype(np.float32)
    rows = np.zeros(len(points), [(n, "f4") for n in ("x", "y", "z", "nx", "ny", "nz")])
    for i, axis in enumerate("xyz"):
        rows[axis], rows["n" + axis] = points[:, i], outward[:, i]
    polygons = [list(map(int, face)) for face in faces[2:]] + [[0, 10, 11, 1]]  # faces 0 and its neighbour as one
    face = np.empty(len(polygons), [("vertex_indices", object), ("flags", "u1")])
    face["vertex_indices"], face["flags"] = [np.array(p, "i4") for p in polygons], 7
    strips = np.empty(2, [("numbers", object)])
    strips["numbers"] = [np.array([1.5], "f8"), np.array([2.5, 3.5], "f8")]
    elements = [PlyElement.describe(strips, "history"), PlyElement.describe(rows, "vertex"), PlyElement.describe(face, "face")]
    expected = corners(points, np.vstack([faces[2:], [[0, 10, 11], [0, 11, 1]]]))

    for text, order in ((True, "="), (False, "<"), (False, ">")):
        path = tmp_path / "a.ply"
        PlyData(elements, text=text, byte_order=order).write(str(path))
        scan = read_one(path)
        assert scan.triangles is not None and scan.normals is not None
        np.testing.assert_array_equal(corners(scan.points, scan.triangles), expected)
        np.testing.assert_allclose(scan.normals, np.tile([0.0, 0.6, 0.8], (len(points), 1)), rtol=0, atol=1e-7)


def test_obj_counts_back_and_forth(tmp_path: Path) -> None:
    """Negative indices, texture and normal indices, colours, a polygon, a continued line."""
    points, faces = torus()
    lines = [f"v {x!r} {y!r} {z!r} 0.5 0.5 0.5" for x, y, z in points.tolist()]
    n = len(points)
    lines += ["vt 0 0", "vn 0 0 1", "g part"]
    lines += [f"f {a - n}//1 {b - n}//1 \\\n {c - n}//1" for a, b, c in faces[::2]]
    lines += [f"f {a + 1}/1/1 {b + 1}/1/1 {c + 1}/1/1" for a, b, c in faces[1::2]]
    path = tmp_path / "a.obj"
    path.write_text("\n".join(lines))
    scan = read_one(path)
    assert scan.triangles is not None
    np.testing.assert_array_equal(corners(scan.points, scan.triangles), corners(points, faces))


def test_a_3mf_keeps_its_own_unit(tmp_path: Path) -> None:
    import trimesh

    points, faces = torus()
    part = trimesh.Trimesh(points / 25.4, faces, process=False)
    part.units = "inches"
    path = tmp_path / "a.3mf"
    path.write_bytes(part.export(file_type="3mf"))
    import zipfile

    with zipfile.ZipFile(path) as archive:
        stated = b'unit="inch"' in archive.read("3D/3dmodel.model")
    if not stated:  # older writers always say millimeter
        model = {n: zipfile.ZipFile(path).read(n) for n in zipfile.ZipFile(path).namelist()}
        with zipfile.ZipFile(path, "w") as archive:
            for name, data in model.items():
                archive.writestr(name, data.replace(b'unit="millimeter"', b'unit="inch"'))
    np.testing.assert_allclose(read_one(path).points.max(axis=0), points.max(axis=0), rtol=0, atol=1e-4)
    np.testing.assert_allclose(read_one(path, "cm").points.max(axis=0), points.max(axis=0) * 10 / 25.4, rtol=0, atol=1e-4)


@pytest.mark.parametrize(
    ("units", "millimetres"), [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("um", 1e-3), ("in", 25.4), ("inch", 25.4)]
)
def test_units_scale_the_points(tmp_path: Path, units: str, millimetres: float) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(ball()))
    np.testing.assert_array_equal(read_one(path, units).points, ball() * millimetres)


def test_views_are_numbered_in_the_order_given(tmp_path: Path) -> None:
    for i in range(3):
        (tmp_path / f"{i}.xyz").write_bytes(xyz(ball(150 + i, seed=i)))
    scans = read_scan([tmp_path / f"{i}.xyz" for i in range(3)])
    assert [len(scan) for scan in scans] == [150, 151, 152]
    assert [set(scan.view.tolist()) for scan in scans] == [{0}, {1}, {2}]
    assert all(scan.view.dtype == np.int8 for scan in scans)


@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6, width=32)] * 3), min_size=100, max_size=120, unique=True),
    st.sampled_from(sorted(set(CLOUDS) - {"a.e57", "a.las", "a.laz"})),
)
@settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[
        HealthCheck.function_scoped_fixture,
        HealthCheck.too_slow,
        HealthCheck.data_too_large,
        HealthCheck.large_base_example,
    ],
)
def test_no_point_is_changed_whatever_the_numbers(tmp_path: Path, rows: list[tuple[float, float, float]], name: str) -> None:
    """Cleaning may take points out (and counts them); those that stay are bit for bit in the file, in its order."""
    points = np.array(rows)
    path = tmp_path / name
    path.write_bytes(CLOUDS[name](points))
    from gearwear.errors import InputError

    try:
        scan = read_one(path)
    except InputError as error:
        assert "can be used" in str(error)
        return
    assert len(scan) + sum(scan.rejected.values()) == len(points)
    if scan.kind == "cloud":
        written = [tuple(row) for row in points.tolist()]
        places = [written.index(tuple(row)) for row in scan.points.tolist()]
        assert places == sorted(places)

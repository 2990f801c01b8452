"""Surfaces placed by a scene: where they come out, held against trimesh, which shares no code with the readers here."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from gearwear.errors import InputError
from gearwear.scan import read_one
from gearwear.scan.glb import read_glb
from gearwear.scan.threemf import read_3mf
from tests.hostile.made import glb
from tests.scan.writers import torus

trimesh = pytest.importorskip("trimesh")


def placed() -> tuple[object, np.ndarray]:
    """A scene of one torus three times – as it is, turned and shifted below another node, mirrored – and all its corners, triangle by triangle."""
    points, faces = torus()
    part = trimesh.Trimesh(points, faces, process=False)
    turned = trimesh.transformations.rotation_matrix(0.7, [1.0, 2.0, 3.0]) @ np.diag([2.0, 2.0, 2.0, 1.0])
    turned[:3, 3] = 100.0, -20.0, 3.0
    shift = np.eye(4)
    shift[:3, 3] = 0.0, 0.0, 500.0
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    mirror[0, 3] = -300.0
    scene = trimesh.Scene()
    scene.add_geometry(part, node_name="plain", geom_name="part")
    scene.graph.update("group", matrix=shift)
    scene.graph.update("turned", "group", matrix=turned, geometry="part")
    scene.graph.update("mirrored", matrix=mirror, geometry="part")
    places = [np.eye(4), shift @ turned, mirror]
    every = [points[faces] @ place[:3, :3].T + place[:3, 3] for place in places]
    every[2] = every[2][:, ::-1]  # still outward
    return scene, np.concatenate(every)


def volumes(corners: np.ndarray) -> float:
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)


@pytest.mark.parametrize("kind", ["glb", "3mf"])
def test_places(kind):
    scene, expected = placed()
    found = (read_glb if kind == "glb" else read_3mf)(scene.export(file_type=kind))
    corners = found.points[found.triangles]
    assert len(corners) == len(expected)
    close = 1e-4  # single precision at 600 mm; 3MF in text
    for tooth in (corners.min(axis=(0, 1)) - expected.min(axis=(0, 1)), corners.max(axis=(0, 1)) - expected.max(axis=(0, 1))):
        np.testing.assert_allclose(tooth, 0.0, atol=close)
    np.testing.assert_allclose(np.sort(corners.sum(axis=(1, 2))), np.sort(expected.sum(axis=(1, 2))), rtol=0, atol=9 * close)
    assert volumes(corners) == pytest.approx(volumes(expected), rel=1e-5)  # a side turned round would take its volume off


def strip_of(mode: int, order: list[int] | None, **position: object) -> np.ndarray:
    """Triangles of a GLB of a unit square, (m, 3, 3)."""
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], "<f4")
    primitive: dict[str, object] = {"attributes": {"POSITION": 0}, "mode": mode}
    accessors: list[dict[str, object]] = [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", **position}]
    binary = square.tobytes()
    if order is not None:
        primitive["indices"] = 1
        accessors.append({"bufferView": 0, "byteOffset": 48, "componentType": 5121, "count": len(order), "type": "SCALAR"})
        binary += bytes(order)
    tree = {
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}], "accessors": accessors,
        "bufferViews": [{"buffer": 0, "byteLength": len(binary)}], "buffers": [{"byteLength": len(binary)}],
    }  # fmt: skip
    found = read_glb(glb(tree, binary))
    return np.empty((0, 3, 3)) if found.triangles is None else found.points[found.triangles]


def test_strips_fans_and_points():
    """A strip and a fan of four corners are the square, both triangles the same way up; points and lines are none."""
    for mode, order in ((5, None), (5, [0, 1, 2, 3]), (6, [0, 1, 3, 2]), (4, [0, 1, 2, 1, 3, 2])):
        corners = strip_of(mode, order)
        area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
        np.testing.assert_allclose(area, [0.5, 0.5], rtol=0, atol=0)
    for mode in (0, 1, 2, 3):
        assert not len(strip_of(mode, None))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"bufferView": 7}, "entry 7 of a list of 1"),
        ({"bufferView": -1}, "entry -1 of a list"),
        ({"byteOffset": 1}, "promises 4 values"),
        ({"count": 10**12}, "promises 1,000,000,000,000 values"),
        ({"sparse": {}}, "sparse"),
    ],
)
def test_what_does_not_fit_is_refused(change, says):
    with pytest.raises(InputError, match=says):
        strip_of(4, None, **change)


def test_compressed_and_elsewhere():
    data = glb({"extensionsRequired": ["KHR_draco_mesh_compression"]}, b"")
    with pytest.raises(InputError, match="compressed by KHR_draco"):
        read_glb(data)


def test_3mf_places_what_stands_in_another_part(tmp_path: Path):
    """The production extension: the root builds an object of another model."""
    points, faces = torus()
    out = trimesh.Trimesh(points, faces, process=False).export(file_type="3mf")
    with zipfile.ZipFile(io.BytesIO(out)) as old:
        model = old.read("3D/3dmodel.model").decode()
    number = (
        model[model.index("<object id=") :].split('"')[1] if "<object id=" in model else model.split(' id="', 1)[1].split('"')[0]
    )
    root = (
        '<model unit="inch" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:p="x"><resources/>'
        f'<build><item objectid="{number}" p:path="/3D/other.model"/></build></model>'
    )
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as new:
        new.writestr("3D/3dmodel.model", root)
        new.writestr("3D/other.model", model)
    scan = read_one(tmp_path / "a.3mf")
    assert scan.units == "in"
    np.testing.assert_allclose(np.ptp(scan.points, axis=0), 25.4 * np.ptp(points, axis=0), rtol=1e-4)


def test_a_chunk_and_a_head_that_are_longer_than_the_file():
    data = glb({}, b"")
    with pytest.raises(InputError, match="promises"):
        read_glb(data[:12] + struct.pack("<I", 10**9) + data[16:])
    with pytest.raises(InputError, match="promises 1,000,000,000 bytes and"):
        read_glb(data[:8] + struct.pack("<I", 10**9) + data[12:])
    with pytest.raises(json.JSONDecodeError):
        read_glb(data[:20] + b"x" + data[21:])

"""Scenes: what one thing placed twice, once as its mirror image, encloses."""

from __future__ import annotations

import struct

import numpy as np
import pytest
import trimesh

from gearwear.errors import InputError
from gearwear.scan.glb import read_glb
from gearwear.scan.threemf import read_3mf
from gearwear.scan.triangles import vertex_normals

SIZE = np.array([2.0, 3.0, 5.0])
PLACES = {
    "turned": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "mirrored": np.diag([-1.0, 1.0, 1.0]),
    "mirrored and turned": np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", ["glb", "3mf"])
def test_what_a_mirror_image_encloses_is_inside_it(kind, place):
    """Divergence theorem: ∑ a · (b × c) / 6 over all triangles is the volume, and would be nothing, were one of the two inside out."""
    block = trimesh.creation.box(SIZE)
    move = np.eye(4)
    move[:3, :3], move[:3, 3] = PLACES[place], (20.0, 1.0, -4.0)
    scene = trimesh.Scene()
    scene.add_geometry(block, node_name="plain", geom_name="block")
    scene.add_geometry(block, node_name="other", geom_name="block", transform=move)
    data = scene.export(file_type=kind)
    contents = (read_glb if kind == "glb" else read_3mf)(data)
    assert contents.triangles is not None
    a, b, c = (contents.points[contents.triangles[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(2.0 * SIZE.prod(), rel=1e-6)
    # and the normals of a block's corners point away from its middle
    normals = vertex_normals(contents.points, contents.triangles)
    for middle in (np.zeros(3), move[:3, 3]):
        own = np.linalg.norm(contents.points - middle, axis=1) < np.linalg.norm(SIZE)
        assert (np.einsum("ij,ij->i", normals[own], contents.points[own] - middle) > 0.0).all()


def test_a_glb_shorter_than_it_says_is_refused():
    data = bytearray(trimesh.creation.box(SIZE).export(file_type="glb"))
    assert len(read_glb(bytes(data)).points) == 8
    data[8:12] = struct.pack("<I", len(data) + 4)
    with pytest.raises(InputError, match="bytes"):
        read_glb(bytes(data))

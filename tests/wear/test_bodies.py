"""The boolean's pieces, against boxes whose volumes are known."""

import numpy as np
import pytest
import trimesh

from gearwear.report.files.solids import write_3mf, write_stl
from gearwear.wear.solid import Triangles, signed_difference, worn_bodies

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=np.float64)
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
FACES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])


def boxes(*low_and_edge):
    """Cubes from their lowest corner on the diagonal and their edge, as one surface."""
    parts = [low + edge * CORNERS for low, edge in low_and_edge]
    return Triangles(np.vstack(parts), np.vstack([FACES + 8 * i for i in range(len(parts))]))


THREE = boxes((0.0, 1.0), (10.0, 3.0), (20.0, 2.0))


def test_a_body_for_each_piece_that_is_gone_largest_first():
    bodies = worn_bodies(THREE, boxes((19.0, 4.0)))
    np.testing.assert_allclose([body.volume for body in bodies], [27.0, 1.0], rtol=1e-12)
    assert [len(body.vertices) for body in bodies] == [8, 8]


def test_each_body_is_closed():
    """Every edge runs once in each direction."""
    bodies = worn_bodies(THREE, boxes((11.0, 1.0)))  # the second is hollow: two surfaces, and so two pieces
    assert len(bodies) == 3
    for body in bodies:
        start, end = body.faces.ravel(), np.roll(body.faces, -1, axis=1).ravel()
        assert sorted(zip(start, end, strict=True)) == sorted(zip(end, start, strict=True))


def test_a_body_is_closed_in_the_single_precision_of_a_file(tmp_path):
    """A wedge off a cube's top that ends 1e-8 mm below an edge of it, not on it: 0.25 mm³."""
    lower = np.where(CORNERS[:, 2] == 1.0, np.where(CORNERS[:, 0] == 1.0, 0.5, 1e-8), 0.0)
    worn = Triangles(CORNERS - lower[:, None] * [0.0, 0.0, 1.0], FACES[::-1])
    (body,) = worn_bodies(boxes((0.0, 1.0)), worn)
    assert body.volume == pytest.approx(0.25, abs=1e-7)
    write_stl(tmp_path / "body.stl", [body], "body")
    write_3mf(tmp_path / "body.3mf", [body], ["body"])
    for name in ("body.stl", "body.3mf"):
        read = trimesh.load(tmp_path / name, force="mesh")
        assert read.is_watertight and read.volume == pytest.approx(0.25, abs=1e-6)


def test_nothing_gone_leaves_no_body():
    assert worn_bodies(THREE, THREE) == []


@pytest.mark.parametrize(("seen", "kept"), [((0.0, 0.0), 1), ((0.02, 0.01), 1), ((0.005, 0.1), 1), ((0.02, 0.1), 0)])
def test_a_piece_both_thin_and_small_is_no_body(seen, kept):
    """What is left round a cube of 0.99 mm in one of 1 mm: 0.0297 mm³, on average 0.0099 mm thick."""
    assert len(worn_bodies(THREE, boxes((0.01, 0.99), (10.0, 3.0), (20.0, 2.0)), seen)) == kept


def test_signed_difference_counts_the_pieces():
    removed, signed, pieces = signed_difference(THREE, boxes((10.0, 3.0), (30.0, 1.0)))
    assert pieces == 2
    np.testing.assert_allclose([removed, signed], [9.0, 8.0], rtol=1e-12)

"""The triangles of the 3-D view: closed, outward, as large as the gear and the lost metal."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.report.figures.colours import ColourScale
from gearwear.report.figures.scene import eye_direction, scene, still
from gearwear.report.figures.surfaces import FLANK_VERTICES, gear_surfaces, worn_volume
from tests.report.fake import WORN, fake_arrays, fake_regions


@pytest.fixture(scope="module")
def arrays():
    return fake_arrays()


@pytest.fixture(scope="module")
def worn(arrays):
    return gear_surfaces(arrays, worn=True)


def volume(pieces):
    """By the divergence theorem: right only if all faces are turned outwards and nothing is missing."""
    total = 0.0
    for piece in pieces:
        a, b, c = piece.vertices[piece.faces].transpose(1, 0, 2)
        total += np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    return total


def removed(arrays):
    """∫∫ (d L − d²/2) / r_b dL dz over the cells (reference B1)."""
    gear, depth = arrays.gear, 1e-3 * arrays.wear_depth_um
    edges = np.sqrt(np.linspace(gear.form_roll**2, gear.tip_roll**2, len(arrays.roll_mm) + 1))
    height = gear.face_width / len(arrays.z_mm)
    return float(((depth * arrays.roll_mm - 0.5 * depth**2) / gear.base_radius * np.diff(edges)).sum() * height)


def test_the_worn_gear_is_the_exact_gear_less_the_lost_metal(arrays, worn):
    exact = arrays.gear.section_area() * arrays.gear.face_width
    assert volume(worn) == pytest.approx(exact - removed(arrays), rel=2e-3)
    lost = worn_volume(arrays)
    assert lost is not None
    assert volume([lost]) == pytest.approx(removed(arrays), rel=0.01)


def test_bodies_of_lost_metal_are_closed(arrays):
    lost = worn_volume(arrays)
    edges = np.sort(lost.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count % 2 == 0).all()
    assert set(lost.tooth) == {tooth + 1 for tooth, _ in WORN}


def test_no_wear_no_body():
    assert worn_volume(fake_arrays(worn=False)) is None


def test_deviations_and_teeth_are_where_they_were_measured(arrays, worn):
    left = next(piece for piece in worn if piece.name == "left flank")
    tooth = np.rint(np.arctan2(left.vertices[:, 1], left.vertices[:, 0]) / arrays.gear.pitch_angle).astype(int) % 12 + 1
    assert (tooth == left.tooth).mean() == 1.0
    deep = left.tooth[left.deviation_um < -1000.0]
    assert set(deep) == {2}
    right = next(piece for piece in worn if piece.name == "right flank")
    hole = np.isnan(right.deviation_um)
    assert set(right.tooth[hole]) == {5}
    tip = next(piece for piece in worn if piece.name == "tip")
    assert np.nanmean(tip.deviation_um) == pytest.approx(20.0, abs=0.5)


@pytest.mark.parametrize("teeth", [12, 24, 90])
def test_the_budget_holds_for_any_number_of_teeth(teeth):
    pieces = gear_surfaces(fake_arrays(teeth, columns=60, rows=80), worn=True)
    flanks = sum(len(piece.vertices) for piece in pieces if "flank" in piece.name)
    assert flanks <= FLANK_VERTICES


def unpacked(array):
    flat = np.frombuffer(base64.b64decode(array["bdata"]), dtype="<" + array["dtype"])
    return flat.reshape([int(n) for n in array["shape"].split(",")]) if "shape" in array else flat


def test_the_scene_holds_the_pieces_as_typed_arrays(arrays, worn):
    scale = ColourScale(2000.0, 40.0)
    eye = eye_direction(fake_regions(), arrays.gear)
    drawn = scene(gear_surfaces(arrays, worn=False), worn, worn_volume(arrays), scale, eye)
    assert sorted(number for group in drawn["groups"].values() for number in group) == list(range(len(drawn["data"])))
    assert all(drawn["groups"].values())
    faces = 0
    for number, trace in enumerate(drawn["data"]):
        points = np.stack([unpacked(trace[key]) for key in "xyz"], axis=1)
        corners = np.stack([unpacked(trace[key]) for key in "ijk"], axis=1)
        assert corners.max() < len(points)
        assert np.isfinite(points).all()
        assert trace.get("visible", True) is (number in drawn["groups"]["worn"])
        if number in drawn["groups"]["worn"]:
            faces += len(corners)
        if "intensity" in trace:
            shown = unpacked(trace["customdata"])
            np.testing.assert_allclose(unpacked(trace["intensity"]), scale.fraction(shown[:, 2].astype(float)), atol=1e-6)
            np.testing.assert_allclose(shown[:, 1], np.hypot(points[:, 0], points[:, 1]), rtol=1e-5)
            assert (trace["cmin"], trace["cmax"]) == (-1.0, 1.0)
    assert faces == sum(len(piece.faces) for piece in worn), "each face once, seen or not"
    assert sum("colorbar" in trace for trace in drawn["data"]) == 1


def test_the_worst_flank_faces_the_viewer(arrays):
    for tooth, side in ((2, Side.LEFT), (7, Side.RIGHT)):
        region = replace(fake_regions()[0], tooth=tooth - 1, side=side)
        angle = (tooth - 1) * arrays.gear.pitch_angle
        outward = side * np.array([-np.sin(angle), np.cos(angle), 0.0])
        assert eye_direction([region], arrays.gear) @ outward > 0.5


def test_the_still_picture_is_no_blank(arrays, worn):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(3, 2), dpi=60)
    canvas = FigureCanvasAgg(figure)
    axis = figure.add_axes((0, 0, 1, 1))
    assert still(axis, worn, ColourScale(2000.0, 40.0), eye_direction(fake_regions(), arrays.gear)) is axis
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].astype(int)
    assert (pixels.min(axis=2) < 230).mean() > 0.2, "the gear covers some of it"
    blue = (pixels[..., 2] - pixels[..., 0] > 80).mean()
    assert blue > 1e-3, "and its worn flank is in sight"

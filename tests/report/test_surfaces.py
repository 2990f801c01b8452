"""The triangles of the 3-D view: closed, outward, as large as the gear and the lost metal."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points
from gearwear.report.figures.colours import ColourScale
from gearwear.report.figures.scene import eye_direction, scene, still, tooth_labels
from gearwear.report.figures.surfaces import FLANK_VERTICES, gear_surfaces, worn_volume
from gearwear.report.figures.views import coloured_gears
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


def test_the_budget_holds_where_a_flank_is_far_longer_than_high():
    """Eight columns are drawn of seven cells: only rows can be spared."""
    pieces = gear_surfaces(fake_arrays(80, columns=7, rows=71), worn=True)
    assert sum(len(piece.vertices) for piece in pieces if "flank" in piece.name) <= FLANK_VERTICES


def test_teeth_that_are_alike_come_once(arrays):
    views = coloured_gears(arrays, ColourScale(40.0), worn=False)
    drawn = scene(views, gear_surfaces(arrays, worn=False), None, eye_direction([], arrays.gear), arrays.gear)
    times = {surface["name"]: surface["faces"]["times"] for surface in drawn["surfaces"]}
    assert times.pop("end face") == 1
    assert set(times.values()) == {arrays.gear.teeth}


def unpacked(data, kind):
    return np.frombuffer(base64.b64decode(data), dtype="<" + kind)


def test_the_scene_holds_the_pieces_in_whole_numbers(arrays):
    views = coloured_gears(arrays, ColourScale(2000.0, 40.0), worn=True)
    assert [view.key for view in views] == ["wear", "effects_out", "measured"]
    nominal, lost = gear_surfaces(arrays, worn=False), worn_volume(arrays)
    drawn = scene(views, nominal, lost, eye_direction(fake_regions(), arrays.gear), arrays.gear)
    json.dumps(drawn, allow_nan=False)
    low, high = np.array(drawn["box"])
    worn = views[0].pieces
    for packed, piece in zip(drawn["surfaces"], [*worn, lost, *nominal], strict=True):
        corners = low + unpacked(packed["corners"]["data"], "u2").reshape(-1, 3) * (high - low) / 65535.0
        np.testing.assert_allclose(corners, piece.vertices, atol=1.01 * (high - low).max() / 131070.0)
        once = unpacked(packed["faces"]["data"], packed["faces"]["kind"]).reshape(-1, 3).astype(int)
        further = packed["faces"]["further"] * np.arange(packed["faces"]["times"])
        np.testing.assert_array_equal((once + further[:, None, None]).reshape(-1, 3), piece.faces)
        starts, teeth = np.transpose(packed["teeth"])
        np.testing.assert_array_equal(np.repeat(teeth, np.diff([*starts, len(piece.vertices)])), piece.tooth)
    for i, packed in enumerate(drawn["surfaces"][: len(worn)]):
        shown = {view.key: view.pieces[i].deviation_um for view in views}
        assert set(packed["values"]) == {key for key, um in shown.items() if um is not None}
        for key, values in packed["values"].items():
            whole = unpacked(values["data"], "i2")
            np.testing.assert_array_equal(whole == -32768, np.isnan(shown[key]))
            seen = whole != -32768
            np.testing.assert_allclose(values["step"] * whole[seen], shown[key][seen], atol=0.501 * values["step"])
            assert values["step"] <= 0.1 or np.abs(shown[key][seen]).max() > 3276.0


def test_wear_is_first_where_there_is_any_and_has_no_sign(arrays):
    first, second = coloured_gears(fake_arrays(worn=False), ColourScale(40.0), worn=False)
    assert (first.key, first.high, second.key) == ("effects_out", 1.0, "measured")
    wear = coloured_gears(arrays, ColourScale(40.0), worn=True)[0]
    assert wear.high == 0.0
    assert all(at <= 0.0 and "−" not in text for at, text in wear.ticks)
    depth = np.concatenate([piece.deviation_um for piece in wear.pieces if piece.deviation_um is not None])
    assert -np.nanmin(depth) == pytest.approx(1550.0, rel=0.02) and np.nanmax(depth) <= 0.0


@pytest.mark.parametrize("teeth", [12, 37])
def test_tooth_numbers_stand_outside_their_tooth(teeth):
    arrays = fake_arrays(teeth)
    labels = tooth_labels(gear_surfaces(arrays, worn=True), arrays.gear)
    assert [label["text"] for label in labels] == [str(tooth) for tooth in range(1, teeth + 1)]
    for label in labels:
        x, y, z = label["at"]
        angle = (int(label["text"]) - 1) * arrays.gear.pitch_angle
        np.testing.assert_allclose([x, y], 1.05 * arrays.gear.tip_radius * np.array([np.cos(angle), np.sin(angle)]), atol=0.05)
        assert z == arrays.gear.face_width


def test_the_worst_flank_faces_the_viewer(arrays):
    for tooth, side in ((2, Side.LEFT), (7, Side.RIGHT)):
        region = replace(fake_regions()[0], tooth=tooth - 1, side=side)
        angle = (tooth - 1) * arrays.gear.pitch_angle
        outward = side * np.array([-np.sin(angle), np.cos(angle), 0.0])
        assert eye_direction([region], arrays.gear) @ outward > 0.5


@pytest.mark.parametrize("internal", [False, True])
@pytest.mark.parametrize(("tooth", "side"), [(0, Side.LEFT), (10, Side.RIGHT), (30, Side.LEFT)])
def test_the_flank_that_lost_most_faces_the_viewer_in_a_ring_too(internal, tooth, side):
    """By its own normal; the flanks of a ring were looked at from behind, and its deepest wear was not in the first view."""
    outside = {"internal": True, "rim_diameter": 144.0, "addendum": 0.8} if internal else {}
    gear = Gear.from_spec(GearSpec("gear", 48, 2.5, 15.0, **outside))
    middle = np.array([0.5 * (gear.form_roll + gear.tip_roll)])
    normal = flank_points(gear, np.array([tooth]), np.array([int(side)]), middle, np.array([7.5])).normal[0]
    eye = eye_direction([SimpleNamespace(tooth=tooth, side=side)], gear)
    radial = np.array([np.cos(tooth * gear.pitch_angle), np.sin(tooth * gear.pitch_angle), 0.0])
    assert eye @ normal > 0.4 and (eye @ radial < 0.0) == internal and eye[2] > 0.5


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

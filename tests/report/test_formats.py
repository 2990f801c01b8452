"""Files for other programs, each read back by one that shares nothing with the writer."""

from __future__ import annotations

import csv
import json
import struct
import sys
from pathlib import Path

import numpy as np
import pytest

from gearwear.cli import main
from gearwear.design.gear import Gear
from gearwear.design.profiles import nominal_profiles
from gearwear.design.spec import GearSpec
from gearwear.errors import InputError
from gearwear.report.figures.colours import ColourScale
from gearwear.report.files.extras import EXTRAS
from gearwear.report.files.glb import painted, write_glb
from gearwear.report.files.tables import write_sections_dxf
from gearwear.report.write import write_results
from gearwear.wear.solid import gear_triangles, on_outline
from tests.report.fake import real_results

WORN_TOOTH, COAT = 1, 0.02


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> tuple[Path, dict]:
    folder = tmp_path_factory.mktemp("written")
    write_results(real_results(), folder, page=False, also=frozenset(EXTRAS))
    return folder, json.loads((folder / "report.json").read_text("utf-8"))


def test_the_report_names_every_file(written):
    folder, report = written
    assert set(report["files"]) == {path.name for path in folder.iterdir()}
    assert {"worn_gear.glb", "worn_volume.glb", "points.parquet", "topography.csv"} <= set(report["files"])


def test_glb_is_the_worn_gear_in_metres_with_y_up(written):
    trimesh = pytest.importorskip("trimesh")
    folder, report = written
    gear = trimesh.load(folder / "worn_gear.glb").to_geometry()
    gear = trimesh.Trimesh(gear.vertices, gear.faces)  # ends and flanks have corners of their own, in the same places
    assert gear.is_watertight
    np.testing.assert_allclose(gear.bounds[:, 1], [0.0, 0.015], atol=1e-9)  # the face width stands up
    np.testing.assert_allclose(np.abs(gear.bounds[:, [0, 2]]).max(), 0.04445, atol=1e-6)
    nominal = real_results().gear.section_area() * 15.0
    lost = sum(body.volume for body in trimesh.load(folder / "worn_volume.glb").dump()) * 1e9
    assert lost == pytest.approx(report["wear"]["solid"]["volume_mm3"], rel=1e-4)
    # Straight steps between the nodes of a curved flank leave a little of the section out.
    assert gear.volume * 1e9 + lost == pytest.approx(nominal, rel=2e-3)
    stl = trimesh.load(folder / "worn_gear.stl")
    assert gear.volume * 1e9 == pytest.approx(stl.volume, rel=1e-5)


def glb_parts(path: Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    magic, version, length, size, kind = struct.unpack("<4sIII4s", data[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    rest, kind = struct.unpack("<I4s", data[20 + size : 28 + size])
    assert (rest, kind) == (len(data) - 28 - size, b"BIN\0")
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def values(document: dict, data: bytes, accessor: int) -> np.ndarray:
    one = document["accessors"][accessor]
    view = document["bufferViews"][one["bufferView"]]
    assert view["byteOffset"] % 4 == 0
    kind = {5126: "<f4", 5125: "<u4", 5121: "u1"}[one["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[one["type"]]
    return np.frombuffer(data, kind, one["count"] * width, view["byteOffset"]).reshape(-1, width)


def test_glb_is_blue_where_metal_is_missing_and_nowhere_else(written):
    document, data = glb_parts(written[0] / "worn_gear.glb")
    (primitive,) = document["meshes"][0]["primitives"]
    where = values(document, data, primitive["attributes"]["POSITION"])
    colour = values(document, data, primitive["attributes"]["COLOR_0"])[:, :3].astype(int)
    lost = real_results().wear.worn.loss
    expected = on_outline(real_results().wear.worn, lost) > 0.15
    blue = (colour[:, 2] > colour[:, 0] + 10) & (colour[:, 0] < 100)  # linear light, where the end of the scale is dark
    assert expected.any()
    assert blue[: len(expected)][expected].all()
    assert not blue[len(expected) :].any() and (np.ptp(colour[len(expected) :], axis=0) == 0).all(), "the ends are grey"
    angle = np.degrees(np.arctan2(where[:, 1], where[:, 0]))
    assert np.abs(angle[blue] - 30.0 * WORN_TOOTH).max() < 15.0
    np.testing.assert_allclose(document["accessors"][primitive["attributes"]["POSITION"]]["min"], where.min(axis=0), rtol=1e-6)


def test_ply_points_have_scalar_fields_and_the_colours_of_the_page(written):
    plyfile = pytest.importorskip("plyfile")
    vertex = plyfile.PlyData.read(written[0] / "points.ply")["vertex"]
    deviation, located = vertex["scalar_deviation_um"], real_results().measured.placed.located
    empty = np.isnan(deviation)
    np.testing.assert_allclose(deviation[~empty], 1e3 * located.deviation[~empty], rtol=1e-6)
    assert empty.sum() < 0.01 * len(deviation)
    assert np.abs(deviation[~empty]).max() < 350.0  # 300 µm of wear; strays, thrown by tenths of a millimetre, are left empty
    rgb = np.column_stack([vertex[name] for name in ("red", "green", "blue")]).astype(int)
    deep, coat = deviation < -250.0, np.abs(deviation - 1e3 * COAT) < 2.0
    assert deep.any() and (rgb[deep, 2] > rgb[deep, 0] + 50).all()
    assert (rgb[coat, 0] > rgb[coat, 2]).all()


def test_dxf_sections_are_closed_outlines_of_the_whole_gear(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    worn, heights = real_results().wear.worn, [2.0, 7.5]
    write_sections_dxf(tmp_path / "sections.dxf", worn, heights)
    drawing = ezdxf.readfile(tmp_path / "sections.dxf")
    areas = {}
    for line in drawing.modelspace():
        assert line.is_closed
        x, y, z = np.array([vertex.dxf.location for vertex in line.vertices]).T
        areas[line.dxf.layer, round(float(z[0]), 6)] = 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    assert set(areas) == {(layer, z) for layer in ("NOMINAL", "WORN") for z in heights}
    for z in heights:  # chords cut off some of the round flanks, and add some in the hollow fillets: together 3 in 10,000
        assert areas["NOMINAL", z] == pytest.approx(worn.gear.section_area(), rel=5e-4)
    lost = [areas["NOMINAL", z] - areas["WORN", z] for z in heights]
    assert lost[1] > 0.5 and lost[1] > 2.0 * lost[0], "the patch is deepest at mid-height and ends at z = 3 mm"


def test_values_on_the_outline_lie_where_the_vertices_are():
    gear = Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0))
    profiles = nominal_profiles(gear, np.linspace(gear.root_radius, gear.tip_radius, 30), np.linspace(0.0, 15.0, 4))
    vertices = gear_triangles(profiles).vertices[:-2]
    radius = np.broadcast_to(profiles.radius, profiles.half_angle.shape)
    height = np.broadcast_to(profiles.z[:, None], profiles.half_angle.shape)
    np.testing.assert_allclose(on_outline(profiles, radius)[:-2], np.hypot(vertices[:, 0], vertices[:, 1]), rtol=1e-12)
    np.testing.assert_allclose(on_outline(profiles, height)[:-2], vertices[:, 2], rtol=1e-12)
    tooth = np.broadcast_to(np.arange(12.0)[:, None, None, None], profiles.half_angle.shape)
    own = on_outline(profiles, tooth)[:-2]
    angle = np.degrees(np.arctan2(vertices[:, 1], vertices[:, 0]))
    on_tooth = (own == np.rint(own)) & (np.hypot(vertices[:, 0], vertices[:, 1]) > 40.0)
    np.testing.assert_array_equal(np.mod(np.rint(angle[on_tooth] / 30.0), 12), own[on_tooth])


def test_the_ends_of_the_scale_have_the_ends_of_the_colours(tmp_path):
    gear = Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0))
    body = gear_triangles(nominal_profiles(gear, np.array([gear.root_radius, gear.tip_radius]), np.array([0.0, 15.0])))
    shown = np.full(len(body.vertices), np.nan)
    shown[:3] = [-200.0, 0.0, 200.0]
    paint = painted("gear", body, shown, ColourScale(100.0))
    np.testing.assert_allclose(paint.colour[:3] * 255, [[5, 48, 97], [245, 245, 243], [103, 0, 31]])
    np.testing.assert_allclose(paint.colour[3:], 0.7)
    write_glb(tmp_path / "two.glb", [paint, paint])
    assert len(glb_parts(tmp_path / "two.glb")[0]["nodes"]) == 2


def test_arrays_hold_the_points_as_placed(written):
    """Fed back as a scan they are the worn gear again, and not the design that their feet lie on."""
    with np.load(written[0] / "points.npz") as points:
        known = np.isfinite(points["deviation"])
        off = points["position"] - points["foot"]
        np.testing.assert_allclose((off * points["normal"]).sum(axis=1)[known], points["deviation"][known], atol=1e-9)
        assert points["deviation"][known].min() < -0.25  # the worn tooth
    table = pytest.importorskip("pyarrow.parquet").read_table(written[0] / "points.parquet")
    with np.load(written[0] / "points.npz") as points:
        np.testing.assert_allclose(table["x_mm"].to_numpy(), points["position"][:, 0], atol=1e-4)


def test_parquet_holds_every_point(written):
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(written[0] / "points.parquet")
    with np.load(written[0] / "points.npz") as points:
        assert table.num_rows == len(points["deviation"])
        np.testing.assert_allclose(table["deviation_um"].to_numpy(), 1e3 * points["deviation"], rtol=1e-5, atol=1e-4)
        names = np.array(table["surface"].to_pylist())
        assert set(names) <= {"flank", "fillet", "root", "tip", "end_low", "end_high", "bore", "other"}
        assert (names[points["surface"] == 0] == "flank").all()
    assert table["roll_mm"].null_count == (names != "flank").sum()
    assert table["flank"].null_count == (~np.isin(names, ["flank", "fillet"])).sum()
    tooth, side, off = (np.array(table[name].to_pylist(), dtype=object) for name in ("tooth", "flank", "corrected_um"))
    right = np.array(
        [v for t, s, v, n in zip(tooth, side, off, names, strict=True) if n == "flank" and s == "right" and t is not None],
        dtype=float,
    )
    assert abs(np.median(right)) < 1.0  # the coat is taken out of the corrected deviation, µm
    worn = np.array(
        [v for t, s, v, n in zip(tooth, side, off, names, strict=True) if n == "flank" and s == "left" and t == WORN_TOOTH + 1],
        dtype=float,
    )
    assert worn.min() < -250.0
    assert b"gearwear" in table.schema.metadata


def test_parquet_without_pyarrow_is_refused_and_nothing_is_written(tmp_path, monkeypatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InputError, match="pip install pyarrow"):
        write_results(real_results(), tmp_path / "out", also=frozenset({"glb", "parquet"}))
    assert not (tmp_path / "out").exists()


def test_topography_adds_up_to_the_wear(written):
    with (written[0] / "topography.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    grid, wear = real_results().measured.cells.grid, real_results().wear.found
    assert len(rows) == 12 * 2 * grid.rows * grid.flank
    assert sum(int(row["points"]) for row in rows) == int(grid.flank_shape(real_results().measured.cells.count).sum())
    cell = (rows[0]["tooth"], rows[0]["flank"])
    assert cell == ("1", "left")
    depth = np.array([float(row["wear_depth_um"]) for row in rows])
    own = np.array([row["tooth"] == str(WORN_TOOTH + 1) and row["flank"] == "left" for row in rows])
    assert depth[~own].max() == 0.0
    # Volume as the sum of depth × area of the cells, which are equal in r².
    area = (
        (real_results().gear.tip_roll ** 2 - real_results().gear.form_roll ** 2)
        / (2 * real_results().gear.base_radius * grid.flank)
        * 15.0
        / grid.rows
    )
    assert depth[own].sum() * 1e-3 * area == pytest.approx(wear.volume, rel=0.05)
    for row in rows[:: len(rows) // 50]:
        assert float(row["radius_mm"]) ** 2 == pytest.approx(
            float(row["roll_mm"]) ** 2 + real_results().gear.base_radius ** 2, rel=1e-5
        )
        assert (row["deviation_um"] == "") == (row["points"] == "0")


def test_corrected_takes_the_coat_off_and_leaves_the_patch():
    located = real_results().measured.placed.located
    tip = located.surface == 3
    assert np.median(located.deviation[tip]) == pytest.approx(COAT, abs=0.001)
    assert np.median(real_results().corrected_deviation[tip]) == pytest.approx(0.0, abs=0.001)


def test_unknown_formats_are_refused_before_anything_is_read(capsys, tmp_path):
    assert main(["compare", "--write", "glb,vrml", "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert "--write vrml: one of ply, npz, parquet, topography, glb" in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()

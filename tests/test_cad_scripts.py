"""``cad/``: each script runs headless, in CQ-editor and with the OCP viewer, and keeps the flanks exact."""

from __future__ import annotations

import math
import runpy
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import build123d
import numpy as np
import pytest
from build123d import GeomType, Solid
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.TopoDS import TopoDS_Shape

from gearwear.design import Gear, read_design
from tests.brep.measuring import face_points, measure_faces
from tests.brep.rack_in_space import cut_depth

CAD = Path(__file__).resolve().parents[1] / "cad"
SCRIPTS = sorted(path.name for path in CAD.glob("*.py"))
EXAMPLE = CAD.parent / "gearwear" / "example" / "design.toml"


@pytest.fixture(autouse=True)
def headless(monkeypatch):
    """No viewer, whatever is installed here."""
    monkeypatch.setitem(sys.modules, "ocp_vscode", None)


@cache
def in_viewer(script: str) -> tuple[dict[str, Any], list[Any]]:
    """What a script leaves behind, and what it shows where the OCP viewer is installed; each is run once."""
    shown: list[Any] = []
    viewer = ModuleType("ocp_vscode")
    viewer.show = lambda *shapes, names, colors, alphas=None: shown.append((shapes, names, colors, alphas))
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "ocp_vscode", viewer)
        return runpy.run_path(str(CAD / script)), shown


def test_they_are_there():
    assert SCRIPTS == ["gear_with_hub.py", "helical_shaft.py", "pinion_with_keyway.py", "ring_with_bolts.py", "worn_volume.py"]


@pytest.mark.long
@pytest.mark.parametrize("script", SCRIPTS)
def test_each_shows_in_cq_editor_what_it_can_take(script, capsys):
    shown = []
    show = {"show_object": lambda shape, name, options: shown.append((shape, name, options))}
    runpy.run_path(str(CAD / script), init_globals=show)
    assert shown
    for shape, name, options in shown:
        # CQ-editor takes kernel shapes and CadQuery's own, not build123d's.
        assert isinstance(shape, TopoDS_Shape) or type(shape).__module__.startswith("cadquery")
        assert name
        assert set(options) <= {"color", "alpha"}
    assert capsys.readouterr().out


@pytest.mark.long
@pytest.mark.parametrize("script", SCRIPTS)
def test_each_shows_in_the_ocp_viewer(script):
    ((shapes, names, colors, alphas),) = in_viewer(script)[1]
    assert len(shapes) == len(names) == len(colors) == len(alphas or names)


def exact_faces(shape: TopoDS_Shape) -> list[build123d.Face]:
    assert BRepCheck_Analyzer(shape).IsValid()
    faces = Solid(shape).faces()
    return [face for face in faces if face.geom_type not in (GeomType.PLANE, GeomType.CYLINDER, GeomType.CONE)]


def test_bore_and_keyway_leave_the_flanks_exact():
    made, _ = in_viewer("pinion_with_keyway.py")
    gear = Gear.from_spec(replace(read_design(EXAMPLE).gears["pinion"].spec, bore_diameter=made["BORE"]))
    faces = exact_faces(made["part"].wrapped)
    assert len(faces) == 4 * 12
    found = measure_faces(faces, gear, along=9)
    assert found.flank < 1e-9
    assert found.fillet < 1e-8
    # The keyway takes the rectangle beyond the bore: down to the chord, less the bore's own segment.
    r, half = 0.5 * made["BORE"], 0.5 * made["KEY_WIDTH"]
    segment = r * r * math.asin(half / r) - half * math.sqrt(r * r - half * half)
    slot = 2 * half * (r + made["KEY_DEPTH"] - math.sqrt(r * r - half * half)) - segment
    assert made["part"].volume == pytest.approx((gear.section_area() - slot) * gear.face_width, rel=1e-9)


@pytest.mark.long
def test_the_shaft_leaves_the_helical_flanks_exact():
    made, _ = in_viewer("helical_shaft.py")
    gear = made["gear"]
    assert BRepCheck_Analyzer(made["part"].wrapped).IsValid()
    points = np.concatenate([face_points(face, 9) for face in exact_faces(made["part"].wrapped)[::3]])
    assert np.abs(cut_depth(gear.spec, points)).max() < 1e-9
    shaft = 2 * math.pi * (0.5 * made["JOURNAL"]) ** 2 * made["LENGTH"]
    assert made["part"].volume == pytest.approx(gear.section_area() * gear.face_width + shaft, rel=1e-9)


@pytest.mark.long
def test_the_hub_leaves_the_flanks_exact():
    made, _ = in_viewer("gear_with_hub.py")
    gear = read_design(EXAMPLE).gears["gear"]
    faces = exact_faces(made["part"].val().wrapped)
    found = measure_faces(faces, gear, along=9)
    assert found.flank < 1e-9
    assert found.fillet < 1e-8
    r, c = 0.5 * made["HUB_DIAMETER"], made["CHAMFER"]
    chamfer = math.pi * c * c * (r - c / 3)  # Pappus
    hub = math.pi * r * r * made["HUB_LENGTH"] - chamfer
    bore = math.pi * (0.5 * made["BORE"]) ** 2 * (gear.face_width + made["HUB_LENGTH"])
    assert made["part"].val().Volume() == pytest.approx(gear.section_area() * gear.face_width + hub - bore, rel=1e-9)


@pytest.mark.long
def test_the_bolt_holes_leave_the_ring_s_flanks_exact():
    made, _ = in_viewer("ring_with_bolts.py")
    gear = made["gear"]
    found = measure_faces(exact_faces(made["part"].wrapped)[::5], gear, along=9)
    assert found.flank < 1e-9
    assert found.fillet < 1e-8
    holes = made["HOLES"] * math.pi * (0.5 * made["HOLE_DIAMETER"]) ** 2 * gear.face_width
    assert made["part"].volume == pytest.approx(gear.section_area() * gear.face_width - holes, rel=1e-9)


def test_the_worn_volume_is_read_from_the_output_folder(tmp_path, capsys):
    (tmp_path / "cad").mkdir()
    (tmp_path / "gearwear-out").mkdir()
    copy = tmp_path / "cad" / "worn_volume.py"
    copy.write_text((CAD / "worn_volume.py").read_text())
    box = Solid.make_box(1.0, 2.0, 3.0)
    build123d.export_stl(box, str(tmp_path / "gearwear-out" / "worn_volume.stl"))
    made = runpy.run_path(str(copy))
    assert "3.00 mm along the axis" in capsys.readouterr().out
    size = made["worn"].bounding_box().size
    assert tuple(size) == pytest.approx((1.0, 2.0, 3.0), abs=1e-6)


def test_without_a_worn_volume_it_says_so_and_shows_a_dent_in_the_flank(tmp_path, capsys):
    copy = tmp_path / "worn_volume.py"
    copy.write_text((CAD / "worn_volume.py").read_text())
    made = runpy.run_path(str(copy))
    assert "is not there yet (python -m gearwear.compare writes it)" in capsys.readouterr().out
    depth, radius = made["DENT_DEPTH"], made["DENT_RADIUS"]
    assert 0.0 < made["worn"].volume < math.pi * depth**2 * (radius - depth / 3)  # of a cap on a plane; a flank is convex

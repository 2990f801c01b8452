"""STEP files as others read them: names, units, bytes, and both CAD packages in one process."""

from __future__ import annotations

import hashlib
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType

import build123d
import numpy as np
import pytest
from build123d import import_step

from gearwear.brep import step
from gearwear.brep.pair import gear_pair
from gearwear.brep.solid import gear_solid
from gearwear.brep.step import write_step
from gearwear.design import Design
from tests.brep.measuring import measure
from tests.brep.test_pair import ALLOWANCE, BETWEEN, PAPER, THINNED, design, least_clearance


@pytest.fixture(scope="module")
def paper() -> Design:
    return design(*PAPER)


@pytest.fixture(scope="module")
def files(paper, tmp_path_factory) -> dict[str, Path]:
    """The three models of the paper's pair."""
    folder = tmp_path_factory.mktemp("step")
    shapes = {part: gear_solid(gear) for part, gear in paper.gears.items()}
    shapes["pair"] = gear_pair(paper)
    for name, shape in shapes.items():
        write_step(shape, folder / f"{name}.step")
    return {name: folder / f"{name}.step" for name in shapes}


def products(path: Path) -> list[str]:
    return re.findall(r"= PRODUCT\('([^']*)'", path.read_text())


def test_products_have_the_names_of_the_parts(files):
    assert products(files["pinion"]) == ["pinion"]
    assert products(files["gear"]) == ["gear"]
    assert products(files["pair"]) == ["pair", "pinion", "gear"]


def test_lengths_are_millimetres(files):
    for path in files.values():
        assert "SI_UNIT(.MILLI.,.METRE.)" in path.read_text()


def test_the_same_bytes_on_every_run(files, paper, tmp_path):
    # The kernel numbers the parts of an assembly over the whole process: the second pair is the test.
    for name, shape in (("pair", gear_pair(paper)), ("pinion", gear_solid(paper.gears["pinion"]))):
        write_step(shape, tmp_path / f"{name}.step")
        first, second = (hashlib.sha256((place / f"{name}.step").read_bytes()) for place in (files["pair"].parent, tmp_path))
        assert first.hexdigest() == second.hexdigest()


def test_making_the_pair_leaves_the_solids_as_they_were(files, paper, tmp_path):
    solids = {part: gear_solid(gear) for part, gear in paper.gears.items()}
    gear_pair(paper, solids["pinion"], solids["gear"])
    for part, solid in solids.items():
        write_step(solid, tmp_path / f"{part}.step")
        assert (tmp_path / f"{part}.step").read_bytes() == files[part].read_bytes()


@pytest.mark.long
def test_the_pair_read_back_meshes(tmp_path):
    case = design(*THINNED)
    write_step(gear_pair(case), tmp_path / "pair.step")
    pair = import_step(tmp_path / "pair.step")
    assert pair.label == "pair"
    half = 0.5 * ALLOWANCE * np.cos(np.radians(20.0))
    assert -1e-9 <= least_clearance(case, pair) - half <= BETWEEN


@pytest.fixture(scope="module")
def cadquery() -> ModuleType:
    """Loaded where it is asked for: every process that collects this file would take a second for it."""
    return import_module("cadquery")


@pytest.mark.long
def test_cadquery_reads_every_file(cadquery, files, paper):
    for name, parts in (("pinion", ["pinion"]), ("gear", ["gear"]), ("pair", ["pinion", "gear"])):
        solids = cadquery.importers.importStep(str(files[name])).solids().vals()
        assert len(solids) == len(parts)
        for part, solid in zip(parts, solids, strict=True):
            assert solid.isValid()
            gear = paper.gears[part]
            assert solid.Volume() == pytest.approx(gear.section_area() * gear.face_width, rel=1e-9)


@pytest.mark.long
def test_flanks_and_roots_survive_cadquery(cadquery, files, paper):
    solid = cadquery.importers.importStep(str(files["pinion"])).val()
    found = measure(build123d.Solid(solid.wrapped), paper.gears["pinion"])
    assert found.flank < 1e-9
    assert found.fillet < 1e-8


@pytest.mark.long
def test_cadquery_reads_the_names_of_the_assembly(cadquery, files):
    assembly = cadquery.Assembly.importStep(str(files["pair"]))
    assert assembly.name == "pair"
    assert [child.name for child in assembly.children] == ["pinion", "gear"]


@pytest.mark.long
def test_build123d_and_cadquery_share_one_kernel(cadquery):
    # Unpinned they bring two OCP versions into one folder, and build123d no longer imports.
    box = build123d.Solid.make_box(1.0, 2.0, 3.0)
    assert cadquery.Solid(box.wrapped).Volume() == pytest.approx(6.0, rel=1e-12)
    assert build123d.Solid(cadquery.Solid.makeBox(1.0, 2.0, 3.0).wrapped).volume == pytest.approx(6.0, rel=1e-12)


def test_a_file_is_whole_or_not_there(paper, tmp_path, monkeypatch):
    target = tmp_path / "pinion.step"
    target.write_text("the model of yesterday")
    solid = gear_solid(paper.gears["pinion"])

    def full(*arguments, **options):
        Path(arguments[1]).write_text("ISO-10303-21;")
        raise RuntimeError("no space left")

    monkeypatch.setattr(step, "export_step", full)
    with pytest.raises(OSError, match="no space left"):
        write_step(solid, target)
    assert target.read_text() == "the model of yesterday"
    assert list(tmp_path.iterdir()) == [target]

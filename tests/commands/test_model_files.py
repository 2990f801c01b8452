"""``models/``: every file has its row, every design is what it says, and the STEP files are what the program makes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from build123d import import_step

from gearwear.commands.models import main
from gearwear.design import read_design
from tests.brep.measuring import measure

ROOT = Path(__file__).resolve().parents[2]
MODELS = ROOT / "models"


def files() -> set[str]:
    return {str(path.relative_to(MODELS)) for path in MODELS.rglob("*") if path.is_file() and path.name != "README.md"}


def test_every_file_has_a_row_and_every_row_a_file():
    rows = re.findall(r"^\| `([^`]+)` \|", (MODELS / "README.md").read_text(), flags=re.MULTILINE)
    assert set(rows) == files()
    assert len(rows) == len(set(rows))


def test_the_folder_stays_small():
    assert sum((MODELS / name).stat().st_size for name in files()) < 4_000_000


def test_the_bundled_example_is_the_paper_s_pair():
    bundled = ROOT / "gearwear" / "example" / "design.toml"
    assert (MODELS / "paper_pair.toml").read_bytes() == bundled.read_bytes()


def test_the_shifted_pair_has_the_published_dimensions():
    # cases.md R1, as printed there.
    design = read_design(MODELS / "shifted_pair.toml")
    for part, base, tip, root in (("pinion", 33.8289, 44.840, 32.100), ("gear", 67.6579, 79.400, 66.660)):
        gear = design.gears[part]
        found = 2 * np.array([gear.base_radius, gear.tip_radius, gear.root_radius])
        np.testing.assert_allclose(found, [base, tip, root], rtol=0, atol=5.1e-5)


@pytest.fixture(scope="module")
def remade(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("models")
    assert main([str(MODELS / "paper_pair.toml"), "--out", str(folder)]) == 0
    return folder


@pytest.mark.long
@pytest.mark.parametrize("name", ["pinion", "gear", "pair"])
def test_the_kept_models_are_what_the_program_makes(name, remade):
    kept, new = (import_step(folder / f"{name}.step") for folder in (MODELS / "paper_pair", remade))
    assert kept.label == new.label == name
    assert kept.volume == pytest.approx(new.volume, rel=1e-11)
    corners = [np.array(sorted((v.X, v.Y, v.Z) for v in shape.vertices())) for shape in (kept, new)]
    np.testing.assert_allclose(np.sort(corners[0], axis=0), np.sort(corners[1], axis=0), rtol=0, atol=1e-9)


@pytest.mark.parametrize("part", ["pinion", "gear"])
def test_the_kept_models_are_the_exact_gears(part):
    gear = read_design(MODELS / "paper_pair.toml").gears[part]
    shape = import_step(MODELS / "paper_pair" / f"{part}.step")
    found = measure(shape, gear, along=17)
    assert found.flank < 1e-9
    assert found.fillet < 1e-8
    assert shape.volume == pytest.approx(gear.section_area() * gear.face_width, rel=1e-9)


@pytest.mark.long
def test_the_kept_helical_pair_is_what_the_program_makes(tmp_path):
    design = read_design(MODELS / "helical_pair.toml")
    assert main([str(MODELS / "helical_pair.toml"), "--out", str(tmp_path)]) == 0
    kept, new = (import_step(path) for path in (MODELS / "helical_pair" / "pair.step", tmp_path / "pair.step"))
    assert [child.label for child in kept.children] == ["pinion", "gear"]
    corners = [np.array(sorted((v.X, v.Y, v.Z) for v in shape.vertices())) for shape in (kept, new)]
    np.testing.assert_allclose(np.sort(corners[0], axis=0), np.sort(corners[1], axis=0), rtol=0, atol=1e-9)
    for child in kept.children:
        gear = design.gears[child.label]
        assert child.is_valid
        assert child.volume == pytest.approx(gear.section_area() * gear.face_width, rel=1e-10)


@pytest.mark.long
@pytest.mark.parametrize("name", ["shifted_pair", "fine_gear", "double_helical", "ring_pair"])
def test_the_other_designs_become_models(name, tmp_path):
    design = read_design(MODELS / f"{name}.toml")
    assert main([str(MODELS / f"{name}.toml"), "--out", str(tmp_path)]) == 0
    for part in design.gears:
        assert import_step(tmp_path / f"{part}.step").is_valid

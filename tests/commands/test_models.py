"""``python -m gearwear.models``: files, exit status, one line for what is wrong."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from build123d import import_step

from gearwear.commands.models import main
from gearwear.design import read_design

EXAMPLE = Path(__file__).resolve().parents[2] / "gearwear" / "example" / "design.toml"


def test_the_bundled_example_is_the_paper_s_pair(tmp_path, capsys):
    assert main(["--out", str(tmp_path / "models")]) == 0
    assert sorted(path.name for path in (tmp_path / "models").iterdir()) == ["gear.step", "pair.step", "pinion.step"]
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    for line, what in zip(lines, ("pinion, 12 teeth", "gear, 24 teeth", "in mesh, centre distance 114.3 mm"), strict=True):
        assert what in line
        assert " kB " in line
    # reference.md G: section area 4408.899 mm² at rack tip radius 0.30 m.
    assert import_step(tmp_path / "models" / "pinion.step").volume / 15.0 == pytest.approx(4408.899, abs=5e-4)


def test_the_example_holds_the_values_of_the_contract():
    design = read_design(EXAMPLE)
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    assert (pinion.teeth, gear.teeth, design.centre_distance) == (12, 24, 114.3)
    assert design.pair is not None
    assert (design.pair.backlash_allowance, design.pair.baseline) == (0.2286, "zero_backlash")
    assert 2 * pinion.tip_radius == pytest.approx(88.9)
    assert 2 * gear.root_radius == pytest.approx(136.525)
    assert pinion.form_radius == pytest.approx(35.91383, abs=5e-6)  # reference.md B3, 0.30 m
    assert pinion.face_width == gear.face_width == 15.0


def test_a_design_of_one_gear_gives_that_gear(tmp_path, capsys):
    (tmp_path / "one.toml").write_text("[gear]\nteeth = 20\nmodule = 2\nface_width = 5\nbore_diameter = 10\n")
    assert main([str(tmp_path / "one.toml"), "--out", str(tmp_path / "out")]) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["gear.step"]
    assert "gear, 20 teeth, module 2 mm, 5 mm wide" in capsys.readouterr().out


def test_a_helical_gear_says_its_angle_and_hand(tmp_path, capsys):
    (tmp_path / "one.toml").write_text("[gear]\nteeth = 12\nmodule = 2\nface_width = 5\nhelix_angle = -17.5\n")
    assert main([str(tmp_path / "one.toml"), "--out", str(tmp_path / "out")]) == 0
    assert "gear, 12 teeth, normal module 2 mm, 17.5° left hand, 5 mm wide" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "[gear]\nteeth = 20\nmodule = 2\nface_width = 5\nend_chamfer = 2.4\n",
            "[gear] end_chamfer = 2.4 mm: leaves no tip",
        ),
        (
            "[gear]\nteeth = 20\nmodule = 2\nface_width = 5\nhelix_angle = 10\nend_rounding = 1.4\n",
            "[gear] end_rounding = 1.4 mm: leaves no tip",
        ),
        ("[gear\n", "is not TOML"),
    ],
)
def test_a_wrong_design_is_one_line_and_leaves_nothing(tmp_path, capsys, text, line):
    (tmp_path / "one.toml").write_text(text)
    assert main([str(tmp_path / "one.toml"), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert line in said.err
    assert "one.toml" in said.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("arguments", "line"), [(["--bogus"], "--bogus"), (["no-such.toml"], "no-such.toml: no such file")])
def test_a_wrong_argument_is_one_line(arguments, line, capsys):
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert line in said


def test_an_output_folder_that_is_a_file_is_refused(tmp_path, capsys):
    (tmp_path / "one.toml").write_text("[gear]\nteeth = 20\nmodule = 2\nface_width = 5\n")
    (tmp_path / "out").write_text("")
    assert main([str(tmp_path / "one.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "is a file; a folder is needed" in capsys.readouterr().err


def test_help_does_not_import_the_cad_kernel():
    code = (
        "import sys; from gearwear.commands.models import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'build123d', 'OCP', 'scipy', 'trimesh', 'matplotlib'} & set(sys.modules)\n"
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=EXAMPLE.parents[2])
    assert done.returncode == 0, done.stderr
    assert "usage:" in done.stdout

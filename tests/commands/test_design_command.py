"""``gearwear design``: what it prints is a design file, and the gear in it is the one that was measured."""

import subprocess
import sys
import tomllib
from importlib import resources
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.cli import main as cli
from gearwear.commands.design import _doubts, _tips, _warned, main
from gearwear.design import Gear, GearSpec, parse_design, read_design
from gearwear.identify.candidates import SurfaceLeft
from tests.synthetic import GearNumbers, Recipe, make_scan

EXAMPLE = Path(str(resources.files("gearwear") / "example"))


def printed(capsys, *arguments):
    assert main([str(one) for one in arguments]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return out


def gear_of(text):
    (gear,) = parse_design(tomllib.loads(text)).gears.values()
    return gear


def test_the_papers_pinion_from_two_diameters(capsys):
    text = printed(capsys, "--teeth", 12, "--tip-diameter", 88.9, "--root-diameter", 60.3, "--face-width", 15, "--part", "pinion")
    wanted = read_design(EXAMPLE / "design.toml").gears["pinion"]
    assert gear_of(text) == wanted
    assert "root diameter                               60.3000 mm      -25 µm" in text
    assert "assumed: no dimension given depends on it" in text


def test_what_is_left_of_a_dimension_has_no_minus_zero(capsys):
    assert "43.9999 mm       +0 µm" in printed(capsys, "--teeth", 20, "--tip-diameter", 43.9999, "--face-width", 10)


def test_dimensions_in_inches(capsys):
    text = printed(capsys, "--teeth", 12, "--tip-diameter", 3.5, "--face-width", 0.59055, "--units", "in")
    assert "diametral_pitch = 4 " in text
    assert gear_of(text).face_width == pytest.approx(15.0, abs=1e-4)
    assert "face_width = 14.986 " in printed(capsys, "--teeth", 12, "--module", 1, "--face-width", 0.59, "--units", "in")


def test_span_pins_and_what_is_known(capsys):
    text = printed(
        capsys,
        "--teeth",
        20,
        "--span",
        3,
        15.221,
        "--tip-diameter",
        44,
        "--module",
        2,
        "--pressure-angle",
        20,
        "--tolerance",
        0.01,
    )
    gear = gear_of(text)
    # 0.1 mm less than the standard 15.321 mm of the published example: thinner by that over cos α
    assert gear.spec.thinning == pytest.approx(0.1064, abs=0.005)
    text = printed(capsys, "--teeth", 12, "--over-pins", 10.9728, 91.172, "--tip-diameter", 88.9)
    assert gear_of(text).spec.normal_module == pytest.approx(6.35)


@pytest.mark.long
def test_the_bundled_scan_leads_to_its_design(capsys, tmp_path):
    file = tmp_path / "new" / "design.toml"
    said = printed(capsys, EXAMPLE / "scan.ply.gz", "--out", file, "--part", "pinion")
    assert said.splitlines() == ["12 teeth, diametral pitch 4 (module 6.35), 20°", str(file)]
    found, wanted = read_design(file).gears["pinion"], read_design(EXAMPLE / "design.toml").gears["pinion"]
    assert found.spec == wanted.spec
    # The scan has 18 µm of spray on all surfaces; it is said, and not made part of the gear.
    tip = next(line for line in file.read_text().splitlines() if line.startswith("#   tip  "))
    assert float(tip.split()[2]) == pytest.approx(18.0, abs=1.5)


def test_a_doubt_of_the_file_stands_on_the_terminal_too():
    """A helix angle of the wrong hand: flanks off by up to a millimetre."""
    seen = SimpleNamespace(notes=("a view is missing",), tip_radius=40.0, teeth=30, internal=False)
    said = _warned(_doubts(seen, SimpleNamespace(scatter=0.97)))
    assert said[0] == "! A view is missing." and said[1].startswith("! The flanks scatter by 970 µm about the best of these")
    assert max(map(len, said)) <= 80 and " ".join(said).endswith("helix angle is the right one.")
    assert (
        _warned(_doubts(SimpleNamespace(notes=(), tip_radius=40.0, teeth=30, internal=False), SimpleNamespace(scatter=0.01)))
        == []
    )


@pytest.mark.long
def test_an_unlikely_size_asks_after_the_unit(capsys, tmp_path):
    file = tmp_path / "inches.xyz"
    made = make_scan(Recipe(gear=GearNumbers(20, 2.0, 10.0), noise_um=5.0, jitter=1.0).of_size(25_000), 1)
    np.savetxt(file, made.points / 25.4, fmt="%.7f")
    assert "mm over the tips is unusual: --units" in printed(capsys, file)


def test_a_module_alone_is_a_gear_as_standard_proportions_have_it(capsys, tmp_path):
    file = tmp_path / "gear.toml"
    file.write_text(printed(capsys, "--teeth", 12, "--module", 6.35))
    gear = read_design(file).gears["gear"]
    assert gear.tip_radius == pytest.approx(0.5 * 6.35 * (12 + 2)) and gear.root_radius == pytest.approx(0.5 * 6.35 * (12 - 2.5))


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        ([], "--teeth is missing"),
        (["--teeth", "12"], "nothing tells the size"),
        (["--teeth", "x"], "invalid int value"),
        (["--teeth", "12", "--span", "2"], "expected 2 arguments"),
        (["--teeth", "12", "--span", "two", "29"], "--span two"),
        (["--teeth", "24", "--span", "inf", "49"], "span over inf teeth: a whole number from 1 to 23"),
        (
            ["--teeth", "12", "--tip-diameter", "60.3", "--root-diameter", "88.9"],
            "--root-diameter 88.9 is not below --tip-diameter 60.3",
        ),
        (["--teeth", "12", "--tip-diameter", "88.9", "--pressure-angle", "90"], "--pressure-angle 90"),
        (["--teeth", "12", "--tip-diameter", "88.9", "--module", "0"], "module 0 mm: from 0.001 to 1000 mm would be right"),
        (["--teeth", "12", "--tip-diameter", "88.9", "--module", "nan"], "module nan mm"),
        ([str(EXAMPLE / "scan.ply.gz"), "--module", "-2"], "module -2 mm"),
        ([str(EXAMPLE / "scan.ply.gz"), "--face-width", "0"], "face width 0 mm: above 0 would be right"),
        (
            [str(EXAMPLE / "scan.ply.gz"), "--bore", "-1", "--units", "in"],
            "bore -25.4 mm: a diameter, or 0 for none, would be right",
        ),
        (["nowhere.ply", "--tip-diameter", "0"], "--tip-diameter beside a scan"),
        (["nowhere.ply", "--tolerance", "0"], "--tolerance beside a scan"),
        (["nowhere.ply", "--span", "3", "20"], "--span beside a scan"),
        (["--teeth", "12", "--tip-diameter", "88.9", "--units", "ell"], "--units: invalid choice"),
        (["--teeth", "12", "--tip-diameter", "88.9", "--bore", "80"], "no gear of these dimensions can be cut: .*bore_diameter"),
        (["nowhere.ply"], "nowhere.ply: no such file"),
        (["nowhere.ply", "--tip-diameter", "3"], "--tip-diameter beside a scan"),
        pytest.param(
            [str(EXAMPLE / "scan.ply.gz"), "--teeth", "13"],
            "scan.ply.gz: teeth = 13: the scan shows 12 teeth",
            marks=pytest.mark.long,
        ),
        (["--teeth", "12", "--tip-diameter", "88.9", "--out", str(EXAMPLE)], "cannot be written"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(capsys, arguments, what):
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("gearwear: ")
    assert err.count("\n") == 1
    with pytest.raises(AssertionError, match=what):
        raise AssertionError(err)


def test_it_is_a_command_of_gearwear(capsys):
    assert cli(["design", "--teeth", "12", "--tip-diameter", "88.9"]) == 0
    assert "[gear]" in capsys.readouterr().out


def test_what_is_printed_can_be_piped_into_a_file(tmp_path):
    command = [sys.executable, "-m", "gearwear", "design", "--teeth", "20", "--tip-diameter", "44"]
    done = subprocess.run(command, capture_output=True, check=True)
    file = tmp_path / "piped.toml"
    file.write_bytes(done.stdout)
    assert read_design(file).gears["gear"].spec.normal_module == 2.0


@pytest.mark.parametrize("internal", [False, True])
def test_tips_that_lie_elsewhere_than_first_seen_are_doubted(internal):
    """A gear proposed with an addendum of 0.9 for one of 0.8: its tips lack 0.1 m of metal, inwards or outwards."""
    true, proposed = (
        Gear.from_spec(GearSpec("gear", 42, 2.5, 14.0, internal=internal, addendum=one, rim_diameter=130.0 * internal))
        for one in (0.8, 0.9)
    )
    left = [SurfaceLeft("flank", 0.0, 0.006, 999), SurfaceLeft("tip", -0.25, 0.006, 99)]
    said = " ".join(_tips(proposed, 2.0 * proposed.tip_radius, left))
    assert f"lie at diameter {2.0 * true.tip_radius:.3f} mm" in said and "addendum = 0.800" in said
    assert _tips(proposed, 2.0 * true.tip_radius, left) == []
    assert _tips(proposed, 2.0 * proposed.tip_radius, [SurfaceLeft("tip", -0.03, 0.006, 99)]) == []


@pytest.mark.long
def test_an_inch_gears_face_width_is_a_fraction_of_an_inch(capsys, tmp_path):
    """Where the scan bears it out: tests/identify/test_survey.py has the widths between."""
    gear = GearNumbers(25, 3.175, pressure_angle_deg=20.0, profile_shift=0.25, face_width=19.05, bore_diameter=25.4)
    recipe = Recipe(gear=gear, noise_um=5.0, jitter=1.0).of_size(20_000)
    np.savetxt(tmp_path / "scan.xyz", make_scan(recipe, 3).points / 25.4, fmt="%.8f")
    text = printed(capsys, tmp_path / "scan.xyz", "--units", "in")
    spec = gear_of(text).spec
    assert spec.face_width == 19.05
    assert "unusual" not in text
    (line,) = (line for line in text.splitlines() if line.startswith("face_width"))
    assert "# mm; 3/4 in; 19.0" in line and "mm seen" in line
    (line,) = (line for line in text.splitlines() if line.startswith("bore_diameter"))
    assert float(line.split()[2]) == pytest.approx(25.4, abs=0.02)
    assert len(line.split()[2]) <= len("25.40"), "no digit that is not known"

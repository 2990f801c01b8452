"""The wear law on traces of a measuring machine: known sliding wear written as traces and asked back, whatever their zero."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import gearwear as gw
from gearwear.commands.meshing import main
from gearwear.design import parse_design
from gearwear.design.files.traces import read_traces
from gearwear.wear_law.from_traces import study_traces

DESIGN = gw.read_design(gw.example())
LINE = 39.0932  # of the pair at 114.3 mm: T1 + T2, (r1 + r2) sin α
A = 8.0


@pytest.fixture(autouse=True)
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command without its pictures and with few positions, which take longer than all the rest: tests/commands/test_meshing_command.py looks at them."""
    monkeypatch.setattr("gearwear.meshing.study.POSITIONS", 4)
    for name in ("_write_pictures", "_write_loaded"):
        monkeypatch.setattr(f"gearwear.report.files.meshing.{name}", lambda *given: None)


def _write(file: Path, level: float, teeth: int = 5, noise: float = 0.2, a: float = A, unlike: float = 0.0) -> Path:
    """Left profiles of the pinion: A |K| missing, K = 1 − (T − L) / (2 L), at a zero of the machine's own; from tooth to tooth by a share more."""
    rng = np.random.default_rng(8)
    gear = DESIGN.gears["pinion"]
    rows = ["part,kind,tooth,flank,roll_mm,z_mm,deviation_um"]
    for tooth in range(1, teeth + 1):
        zero = level + rng.normal(0.0, 3.0)
        for foot in np.linspace(max(gear.form_roll, 1.0) + 0.2, gear.tip_roll, 120):
            depth = a * (1.0 + unlike * (tooth - 0.5 * (teeth + 1))) * abs(1.0 - (LINE - foot) / (2.0 * foot))
            rows.append(f"pinion,profile,{tooth},left,{foot - 1e-3 * depth:.5f},7.5,{zero - depth + rng.normal(0.0, noise):.4f}")
    file.write_text("\n".join(rows) + "\n")
    return file


@pytest.mark.parametrize("level", [0.0, -25.0])
def test_sliding_wear_comes_back_whatever_the_zero(tmp_path, level):
    part, profiles = read_traces(_write(tmp_path / "t.csv", level), DESIGN)
    study = study_traces(profiles, DESIGN.gears["gear"], DESIGN.centre_distance, gw.Side.LEFT)
    assert part == "pinion" and study.why_not == "" and len(study.teeth) == 5
    best = study.fits[0]
    assert best.sharing.value == "none"  # sharing by halves or thirds is told from it by far
    value, std = 1e3 * best.single_contact.sliding, 1e3 * best.single_contact.sliding_std
    assert value == pytest.approx(A, abs=4.0 * std) and std < 0.05 * A
    assert best.chi_square < 2.0 * best.degrees_of_freedom


def test_a_flank_nobody_measured_is_no_evidence(tmp_path):
    """The reader fills other teeth with the mean: they must not make the mean look better known."""
    widths = []
    for teeth in (3, 5):
        _, profiles = read_traces(_write(tmp_path / f"{teeth}.csv", 0.0, teeth), DESIGN)
        study = study_traces(profiles, DESIGN.gears["gear"], DESIGN.centre_distance, gw.Side.LEFT)
        assert len(study.teeth) == teeth
        widths.append(study.fits[0].single_contact.sliding_std)
    assert widths[0] > 0.5 * widths[1] > 0.0


def test_teeth_that_wore_unlike_make_the_amount_unsure(tmp_path):
    """80 to 120 % of A on five teeth, which scatter by √2.5 tenths: the mean of the law is known to √0.5 tenths of it, and was said to be to 0.6 %."""
    _, profiles = read_traces(_write(tmp_path / "t.csv", 0.0, unlike=0.1), DESIGN)
    fit = study_traces(profiles, DESIGN.gears["gear"], DESIGN.centre_distance, gw.Side.LEFT).fits[0]
    assert 1e3 * fit.coefficients[0] == pytest.approx(A, rel=0.02)
    assert 1e3 * fit.coefficient_stds[0] == pytest.approx(0.1 * A / 2**0.5, rel=0.02)
    assert 4.0 <= fit.freedom[0] < 5.0  # of five teeth, and what the scatter along each profile adds


def test_the_command_says_and_writes_it(tmp_path, capsys, monkeypatch):
    traces, read = _write(tmp_path / "traces.csv", 5.0), []

    def counted(path, design):
        read.append(path)
        return read_traces(path, design)

    for module in ("meshing.worn_gear", "design.files.traces"):
        monkeypatch.setattr(f"gearwear.{module}.read_traces", counted)
    assert (
        main(
            [str(gw.example()), "--wear", str(traces), "--drive", "left", "--cycle", "revolution", "--out", str(tmp_path / "out")]
        )
        == 0
    )
    assert "wear law" in capsys.readouterr().out.lower()
    law = json.loads((tmp_path / "out" / "meshing.json").read_text())["wear_law"]
    assert law["fitted"] and law["flank"] == "left" and law["teeth"] == [1, 2, 3, 4, 5]
    assert read == [traces]  # once: a file of a machine may be large


def _meshed(design: Path, text: str, tmp_path: Path, *more: str) -> dict:
    """What the command writes of traces."""
    (tmp_path / "t.csv").write_text(text)
    out = tmp_path / "out"
    asked = [str(design), "--wear", str(tmp_path / "t.csv"), *more, "--cycle", "revolution", "--quiet", "--out", str(out)]
    assert main(asked) == 0
    return json.loads((out / "meshing.json").read_text())


def _law(text: str, tmp_path: Path) -> dict:
    return _meshed(gw.example(), text, tmp_path, "--drive", "left")["wear_law"]


def test_flanks_nobody_measured_give_no_law(tmp_path):
    text = _write(tmp_path / "t.csv", 0.0).read_text()
    law = _law(text.replace(",left,", ",right,"), tmp_path)
    assert not law["fitted"] and law["why_not"] == "no profile of the left flanks was measured"


@pytest.mark.long
def test_teeth_keep_their_numbers_and_a_free_level_gives_no_share(tmp_path):
    text = _write(tmp_path / "t.csv", 0.0, teeth=2).read_text()
    law = _law(text.replace(",profile,1,", ",profile,7,").replace(",profile,2,", ",profile,4,"), tmp_path)
    assert law["teeth"] == [4, 7] and "fewer than 3 flanks" in law["note"]
    assert "share_of_mean_depth" not in law["terms"]["sliding"] and law["share_of_volume"] is None
    assert law["explained_share"]["value"] is None and "stand out" not in law["words"]


@pytest.mark.parametrize("helix_angle", [0.0, 20.0])
def test_sliding_wear_of_a_ring_comes_back(tmp_path, helix_angle):
    """A |K| along the normal: the transverse deviation is 1 / cos β_b of it, the foot ι cos β_b of it away; lengths of roll differ by the line."""
    both = {"normal_module": 2.5, "face_width": 14.0, "helix_angle": helix_angle}
    ring = {"teeth": 60, "addendum": 0.7, "internal": True, "fillet_radius": 0.5, "rim_diameter": 175.0}
    design = parse_design({"pinion": {"teeth": 18, "addendum": 0.8} | both, "gear": ring | both})
    gear, mate = design.gears["gear"], design.gears["pinion"]
    cosine = gear.base_helix_cosine
    line = (gear.reference_radius - mate.reference_radius) * np.sin(gear.transverse_pressure_angle)
    rng = np.random.default_rng(1)
    rows = ["part,kind,tooth,flank,roll_mm,z_mm,deviation_um"]
    for tooth in range(1, 6):
        for foot in np.linspace(gear.tip_roll + 0.05, gear.form_roll - 0.05, 150):
            other = foot - line
            depth = 8.0 * abs(1.0 - gear.teeth / mate.teeth * other / foot)
            deviation = 15.0 - depth / cosine + rng.normal(0.0, 0.1)
            rows.append(f"gear,profile,{tooth},left,{foot + 1e-3 * cosine * depth:.6f},7,{deviation:.4f}")
    (tmp_path / "t.csv").write_text("\n".join(rows) + "\n")
    _, profiles = read_traces(tmp_path / "t.csv", design)
    study = study_traces(profiles, mate, design.centre_distance, gw.Side.LEFT)
    assert study.why_not == ""
    value, std = study.fits[0].coefficients[0], np.sqrt(study.fits[0].covariance[0, 0])
    assert 1e3 * value == pytest.approx(8.0, abs=4.0 * 1e3 * std) and 1e3 * std < 0.4


RING = """
[pinion]
teeth = 18
module = 2.5
face_width = 14.0
addendum = 0.8

[gear]
teeth = 54
module = 2.5
face_width = 14.0
addendum = 0.7
internal = true
fillet_radius = 0.5
rim_diameter = 160.0

[pair]
"""


@pytest.mark.long
def test_the_command_fits_the_flanks_of_a_ring_that_face_the_pinions(tmp_path):
    """Left flanks of the pinion carry on right ones of its ring: 20 |K| µm off these, with K = 1 − z2 / z1 (L − T) / L of the ring's flank."""
    (tmp_path / "ring.toml").write_text(RING)
    design = gw.read_design(tmp_path / "ring.toml")
    gear, mate = design.gears["gear"], design.gears["pinion"]
    line = (gear.reference_radius - mate.reference_radius) * np.sin(gear.transverse_pressure_angle)
    rng = np.random.default_rng(2)
    rows = ["part,kind,tooth,flank,roll_mm,z_mm,deviation_um"]
    for tooth in range(1, 9):
        for side, amount in (("left", 0.0), ("right", 20.0)):
            for foot in np.linspace(gear.tip_roll + 0.05, gear.form_roll - 0.05, 40):
                depth = amount * abs(1.0 - 3.0 * (foot - line) / foot)
                rows.append(f"gear,profile,{tooth},{side},{foot + 1e-3 * depth:.6f},7,{rng.normal(0.0, 0.1) - depth:.4f}")
    told = _meshed(tmp_path / "ring.toml", "\n".join(rows) + "\n", tmp_path)
    law = told["wear_law"]
    assert told["contact"]["drive_flank"] == "left" and law["flank"] == "right" and law["fitted"]
    found = law["terms"]["sliding"]["coefficient_um"]
    assert found["value"] == pytest.approx(20.0, abs=4.0 * found["std"]) and found["std"] < 0.5


def test_traces_of_no_shape_say_that_there_is_nothing_to_explain(tmp_path):
    _, profiles = read_traces(_write(tmp_path / "t.csv", 0.0, a=0.0), DESIGN)
    study = study_traces(profiles, DESIGN.gears["gear"], DESIGN.centre_distance, gw.Side.LEFT)
    assert study.fits[0].words.startswith("how the measured depth varies along the profile does not stand out from its errors")

"""``gearwear inspect``: the table, the files and the numbers on gears whose deviations were put in."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure

from tests.commands.doors import ONE, PAIR, Said, run, scan_file, strict_json
from tests.diagnose.plain import plain_effects
from tests.synthetic import Effect, Recipe, make_scan

FILES = {
    "inspection.json", "inspection.csv", "inspection_flanks.csv", "inspection_teeth.csv", "inspection_traces.csv", "inspection.pdf",
    "chart_profile.png", "chart_helix.png", "chart_profile_middle.png", "chart_helix_middle.png", "chart_surfaces.png", "chart_pitch.png",
    "chart_topography.png",
}  # fmt: skip
SLOPE, TAPER, THICKNESS = 40.0, 30.0, -60.0
MADE = Recipe(
    jitter=1.0,
    noise_um=3.0,
    effects=(
        Effect("profile_slope", {"left_um": SLOPE, "right_um": -SLOPE}),
        Effect("taper", {"taper_um": TAPER}),
        Effect("tooth_thickness", {"thickness_um": THICKNESS}),
        Effect("coating", {"thickness_um": 20.0}),
    ),
).of_size(40_000)


@contextmanager
def one_page_drawn() -> Iterator[None]:
    """Pictures come out as they are, and of the PDF the first page: the others hold what the pictures show, and are counted."""
    whole, pages = Figure.draw, list[Figure]()

    def draw(figure: Figure, renderer: Any) -> None:
        if not isinstance(renderer, RendererAgg):
            pages.append(figure)
        if len(pages) <= 1 or isinstance(renderer, RendererAgg):
            whole(figure, renderer)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "draw", draw)
        yield


@pytest.fixture(scope="module")
def inspected(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Said, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("inspect")
    files, _ = scan_file(folder, "made", MADE, 8)
    with plain_effects(), one_page_drawn():
        said = run("inspect", PAIR, *files, "--class", "9", "--topography", "1,5", "--out", folder / "out")
    return folder / "out", said, strict_json(folder / "out" / "inspection.json")


def test_files_and_one_screen(inspected):
    out, said, record = inspected
    assert (said.status, said.err) == (0, "")
    assert {path.name for path in out.iterdir()} == FILES == set(record["files"])
    lines = said.out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    table = [line for line in lines if line[:3] in ("f_H", "f_f", "F_α", "F_β", "f_p", "f_u", "F_p", "F_r")]
    assert len(table) == 11
    assert "class 9 required" in said.out and "ISO 1328-1:2013" in said.out


def test_pins_are_named_as_exactly_as_their_dimension(inspected):
    """A pin of 11.0 mm in place of 10.973 (1.728 modules) would measure 0.09 mm more."""
    said = inspected[1].out.replace("\n", " ")
    assert "over pins of 10.973 " in said and "design 91.172" in said


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the charts, which take most of the time: for what stands in the numbers and words."""
    monkeypatch.setattr("gearwear.report.files.inspection.write_charts", lambda *given: [])


@pytest.mark.long
@pytest.mark.usefixtures("undrawn")
def test_a_pattern_without_a_name_is_left_in_and_said_so(tmp_path):
    made = replace(MADE, effects=(Effect("wave_growing", {"order": 5, "amplitude_um": 15.0, "phase_deg": 0.0}),)).of_size(30_000)
    files, _ = scan_file(tmp_path, "waves", made, 9)
    said = run("inspect", PAIR, *files, "--out", tmp_path / "out")
    (note,) = (note for note in strict_json(tmp_path / "out" / "inspection.json")["notes"] if "without a name" in note)
    assert note.startswith("left in is a pattern without a name: 5 waves round the gear")
    assert "Left in is a pattern without a name" in said.out


def test_what_the_maker_left_is_measured_and_the_coat_is_not(inspected):
    _, _, record = inspected
    assert [effect["name"] for effect in record["taken_out"]] == ["coating"]
    assert [std > 0.0 for std in record["registration"]["translation_std_um"]] == [True] * 3
    mean = record["inspection"]["profile"]["mean"]
    # The slope is stated from form circle to tip; the evaluation range of ISO 1328-1 is a part of that.
    roll = record["inspection"]["profile"]["range_roll_mm"]
    share = (roll[1] - roll[0]) / (26.343853 - 2.82832)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        assert mean[side]["slope_um"] == pytest.approx(sign * SLOPE * share, abs=2.0)
    helix = record["inspection"]["helix"]
    share = (helix["range_z_mm"][1] - helix["range_z_mm"][0]) / 15.0
    for side, sign in (("left", 1.0), ("right", -1.0)):  # a helix slope has one sign on both sides, a taper two
        assert helix["mean"][side]["slope_um"] == pytest.approx(sign * TAPER * share, abs=1.0)
    teeth = [row["thickness_mm"]["value"] for row in record["inspection"]["dimensions"]["tooth_thickness"]["teeth"]]
    assert np.mean(teeth) - 9.974557 == pytest.approx(1e-3 * THICKNESS, abs=0.004)


def test_the_csv_files_hold_the_same(inspected):
    out, _, record = inspected
    with (out / "inspection.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = record["inspection"]
    for row, finding in zip(rows, [*found["findings"], *found["radial"]["findings"]], strict=True):
        assert (row["symbol"], row["verdict"]) == (finding["symbol"], finding["verdict"])
        assert row["standard"] == (found["radial"] if "″" in row["symbol"] else found)["standard"]
        assert float(row["value_um"]) == pytest.approx(finding["value_um"], abs=0.006)
    with (out / "inspection_flanks.csv").open(encoding="utf-8") as file:
        flanks = list(csv.DictReader(file))
    assert [(row["tooth"], row["flank"]) for row in flanks] == [(str(k), s) for k in range(1, 13) for s in ("left", "right")]
    listed = [row["slope_um"]["value"] for row in record["inspection"]["profile"]["flanks"]]
    np.testing.assert_allclose([float(row["profile_slope_um"]) for row in flanks], listed, atol=0.006)


def test_the_charts_are_pictures_of_a_page(inspected):
    out, _, _ = inspected
    import matplotlib.image

    for name in FILES:
        if name.endswith(".png"):
            picture = matplotlib.image.imread(out / name)
            assert picture.shape[1] > 1500 and picture[..., :3].std() > 0.02
    pdf = (out / "inspection.pdf").read_bytes()
    assert pdf.startswith(b"%PDF") and pdf.count(b"/Type /Page ") == 6 + 2, (
        "profile and helix twice, surfaces, pitch, two topographies"
    )
    assert b"CreationDate" not in pdf


@pytest.mark.usefixtures("undrawn")
def test_the_other_edition_and_no_loop(tmp_path):
    files, _ = scan_file(tmp_path, "made", replace(MADE, effects=MADE.effects[3:]).of_size(20_000), 8)
    said = run("inspect", PAIR, *files, "--edition", "1995", "--no-loop", "--out", tmp_path / "out", "--quiet")
    assert said == Said(0, "", "")
    record = strict_json(tmp_path / "out" / "inspection.json")
    assert record["taken_out"] is None
    assert record["inspection"]["standard"] == "ISO 1328-1:1995"
    teeth = [row["thickness_mm"]["value"] for row in record["inspection"]["dimensions"]["tooth_thickness"]["teeth"]]
    # The coat of 20 µm stays on both flanks: 2 t / cos α of arc.
    assert np.mean(teeth) - 9.974557 == pytest.approx(0.040 / np.cos(np.radians(20.0)), abs=0.003)


@pytest.mark.usefixtures("undrawn")
def test_a_k_band_and_gauges_of_ones_own(tmp_path, thin):
    band = "[profile]\nroll_angle_deg = [8, 40]\nlower_um = [-5, -5]\nupper_um = [5, 5]\n"  # 40 µm of slope do not fit
    (tmp_path / "k.toml").write_text(band, encoding="utf-8")
    options = [
        "--k-band",
        tmp_path / "k.toml",
        "--control-diameter",
        "73",
        "--span-teeth",
        "3",
        "--pin-diameter",
        "11.5",
        "--no-loop",
    ]
    said = run("inspect", PAIR, *thin, *options, "--out", tmp_path / "out")
    assert (said.status, said.err) == (0, "")
    lines = said.out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert "profile left 12 outside; profile right 12 outside" in said.out
    record = strict_json(tmp_path / "out" / "inspection.json")["inspection"]
    assert record["k_bands"] == str(tmp_path / "k.toml")
    assert record["profile"]["k_bands"]["left"]["roll_mm"] == pytest.approx(np.radians([8.0, 40.0]) * 35.802289, abs=1e-3)
    assert record["helix"]["k_bands"] is None
    assert record["profile"]["range_roll_mm"][0] == pytest.approx(np.sqrt(36.5**2 - 35.802289**2), abs=1e-3)
    assert record["dimensions"]["span"]["teeth"] == 3
    assert record["dimensions"]["over_pins"]["diameter_mm"] == 11.5
    with (tmp_path / "out" / "inspection_flanks.csv").open(encoding="utf-8") as file:
        assert {row["profile_k_verdict"] for row in csv.DictReader(file)} == {"outside"}


@pytest.mark.usefixtures("undrawn")
def test_bands_of_a_class_are_over_the_ranges_that_were_asked_for(tmp_path, thin):
    ranges = ["--profile-roll-mm", "8,20", "--helix-z-mm", "5,12"]
    said = run("inspect", PAIR, *thin, "--no-loop", "--class", 7, "--k-band", "class", *ranges, "--out", tmp_path / "out")
    assert (said.status, said.err) == (0, "")
    record = strict_json(tmp_path / "out" / "inspection.json")["inspection"]
    assert record["profile"]["range_roll_mm"] == record["profile"]["k_bands"]["left"]["roll_mm"] == [8.0, 20.0]
    assert record["helix"]["range_z_mm"] == record["helix"]["k_bands"]["right"]["z_mm"] == [5.0, 12.0]


@pytest.fixture(scope="module")
def thin(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return scan_file(tmp_path_factory.mktemp("thin"), "made", MADE.of_size(8_000), 8)[0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--k-band", "class"], "--k-band class needs the class, as --class N"),
        (["--k-band", "none.toml"], "none.toml: no such file"),
        (["--control-diameter", "70"], "--control-diameter 70: the involute goes from 71.828 to 88.900 mm"),
        (["--span-teeth", "5"], "1 to 3 teeth can be spanned"),
        (["--pin-diameter", "3"], "falls through to the root"),
        (["--class", "12"], "has classes 1 to 11"),
        (["--topography", "13"], "teeth from 1 to 12"),
    ],
)
def test_refuses_what_cannot_be_met_and_writes_nothing(tmp_path, thin, options, words):
    said = run("inspect", PAIR, *thin, *options, "--no-loop", "--out", tmp_path / "out")
    assert said.status == 2 and words in said.err and len(said.err.splitlines()) == 1
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


@pytest.mark.long
def test_a_planar_section_has_no_helix(tmp_path):
    scan = make_scan(Recipe(slices=5, points_per_tooth=1500, end_points=0, ends="none", pose="none"), 4)
    one = scan.points[np.isclose(scan.truth.labels.z, np.median(scan.truth.labels.z))]
    np.savetxt(tmp_path / "section.xyz", one[:, :2], fmt="%.6f")
    (tmp_path / "one.toml").write_text(ONE)
    said = run("inspect", tmp_path / "one.toml", tmp_path / "section.xyz", "--out", tmp_path / "out")
    assert (said.status, said.err) == (0, "")
    assert "not seen" in said.out
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES - {
        "chart_helix.png", "chart_topography.png", "chart_profile_middle.png", "chart_helix_middle.png", "chart_surfaces.png",
    }  # fmt: skip


@pytest.mark.long
@pytest.mark.usefixtures("undrawn")
def test_of_the_wrong_pressure_angle_the_first_doubt_says_so(tmp_path):
    files, _ = scan_file(tmp_path, "new", Recipe(jitter=1.0).of_size(15_000), 4)
    (tmp_path / "design.toml").write_text(ONE + "pressure_angle = 22.5\n", encoding="utf-8")
    said = run("inspect", tmp_path / "design.toml", *files, "--no-loop", "--out", tmp_path / "out")
    first = next(line for line in said.out.splitlines() if line.startswith("!"))
    assert first.startswith("! The flanks are those of another gear or out of scale")
    assert any("check module and pressure angle" in note for note in strict_json(tmp_path / "out" / "inspection.json")["notes"])

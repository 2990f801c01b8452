"""The main job from end to end: every file and key of the contract, and numbers that are known for other reasons."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwear.comparison.stations import compare
from gearwear.design import read_design
from gearwear.design.files.profiles import read_profiles
from gearwear.design.profiles import nominal_profiles
from gearwear.meshing.study import study_meshing
from gearwear.report.files.solids import write_stl
from gearwear.report.records.comparison import document
from gearwear.wear.solid import gear_triangles
from tests.commands.doors import ALONE, EXAMPLE, ONE, PAIR, ROOT, Said, run, scan_file, strict_json, thinner_example
from tests.synthetic import (
    WHEEL,
    AbrasiveWear,
    Effect,
    Patch,
    Recipe,
    Rigid,
    Texture,
    Views,
    make_scan,
)

TRUTH = json.loads((EXAMPLE / "truth.json").read_text(encoding="utf-8"))

# The contract, written out by hand: [] is each item of a list, * each value of a table, | alternatives.
VALUE = ("value", "std")
KEYS = """
schema
design: teeth module_mm pressure_angle_deg reference_radius_mm base_radius_mm tip_radius_mm root_radius_mm form_radius_mm
design: tooth_thickness_mm undercut
scan: file|files points used rejected other kind coverage
scan.coverage: flank fillet root tip end_low end_high
registration: rotation translation_mm converged views
closed_loop: noise_um before after effects unexplained
closed_loop.before: rms_um heldout_rms_um
closed_loop.after: rms_um heldout_rms_um
closed_loop.effects[]: name kind parameters alternatives evidence
closed_loop.effects[]: rms_before_um rms_after_um heldout_rms_before_um heldout_rms_after_um
closed_loop.effects[].parameters.*: value std unit
closed_loop.effects[].evidence: statistic effective_sample_size p_value
closed_loop.unexplained: found rms_um pattern
wear: volume_mm3 before_loop regions laws
wear.volume_mm3: value std
wear.before_loop: volume_mm3
wear.regions[]: tooth flank volume_mm3 max_depth_um mean_depth_um area_mm2 centroid_mm patches
wear.regions[].volume_mm3: value std
wear.laws[]: name parameters rms_before_um rms_after_um
thickness[]: tooth nominal_mm mean_mm min_mm loss_max_mm at_z_mm
meshing: paper design worn
meshing.paper: thickness_loss_mm backlash_mm centre_distance_change_mm centre_distance_mm pressure_angle_deg
meshing.paper: pitch_radius_pinion_mm pitch_radius_gear_mm contact_length_design_mm contact_length_worn_mm
meshing.design: centre_distance_mm working_pressure_angle_deg backlash path_of_contact_mm contact_ratio transmission_error_um
meshing.worn: centre_distance_mm working_pressure_angle_deg backlash path_of_contact_mm contact_ratio transmission_error_um
meshing.design.backlash: circumferential_mm normal_mm radial_mm angular_pinion_deg angular_gear_deg
meshing.worn.backlash: circumferential_mm normal_mm radial_mm angular_pinion_deg angular_gear_deg
meshing.worn.backlash: circumferential_mm_min normal_mm_min radial_mm_min angular_pinion_deg_min angular_gear_deg_min
files
"""
FILES = {
    "report.json",
    "report.html",
    "worn_volume.stl",
    "worn_volume.3mf",
    "worn_gear.stl",
    "worn_profiles.npz",
    "thickness.csv",
}
MORE = {"sections.csv", "sections.dxf", "points.ply", "points.npz"}
THINNED = 6
ASKED = (
    "--sections",
    "7.5",
    "--write",
    "ply,npz",
    "--cycles-run",
    "1e6",
    "--cycles",
    "3e6",
    "--limit-depth-um",
    "90",
)


def at(report: Any, path: str) -> Iterator[Any]:
    """Everything at a path of the contract."""
    if not path:
        yield report
        return
    head, _, rest = path.partition(".")
    name = head.removesuffix("[]")
    for value in report.values() if name == "*" else [report[name]]:
        for item in value if head.endswith("[]") else [value]:
            yield from at(item, rest)


def missing(report: Any, keys: str = KEYS) -> list[str]:
    """Keys of the contract that a report does not have; a list that should be looked into must hold something."""
    lost = []
    for line in keys.split("\n"):
        path, colon, names = line.partition(": ")
        for wanted in (names if colon else path).split():
            found = list(at(report, path if colon else ""))
            if not found or not all(any(name in one for name in wanted.split("|")) for one in found):
                lost.append(f"{path if colon else ''}: {wanted}")
    return lost


@pytest.fixture(scope="session")
def example(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Said, dict[str, Any]]:
    """A sixth of the bundled example's points with all that can be asked for, but for what is drawn; README has the whole of it, and its blocks are run."""
    folder = tmp_path_factory.mktemp("example")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("matplotlib.figure.Figure.draw", lambda figure, renderer: None)
        said = run("compare", PAIR, thinner_example(folder, THINNED), "--out", folder / "out", *ASKED)
    return folder / "out", said, strict_json(folder / "out" / "report.json")


class TestExample:
    def test_every_file_is_written_and_named(self, example):
        out, said, report = example
        assert (said.status, said.err) == (0, "")
        assert set(report["files"]) == {path.name for path in out.iterdir()} == FILES | MORE
        assert all(name in said.out for name in ("report.html", "worn_volume.stl"))
        assert len(said.out.splitlines()) <= 24

    def test_every_key_of_the_contract_is_there(self, example):
        assert missing(example[2]) == []

    def test_a_lost_key_would_be_seen(self, example):
        report = json.loads(json.dumps(example[2]))
        del report["closed_loop"]["effects"][1]["evidence"]["p_value"]
        del report["wear"]["regions"][-1]["volume_mm3"]["std"]
        assert missing(report) == ["closed_loop.effects[].evidence: p_value", "wear.regions[].volume_mm3: std"]

    def test_volume_is_the_truth(self, example):
        found = example[2]["wear"]["volume_mm3"]
        assert abs(found["value"] - TRUTH["volume_mm3"]) < min(3.0 * found["std"], 0.03 * TRUTH["volume_mm3"])

    def test_tooth_2_left_is_the_deepest_and_the_thinnest(self, example):
        wear, thickness = example[2]["wear"], example[2]["thickness"]
        worst = max(TRUTH["flanks"], key=lambda flank: flank["max_depth_um"])
        first = wear["regions"][0]
        assert (first["tooth"], first["flank"]) == (worst["tooth"] + 1, "left") == (2, "left")
        assert first["volume_mm3"]["value"] == pytest.approx(worst["volume_mm3"], rel=0.03)
        assert first["max_depth_um"] == max(region["max_depth_um"] for region in wear["regions"])
        assert min(thickness, key=lambda row: row["min_mm"])["tooth"] == 2
        assert {(r["tooth"], r["flank"]) for r in wear["regions"]} == {(k, "left") for k in range(1, 13)}

    def test_effects_are_what_was_put_in(self, example):
        effects = {effect["name"]: effect["parameters"] for effect in example[2]["closed_loop"]["effects"]}
        assert set(effects) == {effect["name"] for effect in TRUTH["effects"]} == {"coating", "turntable_angle"}
        for effect in TRUTH["effects"]:
            for name, value in effect["parameters"].items():
                found = effects[effect["name"]][name]
                off = (
                    abs((found["value"] - value + 180.0) % 360.0 - 180.0) if name == "phase_deg" else abs(found["value"] - value)
                )
                assert off <= 3.0 * found["std"], name

    def test_the_loop_closes_on_the_noise(self, example):
        loop = example[2]["closed_loop"]
        assert loop["noise_um"] == pytest.approx(1e3 * TRUTH["noise_mm"], rel=0.05)
        assert loop["after"]["rms_um"] == pytest.approx(np.hypot(10.0, TRUTH["texture"]["sd_um"]), rel=0.05)
        steps = [loop["before"]["rms_um"], *(effect["rms_after_um"] for effect in loop["effects"])]
        assert steps == sorted(steps, reverse=True)
        assert [effect["rms_before_um"] for effect in loop["effects"]] == steps[:-1]
        assert steps[-1] == loop["after"]["rms_um"]

    def test_without_the_loop_the_coat_would_hide_wear(self, example):
        wear = example[2]["wear"]
        assert wear["before_loop"]["volume_mm3"]["value"] < 0.7 * wear["volume_mm3"]["value"]

    def test_the_solid_holds_what_the_integral_says(self, example):
        out, _, report = example
        import trimesh

        read = trimesh.load(out / "worn_volume.stl")
        assert read.is_watertight  # with its vertices merged: no two pieces touch along an edge
        volume = read.volume
        assert volume == pytest.approx(report["wear"]["solid"]["volume_mm3"], rel=1e-5)
        # A thin scan's holes are filled by means: docs/limits.md.
        assert volume == pytest.approx(report["wear"]["volume_mm3"]["value"], rel=0.03)

    def test_the_gear_in_contact_is_the_gear_and_not_its_noise(self, example):
        """Truth, by contact of the part without noise (tests/meshing/test_contact_of_scans.py): 13.07 µm and 13.09 µm."""
        worn = example[2]["meshing"]["worn"]
        assert worn["transmission_error_um"] == pytest.approx(13.07, abs=3.0 * worn["transmission_error_um_std"])
        assert worn["backlash"]["normal_mm"] == pytest.approx(0.01309, abs=3.0 * worn["backlash"]["normal_mm_std"])
        assert 0.2 < worn["transmission_error_um_std"] < 2.0

    @pytest.mark.long
    @pytest.mark.usefixtures("blank_figures")
    def test_worn_profiles_are_the_gear_in_mesh(self, example, tmp_path):
        out, _, report = example
        part, profiles = read_profiles(out, read_design(PAIR))
        assert part == "pinion"
        assert np.unravel_index(profiles.loss.argmax(), profiles.loss.shape)[:2] == (1, 0)
        assert run("meshing", PAIR, "--wear", out, "--out", tmp_path, "--quiet").status == 0
        study = strict_json(tmp_path / "meshing.json")
        assert study["contact"]["transmission_error_um"] == pytest.approx(
            report["meshing"]["worn"]["transmission_error_um"], rel=1e-9
        )
        assert study["contact"]["backlash"]["greatest"]["normal_mm"] == pytest.approx(
            report["meshing"]["worn"]["backlash"]["normal_mm"], rel=1e-9
        )
        assert study["contact"]["contact_ratio"] == pytest.approx(report["meshing"]["worn"]["contact_ratio"], rel=1e-9)
        # Of its thickness it has lost what the report says, without the bias of having looked for the thinnest of many sections.
        ours, theirs = study["take_up"], report["meshing"]["take_up"]
        numbers = [key for key, value in theirs.items() if isinstance(value, float)]
        assert len(numbers) > 8
        assert {key: ours[key] for key in numbers} == pytest.approx({key: theirs[key] for key in numbers}, rel=1e-9, abs=1e-9)
        told = {key: report["most_lost"][key] for key in ("tooth", "at_z_mm")} | {
            "thickness_loss_mm": report["most_lost"]["value_mm"]
        }
        assert {key: study["worn"][key] for key in told} == pytest.approx(told, rel=1e-9)

    def test_the_wear_law_is_the_one_put_in(self, example):
        law = example[2]["meshing"]["wear_law"]
        put_in = next(wear for wear in TRUTH["wear"] if wear["shape"] == "SlidingWear")
        pinion, wheel = (read_design(PAIR).gears[part] for part in ("pinion", "gear"))
        line = np.sqrt(114.3**2 - (pinion.base_radius + wheel.base_radius) ** 2)
        sliding = abs(1.0 - (line - pinion.form_roll) / (2.0 * pinion.form_roll))  # at the form circle, where the depth is stated
        assert (law["fitted"], law["flank"], law["left_out"]) == (True, "left", [2])
        factors = np.delete(put_in["factors"], 1)
        found = law["terms"]["sliding"]["coefficient_um"]
        assert abs(found["value"] - put_in["depth_um"] * factors.mean() / sliding) < 3.0 * found["std"]
        assert found["std"] < 0.1 * found["value"]
        assert law["load_sharing"] == "none"

    def test_the_forecast_goes_on_from_it(self, example):
        law = example[2]["meshing"]["wear_law"]
        now, later = law["forecast"]["at"]
        assert (now["cycles"], later["cycles"]) == (1e6, 3e6)
        for key in ("greatest_depth_um", "thickness_loss_mm", "backlash_increase_mm"):
            assert later[key]["low"] <= later[key]["value"] <= later[key]["high"]
            # All of it is sliding, so three times the cycles are three times the wear, within the band.
            assert later[key]["low"] < 3.0 * now[key]["value"] < later[key]["high"]
        (left,) = law["forecast"]["cycles_left"]
        assert left["low"] < left["value"] < left["high"]
        grown = (90.0 - now["greatest_depth_um"]["value"]) / (
            later["greatest_depth_um"]["value"] - now["greatest_depth_um"]["value"]
        )
        assert left["value"] == pytest.approx(2e6 * grown, rel=1e-6)

    @pytest.mark.long
    def test_the_same_bytes_in_a_process_of_its_own(self, tmp_path):
        out = tmp_path / "here"
        run("compare", PAIR, thinner_example(tmp_path, THINNED), "--out", out, *ASKED)
        command = [
            sys.executable,
            "-m",
            "gearwear.compare",
            str(PAIR),
            str(thinner_example(tmp_path, THINNED)),
            "--out",
            str(tmp_path / "out"),
            *ASKED,
        ]
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "7", "COLUMNS": "80"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        assert {path.name for path in (tmp_path / "out").iterdir()} == FILES | MORE
        for name in (
            "report.json",
            "report.html",
            "worn_volume.stl",
            "worn_gear.stl",
            "thickness.csv",
            "sections.csv",
            "points.ply",
        ):
            assert (tmp_path / "out" / name).read_bytes() == (out / name).read_bytes(), name


PATCH = Patch(1, 1, 400.0, (36.6, 43.4), (1.0, 12.0))
THIN = Recipe(jitter=1.0, wear=(PATCH,)).of_size(20_000)


def regions(results: Any) -> set[tuple[int, int]]:
    return {(region.tooth, region.side) for region in results.wear.regions}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scans")


@pytest.mark.long
def test_without_the_loop_nothing_is_sought_and_that_is_said(folder, tmp_path):
    files, scan = scan_file(folder, "plain", THIN)
    said = run("compare", PAIR, *files, "--no-loop", "--no-page", "--out", tmp_path)
    assert (said.status, said.err) == (0, "")
    report = strict_json(tmp_path / "report.json")
    assert missing(report, "\n".join(line for line in KEYS.split("\n") if "effects[]" not in line and "laws[]" not in line)) == []
    assert report["closed_loop"]["effects"] == []
    assert "No effect of measurement or manufacture was looked for" in said.out
    assert report["wear"]["volume_mm3"]["value"] == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    plain, volume = report["wear"]["before_loop"]["volume_mm3"], report["wear"]["volume_mm3"]
    assert plain == {name: volume[name] for name in plain}
    law = report["meshing"]["wear_law"]
    assert not law["fitted"] and "1 tooth" in law["why_not"]


TEXTURED = replace(THIN, texture=Texture(5.0, 2.0), texture_seed=11).of_size(40_000)
COAT = Effect("coating", {"thickness_um": 25.0})


@pytest.mark.long
@pytest.mark.parametrize(("coat_before", "coat_after"), [(False, True), (True, True)])
def test_against_a_scan_before_wear(folder, coat_before, coat_after):
    """What both scans share cancels, and a coat in one of them only is no wear. Left in, it hides a third of the volume; with the levels that flanks then
    stand at in its ±, what is told holds the truth all the same."""
    after, scan = scan_file(folder, "after", replace(TEXTURED, effects=(COAT,) * coat_after), 2)
    before, _ = scan_file(folder, "before", replace(TEXTURED, wear=(), effects=(COAT,) * coat_before), 3)
    results = compare(ALONE, after, before=before, inspection=False)
    assert regions(results) == {(1, 1)}
    assert results.wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    assert results.before_files == (str(before[0]),)
    (change,) = (change for change in results.changes if change.name == "worn_volume_mm3")
    hidden = change.after - change.before
    shared = 0.5 * results.wear.volume_std  # how the scans lie on one another is known no better
    assert abs(hidden) < shared if coat_before else 0.25 * change.after < hidden < 2.0 * change.std
    assert not change.matters and change.causes == ()
    worst = max(results.wear.thickness.teeth(), key=lambda tooth: tooth.greatest_loss)
    lost = scan.truth.flanks[0].thickness_loss_mm
    assert worst.tooth == 1
    assert abs(worst.greatest_loss - lost) < 3.0 * worst.loss_std < 0.2 * lost


def test_views_are_merged(folder):
    files, scan = scan_file(folder, "view", replace(THIN, views=Views(3)))
    results = compare(ALONE, files, loop=False, inspection=False)
    assert len(results.measured.placed.views) == 3 and len(scan.views) == 3
    assert regions(results) == {(1, 1)}
    assert results.wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    assert results.measured.placed.thinned > 0


@pytest.mark.long
def test_triangles_give_the_boolean_as_well(folder):
    """A worn gear as watertight triangles without noise: both ways to its volume agree with the divergence theorem."""
    gear = read_design(PAIR).gears["pinion"]
    radius = gear.root_radius + (gear.flank_end_radius - gear.root_radius) * np.linspace(0.0, 1.0, 60) ** 2  # close in the fillet
    nominal = nominal_profiles(gear, radius, np.linspace(0.0, 15.0, 25))
    half_angle = nominal.half_angle.copy()
    bump = (
        np.sin(np.pi * np.clip((radius - 37.0) / 6.5, 0.0, 1.0)) ** 2
        * np.sin(np.pi * np.clip((nominal.z - 2.0) / 11.0, 0.0, 1.0))[:, None] ** 2
    )
    half_angle[3, 1] -= 0.5 * bump / gear.base_radius
    whole, worn = gear_triangles(nominal), gear_triangles(replace(nominal, half_angle=half_angle))
    file = folder / "worn.stl"
    write_stl(file, [worn], "worn")
    results = compare(ALONE, [file], loop=False, inspection=False)
    assert results.measured.scans[0].kind == "triangles"
    lost = whole.volume - worn.volume
    assert regions(results) == {(3, -1)}
    assert results.wear.volume == pytest.approx(lost, rel=0.01)
    assert results.wear.boolean is not None
    assert results.wear.boolean.signed == pytest.approx(gear.section_area() * gear.face_width - worn.volume, abs=0.01)
    assert results.wear.boolean.removed > lost


@pytest.mark.usefixtures("blank_figures")
def test_a_planar_section_gives_areas(folder, tmp_path):
    recipe = Recipe(slices=5, points_per_tooth=1500, end_points=0, ends="none", pose="none", wear=(AbrasiveWear(200.0, 1, (4,)),))
    scan = make_scan(recipe, 4)
    one = scan.points[np.isclose(scan.truth.labels.z, np.median(scan.truth.labels.z))]
    file = folder / "section.xyz"
    np.savetxt(file, one[:, :2] + [3.0, -2.0], fmt="%.6f")
    pair = tmp_path / "weighed.toml"
    pair.write_text(Path(PAIR).read_text() + '\n[weighing]\nbefore_g = 100\nafter_g = 99\nstd_g = 0.002\nmaterial = "steel"\n')
    said = run("compare", pair, file, "--out", tmp_path)
    assert (said.status, said.err) == (0, "")
    report = strict_json(tmp_path / "report.json")
    assert report["scan"]["kind"] == "section"
    assert any("weighed, but a planar section has no volume" in note for note in report["notes"])
    assert "weighed" not in report["wear"]
    assert "volume_mm3" not in report["wear"]
    found = report["wear"]["area_mm2"]
    area = scan.truth.volume_mm3 / 15.0
    assert found["value"] == pytest.approx(area, rel=0.02)
    assert [(r["tooth"], r["flank"]) for r in report["wear"]["regions"]] == [(5, "left")]
    assert "worn_volume.stl" not in report["files"] and (tmp_path / "report.html").exists()


def test_a_design_of_one_gear_leaves_out_what_needs_a_mate(folder, tmp_path):
    (tmp_path / "one.toml").write_text(ONE)
    files, scan = scan_file(folder, "plain", THIN)
    said = run(
        "compare", tmp_path / "one.toml", *files, "--out", tmp_path / "out", "--cycles-run", "1e6", "--no-loop", "--no-page"
    )
    assert (said.status, said.err) == (0, "")
    report = strict_json(tmp_path / "out" / "report.json")
    assert report["meshing"] is None
    assert any("one gear" in note and "left out" in note for note in report["notes"])
    assert any(note.startswith("no forecast") for note in report["notes"])
    assert report["wear"]["volume_mm3"]["value"] == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    assert "needs a mate" in said.out or "one gear" in said.out


@pytest.mark.long
def test_the_wheel_is_told_from_the_pinion(folder):
    recipe = Recipe(gear=WHEEL, jitter=1.0, pose="any", wear=(Patch(5, -1, 400.0, (73.0, 80.0), (1.0, 12.0)),)).of_size(24_000)
    files, scan = scan_file(folder, "wheel", recipe)
    results = compare(read_design(PAIR), files, loop=False, inspection=False)
    assert (results.part, results.gear.teeth) == ("gear", 24)
    assert {region.side for region in results.wear.regions} <= {1, -1} and len(results.wear.regions) == 1
    assert results.wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)


@pytest.mark.long
def test_a_wheel_worn_over_part_of_its_face_carries_on_the_rest(folder):
    """Rigid flanks touch where most is left, whichever of the two was scanned; so too in `meshing`."""
    recipe = Recipe(gear=WHEEL, jitter=1.0, wear=(Patch(5, -1, 400.0, (73.0, 80.0), (5.0, 10.0)),)).of_size(24_000)
    files, scan = scan_file(folder, "middle", recipe)
    results = compare(read_design(PAIR), files, "gear", loop=False, inspection=False)
    assert (results.part, len(results.wear.regions)) == ("gear", 1)
    assert results.wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    contact = results.pair.contact
    assert contact.peak_to_peak_um < 0.1 and abs(contact.backlash_max.value) < 1e-4
    study = study_meshing(results.measured.design, results.wear.present)
    assert study.contact.peak_to_peak_um == pytest.approx(contact.peak_to_peak_um, abs=1e-6)
    assert study.contact.contact_ratio_on(study.exact.path) == pytest.approx(results.pair.contact_ratio, abs=1e-9)


@pytest.mark.long
def test_a_scan_upside_down(folder):
    """Seen from its other end a gear turns the other way: left flanks are right ones, and teeth count backwards."""
    flipped = Rigid(np.diag([1.0, -1.0, -1.0]), np.array([5.0, -7.0, 40.0]))
    files, scan = scan_file(folder, "flipped", replace(THIN, pose=flipped))
    results = compare(ALONE, files, loop=False, inspection=False)
    assert regions(results) == {(11, -1)}
    assert results.wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.02)
    assert results.measured.pose.angle < np.radians(1.0)
    assert document(results, ["a"])["files"] == ["a"]  # the report is of the results alone; what was written is told to it

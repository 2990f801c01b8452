"""Cases, scoring and tables; and that the generator knows nothing of the program."""

from __future__ import annotations

import ast
import json
import math
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.families import families
from benchmarks.families.families import FAMILIES, case
from benchmarks.families.files import write_case
from benchmarks.families.scanner import scan
from benchmarks.families.scoring import Placement, interval, names, score
from benchmarks.families.table import clopper_pearson, page

FOLDER = Path(families.__file__).parent


def test_nothing_but_the_runners_process_imports_the_program():
    for path in FOLDER.glob("*.py"):
        if path.name != "compare_one.py":
            tree = ast.parse(path.read_text("utf-8"))
            tops = {a.name.split(".")[0] for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
            froms = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.module}
            assert "gearwear" not in tops, path.name
            assert not any(name.split(".")[0] in ("gearwear", "tests") for name in froms), path.name
            assert not any(name.startswith("benchmarks.loop_study") for name in froms), path.name


def test_making_a_scan_loads_no_part_of_the_program():
    code = (
        "import sys; from benchmarks.families.families import case; from benchmarks.families.scanner import scan\n"
        "c = case('a', 0, 1, 2000); scan(c.part, c.scanner, c.seed); c.record()\n"
        "sys.exit(any(m.split('.')[0] == 'gearwear' for m in sys.modules))"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=FOLDER.parents[1])


@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_makes_scans_with_a_truth(family):
    for number in range(2):
        one = case(family, number, 5, 2500)
        truth = json.loads(json.dumps(one.record()))
        design = tomllib.loads(one.toml())
        assert set(design) == ({"pinion", "gear"} if one.mate else {"gear"})
        made = scan(one.part, one.scanner, one.seed)
        assert sum(map(len, made.files)) > 1000
        assert all(np.isfinite(points).all() for points in made.files)
        assert truth["volume_mm3"] >= 0.0
        assert {entry["name"] for entry in truth["declared"]} <= set(families.effects.NAMES)
        assert len(truth["thickness"]["least"]) == truth["gear"]["teeth"]
        if family == "f":
            assert bool(truth["broken"]) != bool(truth["unseen_teeth"])


def test_a_case_depends_on_its_number_and_seed_alone():
    first, again, other = case("j", 3, 1, 3000), case("j", 3, 1, 3000), case("j", 4, 1, 3000)
    assert first.record() == again.record() != other.record()
    points = [scan(one.part, one.scanner, one.seed).files[0] for one in (first, again)]
    assert (points[0] == points[1]).all()


def test_files(tmp_path):
    one = case("e", 0, 1, 3000)
    design, scans, truth = write_case(one, tmp_path)
    assert tomllib.loads(design.read_text())["gear"]["teeth"] == truth["gear"]["teeth"]
    assert [path.name for path in scans] == truth["files"]
    head = scans[0].read_bytes().split(b"end_header\n")
    assert f"element vertex {len(head[1]) // 12}".encode() in head[0]


@pytest.mark.parametrize("flipped", [False, True])
def test_placement_of_a_gear_some_teeth_further(flipped):
    z, pitch = 20, 2.0 * math.pi / 20
    true = Rotation.from_rotvec([0.3, -0.2, 1.0])
    found = Rotation.from_euler("z", 3 * pitch + 0.001)
    if flipped:
        found = found * Rotation.from_euler("x", math.pi)
    truth = {"poses": [{"R": true.as_matrix().tolist()}], "gear": {"teeth": z}}
    placement = Placement.of({"rotation": (found * true.inv()).as_matrix().tolist()}, truth)
    assert placement.flipped == flipped
    assert placement.turn == pytest.approx(0.001, abs=1e-12)
    assert placement.tilt == pytest.approx(0.0, abs=1e-7)
    # tooth 2 lies at 2 pitches; where the ends are swapped, at −2
    assert placement.flank(2, 1, z) == ((1, -1) if flipped else (5, 1))


def loop(*effects, found=False):
    return {
        "closed_loop": {
            "effects": [{"alternatives": [], "parameters": {}} | e for e in effects],
            "unexplained": {"found": found},
        },
        "wear": {"laws": []},
    }


TRUTH = {
    "declared": [{"name": "coating", "parameters": {"thickness_um": 10.0}}],
    "may_name": [],
    "near": [],
    "outside": "",
    "wear_fields": [],
}
STILL = Placement(False, 0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("effects", "match", "false"),
    [
        ([{"name": "coating", "parameters": {"thickness_um": {"value": 11.0, "std": 0.4}}}], "name", []),
        ([{"name": "scale", "alternatives": ["coating"]}], "alternative", []),
        ([{"name": "tooth_thickness"}], "group", []),
        ([{"name": "tooth_thickness"}, {"name": "coating"}], "name", ["tooth_thickness"]),
        ([{"name": "taper"}], "missed", ["taper"]),
        ([], "missed", []),
    ],
)
def test_names(effects, match, false):
    got = names(loop(*effects), TRUTH, STILL)
    assert got["true"][0]["match"] == match
    assert got["false"] == false
    if effects and "parameters" in effects[0] and match == "name":
        assert got["true"][0]["parameters"]["thickness_um"] == {"true": 10.0, "error": 1.0, "std": 0.4}


def test_near_names_are_neither_right_nor_false():
    truth = TRUTH | {"declared": [], "near": ["tip_relief"], "may_name": ["edge_rounding"]}
    got = names(loop({"name": "tip_relief"}, {"name": "edge_rounding"}, {"name": "scale"}), truth, STILL)
    assert (got["near"], got["allowed"], got["false"]) == (["tip_relief"], ["edge_rounding"], ["scale"])


def test_intervals():
    assert interval({"value": 10.0, "std": 1.0}, 11.9)["covered"]
    assert not interval({"value": 10.0, "std": 1.0}, 12.1)["covered"]
    assert interval({"value": 10.0, "std": 1.0, "low": 5.0, "high": 20.0}, 19.0)["covered"]
    assert not interval({"value": 0.0, "std": 0.0}, 1.0)["covered"]
    assert interval({"value": 0.0, "std": 0.0}, 0.0)["covered"]
    assert not interval({"value": None, "std": None}, 0.0)["covered"]


def test_published_exact_intervals():
    """Clopper and Pearson (1934); 0 of n ends at 1 − 0.025^(1/n), n of n begins at 0.025^(1/n); 1 of 10 from the tables."""
    assert clopper_pearson(0, 10) == (0.0, pytest.approx(1.0 - 0.025**0.1))
    assert clopper_pearson(7, 7) == (pytest.approx(0.025 ** (1 / 7)), 1.0)
    assert clopper_pearson(1, 10) == (pytest.approx(0.0025, abs=5e-5), pytest.approx(0.4450, abs=5e-5))


def perfect(truth):
    """What a perfect program would report of a truth whose pose it found."""
    turn = np.array(truth["poses"][0]["R"]).T
    z = truth["gear"]["teeth"]
    broken = [{"tooth": p["tooth"] + 1, "volume_mm3": {"value": p["volume_mm3"], "std": 0.1}} for p in truth["broken"]]
    return {
        "registration": {"rotation": turn.tolist(), "converged": True},
        "closed_loop": {
            "effects": [
                {"name": e["name"], "alternatives": [], "parameters": {k: {"value": v, "std": 1.0} for k, v in e["parameters"].items()}}
                for e in truth["declared"]
            ],
            "unexplained": {"found": bool(truth["outside"])},
        },
        "wear": {
            "volume_mm3": {"value": truth["volume_mm3"], "std": 0.1}, "laws": [], "detection_limit_um": 10.0,
            "regions": [
                {"tooth": f["tooth"] + 1, "flank": "left" if f["side"] == 1 else "right", "volume_mm3": {"value": f["volume_mm3"], "std": 0.1}}
                for f in truth["wear"]
            ],
        },
        "thickness": [
            {"tooth": k + 1, "min_mm": truth["thickness"]["least"][k], "mean_mm": truth["thickness"]["mean"][k], "std_mm": 0.001}
            for k in range(z)
        ],
        "broken": broken,
    }  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES)
def test_a_perfect_report_has_a_perfect_score(family, tmp_path):
    _, _, truth = write_case(case(family, 1, 7, 2500), tmp_path)
    line = {
        "label": f"{family}1",
        "family": family,
        "study_seed": 7,
        "study_points": 2500,
        "truth": truth,
        "found": perfect(truth),
        "seconds": 1.0,
        "peak_mb": 2.0,
    }
    got = score(json.loads(json.dumps(line)))
    assert got["ended"] == "ok"
    assert not got["misplaced"]
    assert got["false"] == []
    assert all(t["match"] == "name" and all(p["error"] == 0 for p in t.get("parameters", {}).values()) for t in got["true"])
    assert got["volume"]["covered"]
    assert got["flanks"]["found"] == got["flanks"]["covered"] == got["flanks"]["worn"]
    assert got["flanks"]["false"] == 0
    assert got["thinnest"]["covered"]
    if truth["broken"]:
        assert got["broken"]["named"]
        assert got["broken"]["covered"]
    text = page([("perfect", [line])])
    assert "1/1 = 100 %" in text


def test_a_refusal_is_told(tmp_path):
    _, _, truth = write_case(case("i", 0, 7, 2000), tmp_path)
    line = {
        "label": "i0",
        "family": "i",
        "study_seed": 7,
        "study_points": 2000,
        "truth": truth,
        "refused": "no",
        "seconds": 1.0,
        "peak_mb": 2.0,
    }
    assert score(line)["ended"] == "refused"
    assert "| refused | 1 |" in page([("one", [line])])

"""A gear whose drawing modifies its flanks, scanned by a generator that shares nothing with the program: told, and not told."""

import pytest

import gearwear as gw
from benchmarks.families.draws import design_of, frame
from benchmarks.families.fields import Hollow, Polynomial, Relief
from benchmarks.families.files import write_ply
from benchmarks.families.gear import GearNumbers
from benchmarks.families.part import Part
from benchmarks.families.rack import Tool
from benchmarks.families.scanner import Scanner, scan
from benchmarks.families.truth import truth
from benchmarks.families.views import Views

RELIEF, CROWN, LENGTH = 0.03, 0.015, 5.0
"""mm; roll length in mm."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folder with a scan of 30,000 points, the keys of its design, and the wear's volume."""
    gear, tools = GearNumbers(20, 4.0, 16.0), (Tool(1.25, 0.3),)
    f = frame(gear, tools)
    hollow = Hollow(tooth=3, side=1, depth=0.12, roll=f.form + 0.5 * (f.tip - f.form), z=8.0, half_roll=3.0, half_z=4.0)
    part = Part(gear, tools, (Relief(RELIEF, f.tip - LENGTH), Polynomial(-4.0 * CROWN, 0, 2)), (hollow,))
    folder = tmp_path_factory.mktemp("drawn")
    write_ply(
        folder / "scan.ply",
        scan(part, Scanner(points=30_000, noise=0.006, views=Views(14, (-40.0, 0.0, 40.0)), pose="mild"), 5).files[0],
    )
    return folder, design_of(gear, tools[0]), truth(part, False).volume


def report(folder, design, name):
    (folder / f"{name}.toml").write_text("[gear]\n" + "".join(f"{key} = {value!r}\n" for key, value in design.items()))
    return gw.as_dict(gw.compare(folder / f"{name}.toml", folder / "scan.ply", inspection=False))


@pytest.mark.long
def test_what_is_drawn_is_neither_wear_nor_an_effect(made):
    folder, design, volume = made
    told = report(folder, design | {"tip_relief": RELIEF, "tip_relief_length": LENGTH, "helix_crowning": CROWN}, "told")
    assert told["closed_loop"]["effects"] == []
    assert [(r["tooth"], r["flank"]) for r in told["wear"]["regions"]] == [(4, "left")]
    wear = told["wear"]["volume_mm3"]
    assert abs(wear["value"] - volume) < 3.0 * wear["std"]
    assert told["design"]["modifications"]["left"] == {
        "tip_relief_mm": RELIEF,
        "tip_relief_length_mm": LENGTH,
        "tip_relief_form": "linear",
        "helix_crowning_mm": CROWN,
    }


@pytest.mark.long
def test_what_is_not_drawn_is_named_with_its_amount(made):
    folder, design, _ = made
    untold = report(folder, design, "untold")
    effects = {effect["name"]: effect["parameters"] for effect in untold["closed_loop"]["effects"]}
    assert set(effects) == {"tip_relief", "helix_crowning"}
    for name, key, amount in (("tip_relief", "amount_um", 30.0), ("helix_crowning", "crowning_um", 15.0)):
        assert abs(effects[name][key]["value"] - amount) < 3.0 * effects[name][key]["std"] + 0.3

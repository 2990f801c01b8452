"""``gearwear meshing``: the reference's numbers at the front door."""

from __future__ import annotations

import csv
import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

import gearwear as gw
from gearwear.design import Gear, GearSpec
from gearwear.design.profiles import nominal_profiles
from tests.commands.doors import PAIR, run, strict_json

PAPER = PAIR.read_text().replace("0.30 ", "0.25 ")
"""The pair with the rack tip radius that the reference's numbers are for."""


@pytest.fixture
def design(tmp_path: Path) -> Path:
    (tmp_path / "pair.toml").write_text(PAPER)
    return tmp_path / "pair.toml"


@pytest.fixture(autouse=True)
def pictures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn for the tests that look at them: they take longer than all the rest."""
    if "drawn" not in request.fixturenames:
        for name in ("_write_pictures", "_write_loaded"):
            monkeypatch.setattr(f"gearwear.report.files.meshing.{name}", lambda *given: None)


@pytest.fixture
def few_positions(monkeypatch: pytest.MonkeyPatch) -> None:
    """For what does not hang on how finely the turn is divided."""
    monkeypatch.setattr("gearwear.meshing.study.POSITIONS", 8)


@pytest.fixture
def drawn() -> None:
    """What a test asks for that looks at pictures."""


def study(design: Path, *arguments: object) -> dict:
    said = run("meshing", design, *arguments, "--out", design.parent / "out")
    assert (said.status, said.err) == (0, "")
    assert len(said.out.splitlines()) <= 24 and max(map(len, said.out.splitlines())) <= 80
    return strict_json(design.parent / "out" / "meshing.json")


@pytest.mark.usefixtures("drawn")
@pytest.mark.long
def test_under_load(design):
    """100 N/mm on the pair: mean lag 8.9 µm, mesh stiffness 12 N/(mm µm), by finite elements of another program (bores differ)."""
    said = run("meshing", design, "--torque", 53.7, "--out", design.parent / "out")
    assert (said.status, said.err) == (0, "")
    assert len(said.out.splitlines()) <= 31 and max(map(len, said.out.splitlines())) <= 80
    assert "Under load: 53.7" in said.out and "mesh stiffness" in said.out
    found = strict_json(design.parent / "out" / "meshing.json")
    assert found["loaded"]["mean_lag_um"]["value"] == pytest.approx(8.9, abs=0.7)
    assert found["loaded"]["mesh_stiffness"]["mean"]["value"] == pytest.approx(12.2, abs=0.8)
    assert "loaded.png" in found["files"] and (design.parent / "out" / "loaded.png").stat().st_size > 10_000


RING = (Path(__file__).parents[2] / "models" / "ring_pair.toml").read_text()
HELICAL = """[pinion]
teeth = 13
module = 2
helix_angle = 20
face_width = 8

[gear]
teeth = 17
"""


def test_a_load_that_is_not_modelled_is_left_out_with_a_note(tmp_path):
    """The same pair without its [load], but for the note: as `compare` does."""
    (tmp_path / "loaded.toml").write_text(f"{RING}\n[load]\ntorque_Nm = 40\n")
    (tmp_path / "rigid.toml").write_text(RING)
    loaded, rigid = (study(tmp_path / name) for name in ("loaded.toml", "rigid.toml"))
    note = "load on internal gears is not modelled: [load] is left out, the contact is rigid"
    assert loaded["notes"] == [note, *rigid["notes"]]
    assert loaded["contact"] == rigid["contact"] and loaded["exact"] == rigid["exact"]
    assert "loaded" not in rigid and "loaded" not in loaded


def test_a_load_that_is_asked_for_and_not_modelled_is_refused_with_what_to_do(tmp_path):
    (tmp_path / "ring.toml").write_text(RING)
    said = run("meshing", tmp_path / "ring.toml", "--torque", 12, "--out", tmp_path / "out")
    assert said.status == 2 and not (tmp_path / "out").exists()
    for word in ("ring.toml", "--torque 12", "internal gears is not modelled", "without --torque"):
        assert word in said.err


@pytest.mark.long
def test_a_helical_pair_carries_the_torque_by_its_transverse_force(tmp_path):
    """F = T / r_b with the transverse base radius, z m_n cos α_t / (2 cos β); N/mm over the face width."""
    (tmp_path / "helical.toml").write_text(HELICAL)
    assert run("meshing", tmp_path / "helical.toml", "--torque", 12, "--out", tmp_path / "out").status == 0
    loaded = strict_json(tmp_path / "out" / "meshing.json")["loaded"]
    beta = math.radians(20.0)
    base = 13.0 / math.cos(beta) * math.cos(math.atan(math.tan(beta) / math.cos(beta)))  # α_n = 20° too
    assert loaded["force_N"] == pytest.approx(12e3 / base, rel=1e-12)
    assert loaded["torque_Nm"] == pytest.approx(12.0) and loaded["load_per_width_N_mm"] == pytest.approx(1500.0 / base)
    assert loaded["rigid_transmission_error_um"] == pytest.approx(0.0, abs=1e-6) and loaded["mean_lag_um"]["value"] > 1.0


def test_a_torque_that_cannot_be_is_named(design):
    said = run("meshing", design, "--torque", -1)
    assert said.status == 2 and "--torque -1: must be above 0 N m" in said.err


def test_the_pair_as_designed(design):
    exact = study(design)["exact"]
    assert exact["pinion"]["start_radius_mm"] == pytest.approx(35.932602, abs=2e-6)
    assert exact["contact_ratio"] == pytest.approx(1.242204, abs=1e-6)
    assert exact["backlash"]["circumferential_mm"] == pytest.approx(0.0, abs=1e-9)
    assert exact["tip_clearance_pinion_mm"] == pytest.approx(1.5875)
    assert exact["pinion"]["single_contact_radius_mm"] == pytest.approx([36.600, 41.919], abs=2e-3)
    assert (exact["pinion"]["start_set_by"], exact["gear"]["start_set_by"]) == ("form circle", "mate's tip")
    assert exact["gear"]["end_radius_mm"] == pytest.approx(80.1609, abs=1e-3)
    assert exact["interference_pinion"]["overrun_mm"] == pytest.approx(1.984, abs=1e-3)
    assert exact["interference_free_centre_distance_mm"] == pytest.approx(114.9936, abs=1e-4)
    advised = exact["recommended_backlash"]
    assert advised["least_normal_mm"] == pytest.approx(0.2051, abs=5e-5)
    assert (advised["coarse_pitch_normal_mm"], advised["assembly_mm"]) == (None, pytest.approx([0.1778, 0.2794]))


def test_sliding_along_the_path(design):
    """Reference B7, at the start of the path, the pitch point and the end."""
    study(design)
    with (design.parent / "out" / "sliding.csv").open() as file:
        rows = list(csv.DictReader(file))
    named = {row["point"]: row for row in rows if row["point"]}
    assert list(named) == ["A", "B", "C", "D", "E"]
    for point, velocity, own, mate, radius in (
        ("A", -14.96, -4.89, 0.830, 2.82),
        ("C", 0.0, 0.0, 0.0, 8.69),
        ("E", 19.97, 0.758, -3.13, 8.59),
    ):
        row = named[point]
        assert float(row["sliding_velocity_mm_per_rad"]) == pytest.approx(velocity, abs=0.01)
        assert float(row["specific_sliding_pinion"]) == pytest.approx(own, abs=0.01)
        assert float(row["specific_sliding_gear"]) == pytest.approx(mate, abs=0.005)
        assert float(row["equivalent_radius_mm"]) == pytest.approx(radius, abs=0.01)
    rolls = [float(row["pinion_roll_mm"]) for row in rows]
    assert rolls == sorted(set(rolls)), "no place twice"


def test_another_centre_distance(design):
    exact = study(design, "--centre-distance", 116.722)["exact"]
    assert exact["backlash"]["normal_mm"] == pytest.approx(1.780441, abs=1e-6)
    assert exact["path_of_contact_mm"] == pytest.approx(21.728, abs=1e-3)


def test_one_tooth_that_lost_a_tenth(design):
    found = study(design, "--loss", 0.1, "--teeth", 3)
    contact = found["contact"]
    assert contact["transmission_error_lowest_um"] == pytest.approx(-100.0, abs=0.01)
    assert contact["transmission_error_highest_um"] == pytest.approx(0.0, abs=0.01)
    assert contact["backlash"]["greatest"]["normal_mm"] == pytest.approx(0.1, abs=1e-5)
    assert contact["backlash"]["least"]["normal_mm"] == pytest.approx(0.0, abs=1e-5)
    assert contact["drive_flank"] == "left"
    assert "tooth 3 of the pinion" in found["worn"]["source"]


def test_more_than_the_neighbours_let_it_sink(design):
    """Saturation: reference G, 1.328 mm for one tooth worn more, −1.872 for three neighbours."""
    lowest = [
        study(design, "--loss", 1.872, "--teeth", teeth)["contact"]["transmission_error_lowest_um"] for teeth in ("3", "2,3,4")
    ]
    assert lowest == pytest.approx([-1328.0, -1872.0], abs=2.0)


def test_all_teeth_alike_is_a_lag_without_ripple(design):
    for part, drive in (("pinion", "left"), ("gear", "right")):
        contact = study(design, "--loss", 0.1, "--part", part, "--drive", drive)["contact"]
        assert contact["transmission_error_um"] == pytest.approx(0.0, abs=0.01)
        assert contact["transmission_error_lowest_um"] == pytest.approx(-100.0, abs=0.01)
        assert contact["drive_flank"] == drive


def test_taking_the_loss_up(design):
    """Thinning of 1.992 mm on every tooth: the shafts would have to go where tips dig into roots."""
    cos = math.cos(math.radians(20.0))
    found = study(design, "--loss", 1.992 * cos)["take_up"]
    assert found["centre_distance_mm"] == pytest.approx(111.21263, abs=1e-4)
    assert found["bottoming_loss_mm"] == pytest.approx(1.09, abs=0.005)
    assert found["takeable_loss_mm"] < found["bottoming_loss_mm"], "fillets are in the way before root circles"
    assert not found["feasible"] and found["obstacles"]
    assert found["tightest"]["movement_mm"] == pytest.approx(found["movement_mm"], abs=1e-4), "all teeth alike"
    little = study(design, "--loss", 0.1)["take_up"]
    assert little["feasible"] and little["movement_mm"] < 0.0


def test_taking_up_means_back_to_the_designs_backlash(design):
    """Moved apart by 0.5 mm there is play by design; so much is left when the wear is taken up."""
    found = study(design, "--loss", 0.1, "--centre-distance", 114.8)
    design_play = found["exact"]["backlash"]["normal_mm"]
    assert found["take_up"]["wanted_normal_backlash_mm"] == design_play > 0.3
    again = study(design, "--loss", 0.1, "--centre-distance", found["take_up"]["tightest"]["centre_distance_mm"])
    assert again["contact"]["backlash"]["greatest"]["normal_mm"] == pytest.approx(design_play, abs=1e-5)


def test_what_the_shafts_take_up_is_said_to_its_end_while_the_screen_lasts(tmp_path):
    """Five lines here: tips bottom after 0.005 modules of clearance. Neither passes the other's interference point, so there is no note."""
    shallow = "dedendum = 1.005\nrack_tip_radius = 0.0\n"
    text = f"[pinion]\nteeth = 18\nmodule = 3\nface_width = 22\nprofile_shift = 0.2\n{shallow}[gear]\nteeth = 41\nprofile_shift = -0.2\n{shallow}"
    (tmp_path / "pair.toml").write_text(text)
    said = run("meshing", tmp_path / "pair.toml", "--loss", 0.06, "--teeth", "1", "--out", tmp_path / "out")
    assert said.status == 0 and len(said.out.splitlines()) <= 24
    told = said.out[said.out.index("The shafts") : said.out.index("Written")].strip()
    assert "Had every tooth lost" in told and told.endswith("can be taken up.")


def test_one_worn_tooth_cannot_be_taken_up(design):
    said = run("meshing", design, "--loss", 0.1, "--teeth", "3", "--out", design.parent / "out")
    assert "The shafts cannot close" in said.out
    found = strict_json(design.parent / "out" / "meshing.json")["take_up"]
    assert found["tightest"]["movement_mm"] == pytest.approx(0.0, abs=1e-5)
    assert found["loosest"]["movement_mm"] == pytest.approx(found["movement_mm"], abs=1e-4)
    assert found["movement_mm"] < -0.1
    assert found["jam_normal_mm"] == pytest.approx(0.1, abs=1e-5)
    apart = run("meshing", design, "--loss", 0.1, "--teeth", "3", "--centre-distance", 114.8, "--out", design.parent / "out")
    assert "no play to take up" in said.out.replace("\n", " ")
    assert "no more play than designed" in apart.out.replace("\n", " ")


@pytest.mark.long
@pytest.mark.usefixtures("drawn")
@pytest.mark.usefixtures("few_positions")
def test_python_gives_what_the_command_writes(design):
    command = study(design, "--loss", 0.05, "--teeth", "1,2", "--part", "gear", "--centre-distance", 114.6)
    python = gw.study_meshing(gw.read_design(design), loss=0.05, teeth=[1, 2], part="gear", centre_distance=114.6)
    assert {**json.loads(json.dumps(gw.as_dict(python))), "files": command["files"]} == command
    assert "0.05 mm off the left flank of teeth 1 and 2 of the gear" in repr(python)
    assert gw.write(python, design.parent / "again")["files"] == command["files"]
    for name in command["files"]:
        assert (design.parent / "again" / name).read_bytes() == (design.parent / "out" / name).read_bytes()


def test_profiles_from_anywhere_are_as_good_as_a_folder(design):
    pair = gw.read_design(design)
    one = pair.gears["gear"]
    worn = nominal_profiles(one, np.linspace(one.root_radius, one.tip_radius, 200), np.array([7.5]))
    worn.half_angle[:, 1] -= 0.03 / one.base_radius
    found = gw.study_meshing(pair, worn)
    assert (found.worn.part, found.drive_side) == ("gear", -1)
    assert found.worn.loss == pytest.approx(0.03 / math.cos(math.radians(20.0)), abs=1e-4)  # linear between 200 radii
    deeper = dataclasses.replace(worn, half_angle=worn.half_angle.copy())
    deeper.half_angle[17, 0] -= 0.05 / one.base_radius
    where = gw.as_dict(gw.study_meshing(pair, deeper))["worn"]
    assert (where["tooth"], where["at_z_mm"]) == (18, 7.5)
    assert found.contact.transmission_error_min.value == pytest.approx(-0.03, abs=1e-6)
    other = Gear.from_spec(GearSpec("gear", 31, 6.35, 15.0))
    with pytest.raises(gw.InputError, match="a gear of 31 teeth that the design does not have"):
        gw.study_meshing(pair, nominal_profiles(other, np.linspace(other.root_radius, other.tip_radius, 50), np.array([7.5])))


@pytest.mark.parametrize("side", gw.Side)
def test_the_side_that_drives_may_be_a_side_or_its_name(design, side):
    by_side, by_name = (gw.study_meshing(gw.read_design(design), loss=0.1, drive=drive) for drive in (side, str(side)))
    assert by_side.drive_side is by_name.drive_side is side
    np.testing.assert_array_equal(by_side.contact.transmission_error, by_name.contact.transmission_error)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"part": "rack"}, "part 'rack': pinion or gear"),
        ({"drive": "up"}, "side 'up': gw.Side.LEFT or gw.Side.RIGHT"),
        ({"drive": ""}, "side '': gw.Side.LEFT or gw.Side.RIGHT"),
        ({"cycle": "week"}, "cycle 'week': revolution or driven or hunting"),
        ({"loss": -0.1}, "loss -0.1 mm: must be above 0"),
        ({"loss": math.nan}, "must be above 0"),
        ({"loss": 0.1, "teeth": [0]}, "teeth 0: the pinion has teeth from 1 to 12"),
        ({"loss": 0.1, "teeth": []}, "teeth that are none: the pinion has teeth from 1 to 12"),
        ({"loss": 0.1, "teeth": [1.5]}, "teeth 1.5: the pinion has teeth from 1 to 12, and whole numbers of them would be right"),
        ({"loss": 0.1, "teeth": "12"}, "teeth 1, 2: the pinion has teeth from 1 to 12"),
        ({"mate_tooth": 1.5}, "mate tooth 1.5: the gear has teeth from 1 to 24"),
        ({"loss": 0.1, "wear": "worn"}, "wear and loss are both given"),
        ({"teeth": [3]}, "teeth says what has the loss"),
        ({"wear": "worn", "part": "gear"}, "part says what has the loss"),
    ],
)
def test_wrong_arguments_in_python(design, wrong, message):
    with pytest.raises(gw.InputError, match=message):
        gw.study_meshing(gw.read_design(design), **wrong)


def test_teeth_may_come_as_an_array(design):
    pair = gw.read_design(design)
    listed, array = (gw.study_meshing(pair, loss=0.05, teeth=teeth) for teeth in ([2, 1], np.array([1, 2])))
    assert listed.worn == array.worn


def test_teeth_too_thin_to_touch_on_both_flanks_are_studied_all_the_same(tmp_path):
    """4 mm of thinning: no centre distance closes it, 2 C inv α is 3.4 mm."""
    (tmp_path / "thin.toml").write_text(PAPER.replace("thinning = 0.0 ", "thinning = 2.0 ") + "thinning = 2.0\n")
    found = study(tmp_path / "thin.toml", "--loss", 0.1)
    assert found["exact"]["zero_backlash_centre_distance_mm"] is None
    assert found["exact"]["backlash"]["radial_closing_mm"] is None
    assert found["exact"]["backlash"]["circumferential_mm"] == pytest.approx(4.0, abs=1e-9)
    assert found["take_up"]["movement_mm"] == pytest.approx(-0.1 / (2.0 * math.sin(math.radians(20.0))), rel=0.01)


def high_contact_ratio(tmp_path: Path) -> Path:
    text = "[pair]\n[pinion]\nteeth = 50\nmodule = 2\nface_width = 10\npressure_angle = 14.5\naddendum = 1.2\ndedendum = 1.5\n[gear]\nteeth = 70\naddendum = 1.2\ndedendum = 1.5\n"
    (tmp_path / "high.toml").write_text(text)
    return tmp_path / "high.toml"


def test_from_a_contact_ratio_of_two_on_no_pair_is_alone(tmp_path):
    file = high_contact_ratio(tmp_path)
    said = run("meshing", file, "--out", tmp_path / "out")
    exact = strict_json(tmp_path / "out" / "meshing.json")["exact"]
    assert exact["contact_ratio"] > 2.0
    assert exact["pinion"]["single_contact_radius_mm"] is None
    assert said.out.count("never one pair") == 2
    assert [row["point"] for row in exact["sliding"]] == ["A", "C", "E"]


@pytest.mark.long
@pytest.mark.usefixtures("few_positions")
def test_the_hunting_cycle_meets_every_pair(design, tmp_path):
    text = PAPER.replace("teeth = 24", "teeth = 25").replace("centre_distance = 114.3", "centre_distance = 117.6")
    (tmp_path / "odd.toml").write_text(text)
    turn = study(tmp_path / "odd.toml", "--loss", 0.1, "--teeth", "1,2", "--cycle", "revolution")
    whole = study(tmp_path / "odd.toml", "--loss", 0.1, "--teeth", "1,2", "--cycle", "hunting")
    assert whole["contact"]["positions"] == 25 * turn["contact"]["positions"], "12 and 25 teeth have no common divisor"
    with (tmp_path / "out" / "meshing.csv").open() as file:
        pairs = {(row["pinion_tooth"], row["gear_tooth"]) for row in csv.DictReader(file)}
    assert len({pair for pair in pairs if pair[0] == "7"}) == 25


@pytest.mark.long
@pytest.mark.usefixtures("drawn")
def test_the_curves_say_what_the_summary_says(design):
    contact = study(design, "--loss", 0.05, "--teeth", "1,2,3")["contact"]
    with (design.parent / "out" / "meshing.csv").open() as file:
        rows = {key: np.array(values) for key, values in zip(*_columns(file), strict=True)}
    error = rows["transmission_error_um"].astype(float)
    assert rows["rotation_deg"].astype(float)[[0, -1]] == pytest.approx([0.0, 360.0 * (1.0 - 1.0 / len(error))], abs=1e-3)
    # Samples miss the cusps, but by no more than the slope over one position.
    assert (
        contact["transmission_error_lowest_um"] <= error.min() + 1e-3
        and error.min() < 0.9 * contact["transmission_error_lowest_um"]
    )
    np.testing.assert_allclose(1e3 * rows["backlash_normal_mm"].astype(float), -error, atol=1.1e-3)
    for picture in ("meshing.png", "path.png"):
        assert (design.parent / "out" / picture).stat().st_size > 20_000


def _columns(file) -> tuple[list[str], list[tuple[str, ...]]]:
    rows = list(csv.reader(file))
    return rows[0], list(zip(*rows[1:], strict=True))


def test_a_pair_that_jams_is_said_to(design):
    found = study(design, "--centre-distance", 113.5, "--loss", 0.6)
    assert any("overlap" in note for note in found["notes"])
    assert found["exact"]["backlash"]["normal_mm"] < 0.0

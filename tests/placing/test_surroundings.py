"""Scans with more than the gear in them, with less, and of a gear that is not quite the design's: placed right, or refused with words that help."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gearwear as gw
from gearwear.api import as_scan
from gearwear.comparison.measured_gear import MeasuredGear, register
from gearwear.design import parse_design
from gearwear.design.pair import Design
from gearwear.design.surface import FLANK
from gearwear.errors import InputError, NotThisGear
from gearwear.identify.survey import seems
from gearwear.placing.refusal import base_radius, rims, width_seen
from tests.commands.doors import EXAMPLE, PAIR
from tests.synthetic import PINION, Recipe, make_scan

NUMBERS = {"teeth": 12, "module": 6.35, "face_width": 15.0, "pressure_angle": 20.0, "rack_tip_radius": 0.3}


def design(**changed: float) -> Design:
    return parse_design({"gear": NUMBERS | changed})


@cache
def scan() -> np.ndarray:
    return make_scan(replace(Recipe(gear=PINION, pose="none").of_size(20_000), jitter=1.0), 3).points


@cache
def example() -> np.ndarray:
    """The bundled scan, in the design frame, (n, 3) mm, and its surface and side."""
    points = gw.register(gw.read_design(PAIR), gw.read_scan(EXAMPLE / "scan.ply.gz")).located
    measured = points.position + np.nan_to_num(points.deviation)[:, None] * points.normal
    return np.column_stack([measured, points.surface, points.side])


@cache
def alone() -> MeasuredGear:
    """The scan in its own design, with nothing round it."""
    return placed(scan())


def placed(points: np.ndarray, **changed: float) -> MeasuredGear:
    return register(design(**changed), as_scan(points))


def refused(points: np.ndarray, **changed: float) -> str:
    with pytest.raises(InputError) as error:
        placed(points, **changed)
    return str(error.value)


def cylinder(radius: float, low: float, high: float, count: int) -> np.ndarray:
    rng = np.random.default_rng(2)
    angle = rng.uniform(0.0, 2.0 * np.pi, count)
    wall = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(low, high, count)])
    return wall + rng.normal(0.0, 0.01, wall.shape)


def table(count: int, half: float) -> np.ndarray:
    """A plate that the gear lies on, seen outside its tip circle."""
    rng = np.random.default_rng(3)
    plate = np.column_stack([rng.uniform(-half, half, (count, 2)), rng.normal(-0.02, 0.01, count)])
    return plate[np.hypot(plate[:, 0], plate[:, 1]) > 45.0]


SURROUNDINGS = {
    "hub and shaft": np.vstack([cylinder(18.0, 15.0, 40.0, 4_000), cylinder(10.0, -60.0, 90.0, 8_000)]),
    "a long shaft, three times the gear's points": np.vstack(
        [cylinder(18.0, 15.0, 40.0, 10_000), cylinder(10.0, -200.0, 250.0, 50_000)]
    ),
    "on a table": table(30_000, 150.0),
}


@pytest.mark.long
@pytest.mark.parametrize("name", SURROUNDINGS)
def test_what_stands_round_the_gear_does_not_move_it(name):
    among = placed(np.vstack([scan(), SURROUNDINGS[name]]))
    assert among.cells.grid.count <= 1.05 * alone().cells.grid.count, "a shaft does not make the gear denser"
    corners = 44.45 * np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0.3]])
    # Neither pose is known better than some micrometres: 10 µm of noise on a few hundred points of each end face.
    own, other = (one.placed.registration.pose.apply(corners) for one in (alone(), among))
    np.testing.assert_allclose(other, own, rtol=0, atol=0.005)


@pytest.mark.parametrize("written", [pytest.param(5.0, marks=pytest.mark.long), pytest.param(20.0, marks=pytest.mark.long), 30.0])
def test_a_face_width_that_the_end_faces_contradict_is_refused_with_the_right_one(written):
    line = refused(scan(), face_width=written)
    assert "the teeth of the scan are 15 mm wide" in line or "the teeth of the scan are 15.0" in line
    assert f"face_width is {written:g} mm" in line


@pytest.mark.long
@pytest.mark.parametrize("written", [13.8, 16.2])
def test_a_face_width_some_per_cent_off_is_told_and_the_seen_one_is_used(written):
    found = placed(scan(), face_width=written)
    assert found.gear.face_width == pytest.approx(15.0, abs=0.01)
    assert any(f"face_width is {written:g} mm: taken as seen" in note for note in found.notes)


@pytest.mark.parametrize(("written", "taken"), [(14.5, 15.0), (14.9, 14.9), (15.1, 15.1), (15.5, 15.0)])
def test_a_face_width_is_the_seen_one_from_a_few_per_cent_on(written, taken):
    """0.5 mm of 15 is no tolerance of a face width, and 0.1 mm is: both end faces of the scan are known to some hundredths."""
    in_the_middle = scan() + np.array([0.0, 0.0, 0.5 * (written - 15.0)])
    assert width_seen(in_the_middle, design(face_width=written).gears["gear"]) == pytest.approx(taken, abs=0.02)


def test_teeth_of_which_only_a_part_of_the_width_was_seen_are_no_contradiction():
    assert placed(scan()[scan()[:, 2] < 9.0]).placed.registration.observed[2]


@pytest.mark.long
@pytest.mark.parametrize(("alpha", "module"), [(22.5, 6.35), (14.5, 6.35), (20.0, 6.5)])
def test_the_base_circle_is_the_scans_whatever_the_design_says(alpha, module):
    found = placed(scan(), pressure_angle=alpha, module=module)
    true = 0.5 * 12 * 6.35 * np.cos(np.radians(20.0))
    measured = base_radius(found.placed.located, found.gear)
    assert abs(measured / found.gear.base_radius - 1.0) > 0.015
    # First order in the difference, of which the design is up to 3 % off: a tenth of it at most.
    assert measured == pytest.approx(true, rel=0.003)


@pytest.mark.long
def test_the_base_circle_of_the_right_design_is_its_own():
    found = alone()
    assert base_radius(found.placed.located, found.gear) == pytest.approx(found.gear.base_radius, rel=2e-4)


@pytest.mark.long
def test_a_large_shift_is_another_gear_and_the_line_says_what_the_scan_looks_like():
    with pytest.raises(NotThisGear, match="not of this gear") as error:
        placed(scan(), profile_shift=0.3)
    # The points go with the error: commands and `gw.compare` say what they look like.
    assert "by itself the scan looks like 12 teeth, tip diameter 88.9" in seems(error.value.points, error.value.planar)


def test_worn_flanks_of_one_side_alone_do_not_place_a_gear():
    left = example()[(example()[:, 3] == FLANK) & (example()[:, 4] > 0)]
    line = refused(left[::6, :3])
    assert "flanks of one side only" in line and "tips, roots" in line


def test_half_a_gear_shows_the_wear_of_its_half():
    truth = json.loads((EXAMPLE / "truth.json").read_text(encoding="utf-8"))
    points = example()[::8, :3]
    angle = np.degrees(np.arctan2(points[:, 1], points[:, 0])) % 360.0
    half = gw.find_effects(gw.register(gw.read_design(PAIR), gw.as_scan(points[(angle > 15.0) & (angle < 195.0)])))
    found = sum(region.volume for region in gw.find_wear(half).regions)
    expected = sum(flank["volume_mm3"] for flank in truth["flanks"] if flank["tooth"] in range(1, 7))
    # A coat taken for 2 µm too thin would be a tenth of it; five of the six flanks missed, a quarter.
    assert found == pytest.approx(expected, rel=0.05)


@pytest.mark.long
@pytest.mark.parametrize("wrong", [{}, {"addendum": 1.1}, {"addendum": 0.8}, {"dedendum": 1.4}, {"profile_shift": 0.1}])
def test_tips_and_roots_are_where_the_scan_has_them_whatever_the_design_says(wrong):
    found = placed(scan(), **wrong)
    seen = rims(found.placed.measured, found.gear)
    # Tip and root circle of the made gear, m (z / 2 + 1) and m (z / 2 − 1.25); hundreds of points of 10 µm noise.
    assert seen.tip_radius == pytest.approx(6.35 * 7.0, abs=0.01)
    assert seen.root_radius == pytest.approx(6.35 * 4.75, abs=0.01)


@pytest.mark.long
def test_rims_nobody_saw_have_no_radius():
    flanks = example()[example()[:, 3] == FLANK]
    found = gw.register(gw.read_design(PAIR), gw.as_scan(flanks[::3, :3]))
    seen = rims(found.placed.measured, found.gear)
    assert np.isnan([seen.tip_radius, seen.root_radius]).all()

"""Gears found in scans without a design, against what the generator put in."""

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.cli import main
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.identify import candidates
from gearwear.identify.candidates import UNKNOWN_WIDTH, _rounded_width, find_candidates
from gearwear.identify.ring import innermost
from gearwear.identify.survey import Survey, survey
from gearwear.scan.reading import read_one
from tests.synthetic import Effect, GearNumbers, Recipe, SlidingWear, SyntheticScan, Views, make_scan

NOISE = 8.0
GEARS = {
    "few teeth, undercut": GearNumbers(11, 3.0, 12.0),
    "worn throughout on one side": GearNumbers(17, 4.0, 20.0, bore_diameter=30.0),
    "shifted, 25°": GearNumbers(23, 2.0, 18.0, 25.0, 0.4, rack_tip_radius=0.2),
    "many fine teeth": GearNumbers(75, 0.8, 6.0),
    "wide and large": GearNumbers(40, 6.0, 90.0),
}


@cache
def scan(name: str) -> SyntheticScan:
    gear = GEARS[name]
    wear = (SlidingWear(150.0, 1, (1.0,) * gear.teeth),) if "worn" in name else ()
    recipe = Recipe(gear=gear, pose="any", noise_um=NOISE, outliers=0.0005, lost=0.03, jitter=1.0, wear=wear)
    return make_scan(recipe.of_size(25_000), 5)


@cache
def seen_in(name: str) -> Survey:
    return survey(scan(name).points)


@pytest.mark.long
@pytest.mark.parametrize("name", GEARS)
def test_what_is_seen_without_a_design_is_what_was_made(name):
    made, numbers = scan(name), GEARS[name]
    outline = made.truth.outline
    seen = seen_in(name)
    assert seen.teeth == numbers.teeth
    # Lands hold hundreds of points: 3 µm is about six times the error of their median at 8 µm of noise.
    assert seen.tip_radius == pytest.approx(outline.tip_radius, abs=0.003)
    assert seen.root_radius == pytest.approx(outline.root_radius, abs=0.005)
    std = math.sqrt(seen.flank.covariance[0, 0])
    assert abs(seen.flank.base_radius - outline.base_radius) < 5.0 * std + 1e-4 * outline.base_radius
    assert seen.flank.worn_side in (Side if "worn" in name else (None,))
    assert seen.faces == 2
    assert seen.face_width == pytest.approx(numbers.face_width, abs=0.003)
    assert seen.bore_diameter == pytest.approx(numbers.bore_diameter, abs=0.005)
    assert seen.flank.scatter == pytest.approx(1e-3 * NOISE, rel=0.15)


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, 4])
def test_few_points_in_lines_make_no_helical_gear(seed):
    """Their normals show a helix that is not there, and the teeth of either hand seem to repeat."""
    seen = survey(
        make_scan(Recipe(gear=GearNumbers(25, 2.5, 15.0, profile_shift=0.25), noise_um=NOISE).of_size(20_000), seed).points
    )
    assert (seen.teeth, seen.helical) == (25, False)


LONG = ("many fine teeth", "wide and large")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.long] * (name in LONG or "shifted" in name)) for name in GEARS]
)
def test_the_pose_lays_the_axis_on_z_and_a_tooth_on_x(name):
    made = scan(name)
    seen = seen_in(name)
    pose = made.truth.pose
    both = seen.pose.rotation @ pose.rotation  # of the gear onto itself: about z, by whole teeth, or upside down
    assert abs(abs(both[2, 2]) - 1.0) < 1e-7
    turns = math.atan2(both[1, 0], both[0, 0]) * seen.teeth / (2.0 * math.pi)
    worn = 150e-3 / (seen.flank.base_radius * 2.0 * math.pi / seen.teeth) if "worn" in name else 0.0
    assert abs(turns - round(turns)) < 0.002 + worn
    origin = seen.pose.apply(pose.apply(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, GEARS[name].face_width]])))
    np.testing.assert_allclose(origin[:, :2], 0.0, atol=0.005 if worn == 0.0 else 0.03)
    np.testing.assert_allclose(np.sort(origin[:, 2]), [0.0, GEARS[name].face_width], atol=0.005)


@pytest.mark.long
@pytest.mark.parametrize("name", ["worn throughout on one side", "shifted, 25°", "many fine teeth"])
def test_the_best_candidate_is_the_gear_that_was_made(name):
    made, numbers = scan(name), GEARS[name]
    best = find_candidates(made.points).ranked[0]
    assert (best.gear.teeth, best.proposal.module.mm) == (numbers.teeth, numbers.module)
    assert math.degrees(best.proposal.pressure_angle) == pytest.approx(numbers.pressure_angle_deg)
    assert best.proposal.profile_shift == pytest.approx(numbers.profile_shift, abs=0.01)
    assert best.gear.face_width == pytest.approx(numbers.face_width, abs=0.01)
    assert best.gear.spec.bore_diameter == pytest.approx(numbers.bore_diameter, abs=0.01)
    assert best.scatter == pytest.approx(1e-3 * NOISE, rel=0.25)
    if "worn" not in name:
        assert max(abs(one.median) for one in best.left) < 0.003
        assert best.proposal.thinning == 0.0


@pytest.mark.long
def test_coat_and_scale_of_the_scan_are_not_the_gears():
    numbers = GearNumbers(24, 2.5, 15.0)
    effects = (Effect("coating", {"thickness_um": 25.0}), Effect("scale", {"relative_ppm": 2500.0}))
    made = make_scan(Recipe(gear=numbers, pose="any", noise_um=5.0, jitter=1.0, effects=effects).of_size(25_000), 2)
    best = find_candidates(made.points).ranked[0].proposal
    assert (best.module.mm, best.profile_shift, best.thinning) == (2.5, 0.0, 0.0)


SHIFTED = (
    GearNumbers(23, 4.0, 25.0, profile_shift=0.37, thinning=0.09),
    GearNumbers(31, 2.5, 20.0, profile_shift=0.23, thinning=0.07),
)


@pytest.mark.parametrize(
    ("numbers", "bore"),
    [
        pytest.param(numbers, bore, id=f"{numbers.profile_shift}-{bore}", marks=[pytest.mark.long] * (first is not (bore > 0.0)))
        for numbers, first in zip(SHIFTED, (True, False), strict=True)
        for bore in (32.0, 0.0)
    ],
)
def test_a_shift_that_is_not_round_is_offered(numbers, bore, tmp_path, monkeypatch):
    """Tip and root tell it; a round shift, or a scale that width and bore gainsay, does not hide it. Of what was found the command tells."""
    recipe = Recipe(gear=replace(numbers, bore_diameter=bore), pose="any", noise_um=NOISE, jitter=1.0)
    made = make_scan(recipe.of_size(12_000), 3)
    found = find_candidates(made.points)
    ranked = found.ranked
    same = [one.proposal for one in ranked if one.proposal.module.mm == numbers.module and one.proposal.pressure_angle < 0.36]
    free = [one for one in same if one.profile_shift == pytest.approx(numbers.profile_shift, abs=0.005)]
    assert free and max(abs(residual) for residual in free[0].residuals[:2]) < 0.025
    assert free[0].thinning == pytest.approx(numbers.thinning, abs=0.02)
    if bore:
        assert ranked[0].proposal is free[0]
        assert all(one.scale == 0.0 for one in same)
    np.savetxt(tmp_path / "scan.xyz", made.points[::20], fmt="%.4f")
    monkeypatch.setattr(candidates, "find_candidates", lambda *given: found)
    assert main(["design", str(tmp_path / "scan.xyz"), "--out", str(tmp_path / "x.toml")]) == 0
    text = (tmp_path / "x.toml").read_text(encoding="utf-8")
    assert f"shift {free[0].profile_shift:+.3f}" in text
    assert bore or "Nothing else in use comes near" not in text


@pytest.mark.long
def test_a_wrong_scale_is_found_beside_a_bore():
    """Its width and bore are whole numbers in the drawing, and not in the scan."""
    numbers = GearNumbers(24, 2.5, 20.0, bore_diameter=30.0)
    effects = (Effect("scale", {"relative_ppm": 2500.0}),)
    made = make_scan(Recipe(gear=numbers, pose="any", noise_um=5.0, jitter=1.0, effects=effects).of_size(12_000), 2)
    best = find_candidates(made.points).ranked[0].proposal
    assert (best.module.mm, best.profile_shift, best.thinning) == (2.5, 0.0, 0.0)


def test_a_view_of_part_of_the_gear_is_enough():
    made = make_scan(Recipe(noise_um=10.0, jitter=1.0, views=Views(4, 0.7)).of_size(40_000), 4)
    found = find_candidates(made.views[2])
    assert found.survey.teeth == 12
    assert found.ranked[0].proposal.module.mm == pytest.approx(6.35)
    assert any("of the 12 teeth were seen" in note for note in found.survey.notes)
    assert any("end faces" in note for note in found.survey.notes)


def test_a_planar_section_that_is_stretched():
    numbers = GearNumbers(31, 0.8, 5.0)
    made = make_scan(Recipe(gear=numbers, pose="none", noise_um=4.0, ends="none", jitter=1.0).of_size(12_000), 1)
    flat = made.points.copy()
    flat[:, 2] = 0.0
    flat[:, 1] *= 1.015
    found = find_candidates(flat, planar=True)
    assert found.survey.teeth == 31
    assert found.survey.oval == pytest.approx(0.015, abs=0.001)
    assert math.isnan(found.survey.face_width)
    assert found.ranked[0].proposal.module.mm == 0.8


def test_what_is_known_is_held_to(monkeypatch):
    points = scan("few teeth, undercut").points[::3]
    seen = survey(points)
    monkeypatch.setattr(candidates, "survey", lambda *given: seen)
    fixed = find_candidates(points, module=3.1, face_width=11.5, bore=7.5).ranked
    assert {one.proposal.module.mm for one in fixed} == {3.1}
    assert (fixed[0].gear.face_width, fixed[0].gear.spec.bore_diameter) == (11.5, 7.5)
    with pytest.raises(InputError, match="teeth = 12: the scan shows 11 teeth"):
        find_candidates(points, teeth=12)
    with pytest.raises(InputError, match="bore 27 mm: below the root diameter of the scan"):
        find_candidates(points, bore=27.0)


def test_no_gear_is_seen_in_a_ball_or_a_plate():
    rng = np.random.default_rng(1)
    ball = rng.normal(size=(20_000, 3))
    ball *= 30.0 / np.linalg.norm(ball, axis=1, keepdims=True)
    plate = rng.uniform(-1.0, 1.0, (20_000, 3)) * [40.0, 25.0, 0.01]
    for points in (ball, plate):
        with pytest.raises(InputError, match="no gear is seen"):
            survey(points)


@pytest.mark.shared
@pytest.mark.parametrize(
    ("name", "teeth", "module"),
    [
        pytest.param("flatbed_gear_1", 28, 0.6, marks=pytest.mark.long),
        pytest.param("flatbed_gear_2", 31, 0.8, marks=pytest.mark.long),
        ("flatbed_gear_3", 54, 0.5),
    ],
)
def test_real_gears_on_a_flatbed(shared, name, teeth, module):
    outline = read_one(shared / "real" / f"{name}.csv")
    found = find_candidates(outline.points, planar=True)
    assert (found.survey.teeth, found.ranked[0].proposal.module.mm) == (teeth, module)
    # All three lay on one scanner: its stretch must come out alike.
    assert found.survey.oval == pytest.approx(0.015, abs=0.002)
    direction = math.degrees(found.survey.circle.direction + found.survey.flank.phase) % 180.0
    assert direction == pytest.approx(93.0, abs=3.0)


@pytest.mark.shared
@pytest.mark.parametrize(
    ("name", "teeth", "width"),
    [("blind_c.ply", 24, 15.0)],
)
def test_practice_scans(shared, name, teeth, width):
    found = read_one(shared / "scans" / name)
    best = find_candidates(found.points, found.normals).ranked[0]
    assert (best.gear.teeth, best.proposal.module.mm) == (teeth, pytest.approx(6.35))
    assert math.degrees(best.proposal.pressure_angle) == pytest.approx(20.0)
    assert (best.proposal.profile_shift, best.gear.spec.rack_tip_radius) == (0.0, 0.3)
    if width:
        assert best.gear.face_width == width


@pytest.mark.parametrize(("hole", "end"), [(0.012, 1.6), (0.03, 1.93)])
def test_feet_of_flanks_seen_thinly_are_no_end_of_the_teeth(hole, end):
    """Even points from a root of 1.6 to a tip of 2.2 mm, a hub at 0.7 to 0.8, and a ring of flank that was not seen."""
    radius = np.concatenate([np.linspace(0.7, 0.8, 4000), np.linspace(1.6, 2.2, 20000)])
    radius = radius[(radius < 1.93 - hole * 2.2) | (radius > 1.93)]
    assert innermost(radius, 2.2) == pytest.approx(end, abs=0.004)


@pytest.mark.parametrize(
    ("seen", "faces", "inches", "drawn"),
    [
        (19.048, 2, True, 19.05),  # within 0.05 of the tenth as well, and 1/64 in is nearer
        (19.2, 2, True, 19.2),  # 0.15 mm off 1/64 in: the scan knows better
        (19.048, 2, False, 19.0),  # no gear of a diametral pitch
        (19.037, 1, True, 19.04),  # one face tells no tenth
        (math.nan, 0, True, UNKNOWN_WIDTH),
    ],
)
def test_a_face_width_is_as_drawn_where_the_scan_bears_it_out(seen, faces, inches, drawn):
    assert _rounded_width(SimpleNamespace(face_width=seen, faces=faces), inches) == drawn

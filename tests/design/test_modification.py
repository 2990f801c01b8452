"""Flanks as drawn: amounts at their places, the surface they make in space, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design import read_design
from gearwear.design.files.toml import parse_design, parse_toml
from gearwear.design.files.writing import design_text
from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, flank_points, locate
from gearwear.errors import InputError
from tests.design.drawn import ALL, HELICAL, OTHER, PLAIN, gear_with, point_by_hand


@pytest.mark.parametrize("spec", [PLAIN, HELICAL], ids=["spur", "helical"])
def test_the_surface_lies_where_the_drawing_says(spec):
    gear = gear_with(replace(ALL, helix_slope=-0.012), OTHER, spec)
    random = np.random.default_rng(3)
    for side in (1, -1):
        roll = random.uniform(gear.form_roll, gear.tip_roll, 60)
        z = random.uniform(0.0, 20.0, 60)
        drawn = np.array([point_by_hand(gear, side, a, c) for a, c in zip(roll, z, strict=True)])
        points = flank_points(gear, np.zeros(60, int), np.full(60, side), roll, z)
        np.testing.assert_allclose(points.position[:, :2], drawn, rtol=0, atol=2e-14 * 80)
        # the same by half angles: at the point's own radius the tooth is as wide as drawn
        radius, angle = np.hypot(*drawn.T), np.arctan2(drawn[:, 1], drawn[:, 0]) - gear.twist * (z - 10.0)
        half = np.array([gear.half_angles(radius[i : i + 1], z[i : i + 1])[Side(side).index, 0, 0] for i in range(60)])
        np.testing.assert_allclose(side * angle, half, rtol=0, atol=1e-14)
        np.testing.assert_allclose(locate(points.position, gear).deviation, 0.0, atol=2e-12)


@pytest.mark.parametrize("spec", [PLAIN, HELICAL], ids=["spur", "helical"])
def test_deviation_is_the_distance_to_the_modified_flank(spec):
    """Against the least distance over a fine net of the surface itself; the modification's slope tilts the normal: second order."""
    gear = gear_with(ALL, OTHER, spec)
    random = np.random.default_rng(4)
    roll, z = random.uniform(gear.form_roll + 0.3, gear.tip_roll - 0.3, 12), random.uniform(1.0, 19.0, 12)
    side = np.where(np.arange(12) % 2, 1, -1)
    feet = flank_points(gear, np.zeros(12, int), side, roll, z)
    depth = random.uniform(-0.15, 0.05, 12)
    points = feet.position + depth[:, None] * feet.normal
    located = locate(points, gear)
    for i in range(12):
        near_roll, near_z = roll[i], z[i]
        width = 0.25
        for _ in range(6):
            grid_roll, grid_z = np.meshgrid(near_roll + np.linspace(-width, width, 41), near_z + np.linspace(-width, width, 41))
            net = flank_points(gear, np.zeros(1681, int), np.full(1681, side[i]), grid_roll.ravel(), grid_z.ravel())
            distance = np.linalg.norm(net.position - points[i], axis=1)
            best = distance.argmin()
            near_roll, near_z, width = grid_roll.ravel()[best], grid_z.ravel()[best], width / 8.0
        flank = gear.drawn(Side(side[i]))
        slopes = [
            float(f(at + 1e-4) - f(at - 1e-4)) / 2e-4 for f, at in ((flank.along_profile, roll[i]), (flank.along_face, z[i]))
        ]
        tilt = (slopes[0] * gear.base_radius / roll[i]) ** 2 + slopes[1] ** 2  # along the flank, ds = L / r_b dL
        assert abs(abs(located.deviation[i]) - distance[best]) < tilt * abs(depth[i]) + 1e-6


def test_a_gear_without_modifications_is_the_same_to_the_last_digit():
    plain, none = Gear.from_spec(PLAIN), gear_with(FlankModification(tip_relief_form="parabolic"))
    assert not none.modified
    points = np.random.default_rng(5).uniform([-43, -43, 0], [43, 43, 20], (5000, 3))
    a, b = locate(points, plain), locate(points, none)
    assert np.array_equal(a.deviation, b.deviation, equal_nan=True)
    assert plain.section_area() == none.section_area()


def test_the_fillet_is_turned_with_the_end_of_its_flank():
    gear, plain = gear_with(ALL, OTHER), Gear.from_spec(PLAIN)
    radius = np.linspace(gear.root_radius + 0.05, gear.form_radius - 0.02, 20)
    for side in Side:
        turned = float(gear.drawn(side).offset(gear.form_roll, 4.0)) / gear.base_radius
        angle = side * (plain.half_angle(radius) + turned)
        points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(20, 4.0)])
        located = locate(points, gear)
        assert (located.surface == FILLET).all()
        np.testing.assert_allclose(located.deviation, 0.0, atol=1e-12)


def test_section_area_is_that_of_the_outline():
    """Shoelace over a fine outline from half angles; its chords cut off less than h²κ/8 of the length, in all below 1e-6 of the area."""
    gear = gear_with(ALL, OTHER)
    roll = np.sort(np.append(np.linspace(gear.form_roll, gear.tip_roll, 4000), gear.drawn(Side.LEFT).profile_knees))
    low = gear.root_radius + (gear.form_radius - gear.root_radius) * np.linspace(0.0, 1.0, 4000) ** 2
    radius = np.concatenate([low, np.hypot(roll, gear.base_radius)])
    for z in (1.3, 10.0, 20.0):
        left, right = gear.half_angles(radius, np.array([z]))[:, 0]
        tip = np.linspace(-right[-1], left[-1], 400)[1:-1]
        root = np.linspace(left[0], gear.pitch_angle - right[0], 400)[1:-1]
        angle = np.concatenate([-right, tip, left[::-1], root])
        around = np.concatenate([radius, np.full(398, gear.tip_radius), radius[::-1], np.full(398, gear.root_radius)])
        angle = (angle + gear.pitch_angle * np.arange(25)[:, None]).ravel()
        around = np.tile(around, 25)
        x, y = around * np.cos(angle), around * np.sin(angle)
        area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
        assert area == pytest.approx(gear.section_area(z), rel=1e-6)


def test_profiles_of_the_design_have_lost_nothing():
    gear = gear_with(ALL, OTHER)
    assert not nominal_profiles(gear, z=np.linspace(0.0, 20.0, 7)).loss.any()


def test_knees():
    flank = gear_with(ALL).drawn(Side.LEFT)
    assert flank.profile_knees == (flank.form_roll + 2.0, flank.tip_roll - 2.5)
    assert flank.face_knees == (3.0, 17.0)
    assert gear_with(OTHER).drawn(Side.LEFT).face_knees == ()


def test_from_a_file(tmp_path):
    path = tmp_path / "gear.toml"
    path.write_text(
        "[gear]\nteeth = 25\nmodule = 3\nface_width = 20\ntip_relief = 0.02\ntip_relief_length = 3.0\nhelix_crowning = 0.01\n"
        "[gear.left]\ntip_relief_start = 80.0\nhelix_crowning = 0\n"
    )
    spec = read_design(path).gears["gear"].spec
    assert spec.right == FlankModification(tip_relief=0.02, tip_relief_length=3.0, helix_crowning=0.01)
    assert spec.left == FlankModification(tip_relief=0.02, tip_relief_start=80.0)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"tip_relief": 0.02}, "tip_relief_start (diameter, mm) or tip_relief_length"),
        ({"tip_relief": -0.02, "tip_relief_length": 2}, "must lie from 0 to 1"),
        ({"tip_relief_length": 2}, "without tip_relief"),
        ({"tip_relief": 0.02, "tip_relief_length": 2, "tip_relief_start": 80}, "both given"),
        ({"tip_relief": 0.02, "tip_relief_length": 200}, "must begin on the flank"),
        ({"tip_relief": 0.02, "tip_relief_start": 10}, "must begin on the flank"),
        ({"tip_relief": 0.02, "tip_relief_length": 2, "tip_relief_form": "cubic"}, "linear, parabolic"),
        ({"tip_relief": 0.02, "tip_relief_length": 2, "tip_relief_form": 2}, "a word in quotes"),
        ({"tip_relief": 0.9, "tip_relief_length": 1}, "at most 0.2"),
        ({"end_relief": 0.02}, "end_relief_length"),
        ({"end_relief": 0.02, "end_relief_length": 11}, "half the face width"),
        ({"end_relief": 0.02, "end_relief_length": 1e-320}, "at least 0.001"),
        ({"left": 3}, "[gear.left]"),
        ({"left": {"relief": 3}}, "[gear.left] relief is unknown"),
        ({"profile_crowning": "much"}, "must be a number"),
    ],
)
def test_what_no_flank_can_have_is_refused(table, words):
    with pytest.raises(InputError) as refusal:
        parse_design({"gear": {"teeth": 25, "module": 3, "face_width": 20, **table}})
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_points_on_the_flank_belong_to_it():
    gear = gear_with(ALL, OTHER)
    random = np.random.default_rng(6)
    n = 2000
    tooth, side = random.integers(0, 25, n), random.choice([1, -1], n)
    roll, z = random.uniform(gear.form_roll + 0.05, gear.tip_roll - 0.05, n), random.uniform(0.1, 19.9, n)
    located = locate(flank_points(gear, tooth, side, roll, z).position, gear)
    assert (located.surface == FLANK).all()
    assert np.array_equal(located.tooth, tooth)
    assert np.array_equal(located.side, side)
    np.testing.assert_allclose(located.roll, roll, atol=2e-12)


@pytest.mark.parametrize(("left", "right"), [(ALL, ALL), (ALL, OTHER), (OTHER, FlankModification())])
def test_what_is_written_reads_back_the_same(left, right):
    spec = replace(PLAIN, left=left, right=right)
    assert parse_design(parse_toml(design_text(spec).encode())).gears["gear"].spec == spec

"""Helical gears in space: surfaces by a rack prism and by brute minimisation, derived sizes by published tables.

Nothing of the section's own formulas is used to check them: points are turned, cut and measured in three dimensions.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from gearwear.design import Gear, GearSpec, parse_design
from gearwear.design.surface import FILLET, FLANK, ROOT, TIP, flank_points, locate
from gearwear.design.twist import twisted, untwisted
from gearwear.errors import InputError
from tests.design.cutting import cut_depth_in_space


def helical(teeth: int, module: float, degrees: float, width: float, **more: float) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, module, width, helix_angle=math.radians(degrees), **more))


GEARS = {
    "right 15, undercut": helical(12, 3.0, 15.0, 20.0, rack_tip_radius=0.25),
    "left 25, shifted": helical(23, 2.5, -25.0, 18.0, profile_shift=0.2),
    "right 35, wide": helical(17, 4.0, 35.0, 60.0),
    "left 10, thinned, nine teeth": helical(9, 2.0, -10.0, 12.0, thinning=0.1),
}
every_gear = pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())


def helicoid(gear: Gear, side: int, tooth: int, roll: float, z: float) -> np.ndarray:
    """A point of the involute helicoid from drawing data alone: involute of the base circle, turned by 2π z / lead."""
    s, beta = gear.spec, gear.spec.helix_angle
    r = 0.5 * s.teeth * s.normal_module / math.cos(beta)
    alpha = math.atan(math.tan(s.normal_pressure_angle) / math.cos(beta))
    rb = r * math.cos(alpha)
    arc = (0.5 * math.pi + 2 * s.profile_shift * math.tan(s.normal_pressure_angle)) * s.normal_module - s.thinning
    half = arc / math.cos(beta) / (2 * r) + math.tan(alpha) - alpha - roll / rb
    tau = 2 * math.pi * tooth / s.teeth + (z - 0.5 * s.face_width) * math.tan(beta) / r + side * half
    point = [rb * math.cos(tau) - side * roll * math.sin(tau), rb * math.sin(tau) + side * roll * math.cos(tau), z]
    return np.array(point)


def _from(at: np.ndarray, gear: Gear, side: int, tooth: int, point: np.ndarray) -> np.ndarray:
    return helicoid(gear, side, tooth, at[0], at[1]) - point


@every_gear
def test_distance_and_foot_are_those_of_the_nearest_point_of_the_helicoid(gear):
    rng = np.random.default_rng(1)
    for _ in range(25):
        side, tooth = int(rng.choice([-1, 1])), int(rng.integers(gear.teeth))
        low, high = gear.form_roll + 0.15 * gear.tip_roll, 0.93 * gear.tip_roll
        roll, z = rng.uniform(low, high), rng.uniform(0.3, 0.7) * gear.face_width
        point = helicoid(gear, side, tooth, roll, z) + rng.uniform(-0.03, 0.03, 3) * gear.normal_module
        found = locate(point[None], gear)
        assert (found.surface[0], found.tooth[0], found.side[0]) == (FLANK, tooth, side)
        nearest = least_squares(_from, [roll, z], args=(gear, side, tooth, point), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        assert abs(found.deviation[0]) == pytest.approx(float(np.linalg.norm(nearest.fun)), abs=1e-12)
        assert found.position[0] == pytest.approx(point + nearest.fun, abs=1e-6)
        assert found.roll[0] == pytest.approx(nearest.x[0], abs=1e-6)
        assert found.deviation[0] * found.normal[0] == pytest.approx(-nearest.fun, abs=1e-6)


@every_gear
def test_flank_points_lie_on_the_helicoid_and_their_normals_are_square_to_it(gear):
    step = 1e-5
    for side in (-1, 1):
        for roll in np.linspace(gear.form_roll + 0.1, gear.tip_roll, 5):
            point = flank_points(gear, np.array([2]), np.array([side]), np.array([roll]), np.array([0.3 * gear.face_width]))
            z = 0.3 * gear.face_width
            assert point.position[0] == pytest.approx(helicoid(gear, side, 2, roll, z), abs=1e-12)
            along = helicoid(gear, side, 2, roll + step, z) - helicoid(gear, side, 2, roll - step, z)
            up = helicoid(gear, side, 2, roll, z + step) - helicoid(gear, side, 2, roll, z - step)
            outward = side * np.cross(up, along)
            assert point.normal[0] == pytest.approx(outward / np.linalg.norm(outward), abs=1e-9)


def root(gear: Gear, phi: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Root points of tooth 0, left side, at their heights, from the section's curve."""
    radius, angle = gear.rack.polar(phi)
    section = np.column_stack(
        [radius * np.cos(0.5 * gear.pitch_angle - angle), radius * np.sin(0.5 * gear.pitch_angle - angle), z]
    )
    return twisted(gear, section)


@every_gear
def test_a_rack_prism_rolled_past_the_gear_cuts_just_to_the_root(gear):
    """The rack tooth is a prism, round in its normal section, and the distance is taken in space. To rounding of the sweep's own parabola."""
    rng = np.random.default_rng(2)
    points = root(gear, rng.uniform(0.05, 0.98, 12) * gear.fillet_end, rng.uniform(0.2, 0.8, 12) * gear.face_width)
    assert np.abs(cut_depth_in_space(gear.spec, points)).max() < 1e-9 * gear.normal_module


def _normal(gear: Gear, phi: float, z: float) -> np.ndarray:
    """Outward normal of the root by central differences: square to a step along it and a step up the screw."""
    step = 1e-5
    along = root(gear, np.array([phi + step, phi - step]), np.array([z, z]))
    up = root(gear, np.array([phi, phi]), np.array([z + step, z - step]))
    normal = np.cross(up[0] - up[1], along[0] - along[1])
    normal /= np.linalg.norm(normal)
    radius, angle = gear.rack.polar(np.array([phi]))
    return normal if untwisted(gear, (root(gear, np.array([phi]), np.array([z])) + 1e-3 * normal))[0] @ [
        math.cos(0.5 * gear.pitch_angle), math.sin(0.5 * gear.pitch_angle), 0.0
    ] > radius[0] * math.cos(angle[0]) else -normal  # fmt: skip


@every_gear
@pytest.mark.parametrize(("off", "within", "lean"), [(0.03, 1e-9, 2e-5), (0.3, 5e-6, 3e-3)])
def test_distance_to_the_root_in_space(gear, off, within, lean):
    rng = np.random.default_rng(3)
    for _ in range(12):
        phi, z = rng.uniform(0.1, 0.9) * gear.fillet_end, rng.uniform(0.3, 0.7) * gear.face_width
        amount = off * rng.choice([-1.0, 1.0])
        foot, normal = root(gear, np.array([phi]), np.array([z]))[0], _normal(gear, phi, z)
        found = locate((foot + amount * normal)[None], gear)
        if found.surface[0] != FILLET:  # past the form circle, or the land
            continue
        assert found.deviation[0] == pytest.approx(amount, abs=within)
        assert found.normal[0] == pytest.approx(normal, abs=lean)


@every_gear
def test_normals_of_root_and_flank_agree_where_they_meet(gear):
    if gear.undercut:
        return
    z = 0.4 * gear.face_width
    at = flank_points(gear, np.array([0]), np.array([1]), np.array([gear.form_roll]), np.array([z]))
    assert _normal(gear, gear.fillet_end - 1e-5, z) == pytest.approx(at.normal[0], abs=1e-4)


@every_gear
def test_half_a_turn_about_x_at_mid_face_maps_the_gear_on_itself(gear):
    rng = np.random.default_rng(4)
    radius = rng.uniform(gear.root_radius, gear.tip_radius, 3000)
    angle = rng.uniform(-np.pi, np.pi, 3000)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0.1, 0.9, 3000) * gear.face_width])
    one = locate(points, gear)
    two = locate(points * [1.0, -1.0, -1.0] + [0.0, 0.0, gear.face_width], gear)
    known = one.surface != 7
    assert np.array_equal(one.surface, two.surface)
    assert np.array_equal(one.side[known], -two.side[known])
    assert one.deviation[known] == pytest.approx(two.deviation[known], abs=1e-12)


@every_gear
def test_lands_are_circles(gear):
    for radius, code in ((gear.tip_radius, TIP), (gear.root_radius, ROOT)):
        turn = 0.0 if code == TIP else 0.5 * gear.pitch_angle
        z = np.linspace(0.2, 0.8, 7) * gear.face_width
        middle = np.column_stack([(radius + 0.01) * np.cos(turn) + 0 * z, (radius + 0.01) * np.sin(turn) + 0 * z, z])
        found = locate(twisted(gear, middle), gear)
        assert (found.surface == code).all()
        assert found.deviation == pytest.approx(0.01, abs=1e-12)
        assert (found.normal[:, 2] == 0.0).all()


@every_gear
def test_area_of_the_section_is_that_of_its_polygon(gear):
    radius = np.concatenate(
        [np.linspace(gear.root_radius, gear.form_radius, 20001), np.linspace(gear.form_radius, gear.tip_radius, 20001)[1:]]
    )
    half = gear.half_angle(radius)
    fan = 0.5 * gear.root_radius**2 * gear.root_half_angle + 0.5 * gear.tip_radius**2 * gear.tip_half_angle
    chords = 0.5 * np.sum(radius[1:] * radius[:-1] * np.sin(half[:-1] - half[1:]))
    assert gear.section_area() == pytest.approx(2 * gear.teeth * (fan + chords), rel=1e-7)


def test_published_helical_gears_by_their_normal_system():
    """KHK, Technical Reference, calculation of helical gears, normal system: m_n 3, α 20°, β 30°, z 12 and 60, x 0.09809 and 0."""
    small, large = helical(12, 3.0, 30.0, 20.0, profile_shift=0.09809), helical(60, 3.0, -30.0, 20.0)
    assert math.degrees(small.transverse_pressure_angle) == pytest.approx(22.79588, abs=1e-5)
    assert (2 * small.reference_radius, 2 * large.reference_radius) == pytest.approx((41.569, 207.846), abs=5e-4)
    assert (2 * small.base_radius, 2 * large.base_radius) == pytest.approx((38.322, 191.611), abs=5e-4)


@every_gear
def test_normal_and_transverse_quantities(gear):
    beta, base = gear.helix_angle, gear.base_helix_angle
    assert math.tan(base) == pytest.approx(math.tan(beta) * math.cos(gear.transverse_pressure_angle), rel=1e-13)
    assert math.cos(gear.transverse_pressure_angle) * math.cos(base) == pytest.approx(
        math.cos(gear.normal_pressure_angle) * math.cos(beta), rel=1e-14
    )
    assert gear.twist == pytest.approx(math.tan(base) / gear.base_radius, rel=1e-13)
    assert gear.base_pitch * math.cos(base) == pytest.approx(
        math.pi * gear.normal_module * math.cos(gear.normal_pressure_angle), rel=1e-14
    )
    assert gear.normal_tooth_thickness == pytest.approx(gear.tooth_thickness * math.cos(beta), rel=1e-15)


PAIR = {
    "pinion": {"teeth": 17, "module": 2.0, "face_width": 12.0, "helix_angle": 25.0},
    "gear": {"teeth": 31},
}


def test_the_mate_has_the_other_hand():
    design = parse_design(PAIR)
    assert design.gears["gear"].helix_angle == -design.gears["pinion"].helix_angle
    assert design.centre_distance == pytest.approx(2.0 * 24 / math.cos(math.radians(25.0)))
    assert (design.gears["pinion"].spec.hand, design.gears["gear"].spec.hand) == ("right", "left")


@pytest.mark.parametrize("angle", [25.0, -24.0, 0.0])
def test_pairs_of_other_angles_are_refused_by_name(angle):
    with pytest.raises(InputError, match=rf"helix_angle = {angle:g}° does not mesh with the pinion's 25°.*-25° *$"):
        parse_design({**PAIR, "gear": {"teeth": 31, "helix_angle": angle}})


def test_modules_and_diameters_of_a_design_file():
    cos = math.cos(math.radians(20.0))
    table = {"teeth": 20, "face_width": 10.0, "helix_angle": 20.0}
    by = {key: parse_design({"gear": {**table, key: value}}).gears["gear"]
          for key, value in (("module", 3.0), ("normal_module", 3.0), ("transverse_module", 3.0 / cos), ("diametral_pitch", 25.4 / 3.0))}  # fmt: skip
    for gear in by.values():
        assert gear.normal_module == pytest.approx(3.0, rel=1e-14)
        assert gear.transverse_module == pytest.approx(3.0 / cos, rel=1e-14)
    drawn = {**table, "module": 3.0, "profile_shift": 0.3, "tip_diameter": 71.0, "root_diameter": 58.0}
    gear = parse_design({"gear": drawn}).gears["gear"]
    assert (2 * gear.tip_radius, 2 * gear.root_radius) == pytest.approx((71.0, 58.0), rel=1e-14)

"""Rings: flanks by brute minimisation in space, roots by a cutter swept past a blank, radii by published tables.

Nothing of the section's own formulas is used to check them: points are set out, cut and measured in three dimensions.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from gearwear.design import Gear, GearSpec, parse_design
from gearwear.design.fillet_arc import FilletArc
from gearwear.design.internal import InternalPair, Wheel
from gearwear.design.profiles import nominal_profiles
from gearwear.design.shaper import ShaperTip
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP, flank_points, locate
from gearwear.design.twist import twisted, untwisted
from gearwear.errors import InputError
from tests.design.shaping import Cutter


def ring(teeth: int, module: float, degrees: float, width: float, **more: float) -> Gear:
    return Gear.from_spec(GearSpec("gear", teeth, module, width, helix_angle=math.radians(degrees), internal=True, **more))


GEARS = {
    "spur": ring(48, 2.5, 0.0, 15.0, addendum=0.8, cutter_teeth=20, cutter_tip_radius=0.16, rim_diameter=144.0),
    "left 20": ring(72, 2.0, -20.0, 20.0, cutter_teeth=25, cutter_tip_radius=0.2, rim_diameter=180.0),
    "right 15, thick teeth, thinned": ring(
        60, 3.0, 15.0, 30.0, profile_shift=0.3, thinning=0.12, addendum=0.6, cutter_teeth=18, cutter_tip_radius=0.15, rim_diameter=220.0
    ),
    "left 25, thin teeth": ring(
        80, 1.5, -25.0, 18.0, profile_shift=-0.4, cutter_teeth=30, cutter_tip_radius=0.1, rim_diameter=160.0
    ),
    "right 12, drawn fillet": ring(50, 2.0, 12.0, 16.0, addendum=0.7, fillet_radius=0.45, rim_diameter=120.0),
}  # fmt: skip
every_ring = pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())
SHARP = ring(64, 2.0, 10.0, 20.0, cutter_teeth=24, cutter_tip_radius=0.0)
every_shaped = pytest.mark.parametrize("gear", [*list(GEARS.values())[:4], SHARP], ids=[*list(GEARS)[:4], "sharp cutter"])


def helicoid(gear: Gear, side: int, tooth: int, roll: float, z: float) -> np.ndarray:
    """A point of a ring's flank from drawing data alone: the involute of the **space**, which is that of an external tooth, carried along the lead."""
    s, beta = gear.spec, gear.spec.helix_angle
    r = 0.5 * s.teeth * s.normal_module / math.cos(beta)
    alpha = math.atan(math.tan(s.normal_pressure_angle) / math.cos(beta))
    rb = r * math.cos(alpha)
    arc = (0.5 * math.pi + 2 * s.profile_shift * math.tan(s.normal_pressure_angle)) * s.normal_module - s.thinning
    space = (math.pi * s.normal_module - arc) / math.cos(beta) / (2 * r)
    half = space + math.tan(alpha) - alpha - roll / rb
    # The left flank of a tooth is the right flank of the space half a pitch further on.
    tau = 2 * math.pi * (tooth + 0.5 * side) / s.teeth + (z - 0.5 * s.face_width) * math.tan(beta) / r - side * half
    return np.array([rb * math.cos(tau) + side * roll * math.sin(tau), rb * math.sin(tau) - side * roll * math.cos(tau), z])


def _from(at: np.ndarray, gear: Gear, side: int, tooth: int, point: np.ndarray) -> np.ndarray:
    return helicoid(gear, side, tooth, at[0], at[1]) - point


@every_ring
def test_distance_and_foot_are_those_of_the_nearest_point_of_the_helicoid(gear):
    rng = np.random.default_rng(1)
    for _ in range(25):
        side, tooth = int(rng.choice([-1, 1])), int(rng.integers(gear.teeth))
        share = rng.uniform(0.15, 0.85)
        roll, z = gear.tip_roll + share * (gear.form_roll - gear.tip_roll), rng.uniform(0.3, 0.7) * gear.face_width
        point = helicoid(gear, side, tooth, roll, z) + rng.uniform(-0.02, 0.02, 3) * gear.normal_module
        found = locate(point[None], gear)
        assert (found.surface[0], found.tooth[0], found.side[0]) == (FLANK, tooth, side)
        best = least_squares(
            _from, [roll, z], args=(gear, side, tooth, point), xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=[1.0, 1.0]
        )
        foot = helicoid(gear, side, tooth, *best.x)
        assert abs(found.deviation[0]) == pytest.approx(np.linalg.norm(point - foot), abs=1e-10)
        assert found.position[0] == pytest.approx(foot, abs=1e-7)  # the least distance is flat
        assert found.position[0] + found.deviation[0] * found.normal[0] == pytest.approx(point, abs=1e-12)
        assert found.own_roll(gear)[0] == pytest.approx(math.sqrt(point[0] ** 2 + point[1] ** 2 - gear.base_radius**2), abs=1e-11)


@every_ring
def test_points_of_the_flank_and_their_normals(gear):
    """Metal lies between the flanks of a tooth: from the foot along −n to the tooth's centre line; normals are square to two tangents."""
    step = 1e-5
    for side in (-1, 1):
        for roll in np.linspace(gear.tip_roll, gear.form_roll, 5):
            z = 0.3 * gear.face_width
            point = flank_points(gear, np.array([2]), np.array([side]), np.array([roll]), np.array([z]))
            assert point.position[0] == pytest.approx(helicoid(gear, side, 2, roll, z), abs=1e-11)
            along = helicoid(gear, side, 2, roll + step, z) - helicoid(gear, side, 2, roll - step, z)
            up = helicoid(gear, side, 2, roll, z + step) - helicoid(gear, side, 2, roll, z - step)
            outward = np.cross(up, along)
            outward /= np.linalg.norm(outward)
            inside = untwisted(gear, point.position - 1e-3 * point.normal)[0]
            tooth = 2 * gear.pitch_angle
            assert abs(math.atan2(inside[1], inside[0]) - tooth) < abs(
                math.atan2(*untwisted(gear, point.position)[0][1::-1]) - tooth
            )
            assert abs(point.normal[0] @ outward) == pytest.approx(1.0, abs=1e-12)


@every_shaped
def test_a_cutter_rolled_inside_the_ring_cuts_just_to_root_and_flank(gear):
    rng = np.random.default_rng(2)
    cutter = Cutter(gear.spec, gear.spec.cutter_teeth, gear.spec.cutter_tip_radius * gear.normal_module)
    radius, angle = gear.root_curve.polar(rng.uniform(0.03, 0.97, 12) * gear.fillet_end)
    assert np.abs(cutter.cut_depth(radius, angle)).max() < 1e-9 * gear.normal_module
    flank = rng.uniform(gear.tip_radius, gear.form_radius, 12)
    depth = cutter.cut_depth(flank, 0.5 * gear.pitch_angle - gear.half_angle(flank))
    assert np.abs(depth).max() < 1e-9 * gear.normal_module


def root(gear: Gear, phi: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Root points of tooth 0, left side, at their heights, from the section's curve."""
    radius, angle = gear.root_curve.polar(phi)
    at = 0.5 * gear.pitch_angle - angle
    return twisted(gear, np.column_stack([radius * np.cos(at), radius * np.sin(at), z]))


def _normal(gear: Gear, phi: float, z: float) -> np.ndarray:
    """Outward normal of the root by central differences; out of the metal is towards the axis or the space's centre line."""
    step = 1e-5
    along = root(gear, np.array([phi + step, phi - step]), np.array([z, z]))
    up = root(gear, np.array([phi, phi]), np.array([z + step, z - step]))
    normal = np.cross(along[0] - along[1], up[0] - up[1])
    normal /= np.linalg.norm(normal)
    space = twisted(
        gear,
        np.array([[gear.tip_radius * math.cos(0.5 * gear.pitch_angle), gear.tip_radius * math.sin(0.5 * gear.pitch_angle), z]]),
    )
    return normal if normal @ (space[0] - root(gear, np.array([phi]), np.array([z]))[0]) > 0.0 else -normal  # fmt: skip


@every_ring
@pytest.mark.parametrize(("off", "within", "lean"), [(0.03, 1e-6, 1e-3), (0.2, 1e-4, 1e-2)])
def test_distance_to_the_root_in_space(gear, off, within, lean):
    rng = np.random.default_rng(3)
    met = 0
    for _ in range(20):
        phi, z = rng.uniform(0.1, 0.9) * gear.fillet_end, rng.uniform(0.3, 0.7) * gear.face_width
        amount = off * rng.choice([-1.0, 1.0])
        foot, normal = root(gear, np.array([phi]), np.array([z]))[0], _normal(gear, phi, z)
        found = locate((foot + amount * normal)[None], gear)
        if found.surface[0] != FILLET:  # past the form circle, or the land
            continue
        met += 1
        assert found.deviation[0] == pytest.approx(amount, abs=within)
        assert found.normal[0] == pytest.approx(normal, abs=lean)
    assert met > 3


@every_ring
def test_normals_of_root_and_flank_agree_where_they_meet(gear):
    z = 0.4 * gear.face_width
    at = flank_points(gear, np.array([0]), np.array([1]), np.array([gear.form_roll]), np.array([z]))
    assert root(gear, np.array([gear.fillet_end]), np.array([z]))[0] == pytest.approx(at.position[0], abs=1e-11)
    assert _normal(gear, gear.fillet_end, z) == pytest.approx(at.normal[0], abs=1e-4)
    assert float(gear.root_curve.lever(np.array(gear.fillet_end))) == pytest.approx(gear.base_radius, rel=1e-13)


@every_ring
def test_half_a_turn_about_x_at_mid_face_maps_the_ring_on_itself(gear):
    rng = np.random.default_rng(4)
    radius = rng.uniform(gear.tip_radius, gear.root_radius, 2000)
    angle = rng.uniform(-np.pi, np.pi, 2000)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0.1, 0.9, 2000) * gear.face_width])
    one = locate(points, gear)
    two = locate(points * [1.0, -1.0, -1.0] + [0.0, 0.0, gear.face_width], gear)
    known = one.surface != 7
    assert np.array_equal(one.surface, two.surface)
    assert np.array_equal(one.side[known], -two.side[known])
    assert one.deviation[known] == pytest.approx(two.deviation[known], abs=1e-12)


@every_ring
def test_lands_outside_and_ends(gear):
    z = np.linspace(0.2, 0.8, 7) * gear.face_width
    rim = 0.5 * gear.spec.rim_diameter
    for radius, out, code in ((gear.tip_radius, -0.01, TIP), (gear.root_radius, -0.01, ROOT), (rim, 0.01, BORE)):
        turn = 0.5 * gear.pitch_angle if code == ROOT else 0.0
        middle = np.column_stack([(radius + out) * np.cos(turn) + 0 * z, (radius + out) * np.sin(turn) + 0 * z, z])
        found = locate(twisted(gear, middle), gear)
        assert (found.surface == code).all()
        assert found.deviation == pytest.approx(0.01, abs=1e-12)
        assert (np.sign((found.normal * found.position)[:, :2].sum(axis=1)) == np.sign(out)).all()
    body = 0.5 * (rim + gear.root_radius)
    faces = locate(np.array([[body, 0.0, -0.02], [0.0, body, gear.face_width - 0.02]]), gear)
    assert faces.surface.tolist() == [END_LOW, END_HIGH]
    assert faces.deviation == pytest.approx([0.02, -0.02], abs=1e-12)


@every_ring
def test_area_of_the_section_is_the_rim_disc_less_the_polygon_of_the_space(gear):
    phi = np.linspace(0.0, gear.fillet_end, 20001)
    radius, angle = gear.root_curve.polar(phi)
    roll = np.linspace(gear.form_roll, gear.tip_roll, 20001)[1:]
    half = np.array([gear.base_half_angle]) + roll / gear.base_radius - np.arctan(roll / gear.base_radius)
    r = np.concatenate([radius, np.hypot(gear.base_radius, roll)])
    beta = np.concatenate([angle, 0.5 * gear.pitch_angle - half])
    chords = 0.5 * np.sum(r[1:] * r[:-1] * np.sin(np.diff(beta)))
    land = 0.5 * gear.root_radius**2 * gear.root_half_angle
    tip = 0.5 * gear.tip_radius**2 * (0.5 * gear.pitch_angle - beta[-1])
    whole = math.pi * (0.5 * gear.spec.rim_diameter) ** 2 - 2 * gear.teeth * (land + chords + tip)
    assert gear.section_area() == pytest.approx(whole, rel=1e-8)
    assert gear.volume == pytest.approx(gear.face_width * whole, rel=1e-8)


@every_ring
def test_radius_and_parameter_of_the_root(gear):
    phi = np.linspace(0.0, gear.fillet_end, 501)[1:]
    radius, _ = gear.root_curve.polar(phi)
    assert gear.root_curve.polar(gear.fillet_phi(radius))[0] == pytest.approx(radius, rel=1e-14)
    assert gear.fillet_phi(radius) == pytest.approx(phi, abs=1e-9)


@every_ring
def test_profiles_rise_in_radius_and_thicken_towards_the_rim(gear):
    profiles = nominal_profiles(gear)
    assert (np.diff(profiles.radius) > 0.0).all()
    assert (np.diff(profiles.half_angle[0, 0, 0]) > 0.0).all()
    reference = profiles.thickness(gear.reference_radius)
    assert reference == pytest.approx(gear.tooth_thickness, rel=1e-5)


def test_published_internal_gear():
    """KHK, Technical Reference, internal gears: m 3, 16 in 24, x 0 and +0.5 by KHK's sign, which is −0.5 by ISO's; d_a2 69.000, d_f2 82.5."""
    gear = ring(24, 3.0, 0.0, 20.0, profile_shift=-0.5)
    assert (2 * gear.tip_radius, 2 * gear.root_radius) == pytest.approx((69.0, 82.5), abs=1e-12)
    assert not gear.root_stated
    assert "a fillet of" in gear.notes[0]  # no usual cutter does it: 16 teeth miss by 0.03 mm of roll


def test_an_assumed_cutter_meets_the_conditions_and_is_said():
    gear = ring(72, 2.0, 0.0, 20.0)
    assert "a cutter of 25 teeth with a tip radius of 0.2 modules is assumed" in gear.notes[0]
    assert isinstance(gear.root_curve, ShaperTip)
    small = ring(40, 2.0, 0.0, 20.0, addendum=0.7, profile_shift=0.1)
    assert isinstance(small.root_curve, ShaperTip)
    assert small.root_curve.ratio * 40 < 25
    assert GEARS["spur"].notes == ()


def overlap(pinion: tuple[int, float], mate: tuple[int, float], module: float, centre: float) -> float:
    """Deepest that tips of a pinion (teeth, tip radius) ever get over the teeth of a ring without play, mm: outlines rolled one inside the other."""
    alpha = math.radians(20.0)
    base = [0.5 * module * z * math.cos(alpha) for z in (pinion[0], mate[0])]
    working = math.acos((base[1] - base[0]) / centre)

    def half(kind: int, radius: np.ndarray) -> np.ndarray:
        """Half angle of the pinion's tooth or the ring's space, both as of an external tooth; equal arcs on the working circles."""
        at = np.arccos(np.minimum(base[kind] / radius, 1.0))
        pitch = (pinion[0], mate[0])[kind]
        return math.pi / (2 * pitch) + math.tan(working) - working - (np.tan(at) - at)

    radius = np.linspace(pinion[1] - 0.4 * module, pinion[1], 60)
    flank = np.concatenate([half(0, radius), np.linspace(half(0, radius[-1:])[0], 0.0, 12)])
    radius = np.concatenate([radius, np.full(12, pinion[1])])
    deepest = 0.0
    for turn in np.linspace(-1.8, 1.8, 1801):
        for sign in (-1.0, 1.0):
            angle = turn + sign * flank
            x, y = centre + radius * np.cos(angle), radius * np.sin(angle)
            rho, theta = np.hypot(x, y), np.arctan2(y, x) - turn * pinion[0] / mate[0]
            pitch = 2 * math.pi / mate[0]
            within = np.abs(theta - pitch * np.round(theta / pitch))
            metal = (rho > mate[1]) & (within > half(1, np.maximum(rho, base[1])))
            into = np.minimum(rho - mate[1], rho * (within - half(1, np.maximum(rho, base[1]))))
            deepest = max(deepest, float(np.where(metal, into, 0.0).max()))
    return deepest


@pytest.mark.parametrize(("small", "large"), [(20, 60), (40, 60), (52, 60), (55, 60), (26, 32)])
def test_tips_that_foul_are_those_that_overlap_when_rolled(small, large):
    """Addendum 0.8 modules; where the ring's tip does not reach the pinion's base circle only fouling is left."""
    module, addendum, alpha = 2.0, 0.8, math.radians(20.0)
    radii = [module * (0.5 * small + addendum), max(module * (0.5 * large - addendum), module * 0.5 * large * math.cos(alpha))]
    base = [0.5 * module * z * math.cos(alpha) for z in (small, large)]
    centre = 0.5 * module * (large - small)
    pair = InternalPair(Wheel(small, radii[0], base[0]), Wheel(large, radii[1], base[1]), centre)
    if pair.involute_margin < 0.0:  # let only tips count
        radii[1] = math.hypot(base[1], centre * math.sin(pair.working_angle))
        pair = InternalPair(pair.pinion, Wheel(large, radii[1], base[1]), centre)
    depth = overlap((small, radii[0]), (large, radii[1]), module, centre)
    assert (depth > 1e-3) == (pair.fouling_margin < 0.0), (depth, pair.fouling_margin)


RING = {"teeth": 60, "module": 2.0, "face_width": 16.0, "internal": True}


def test_a_ring_of_a_design_file():
    design = parse_design(
        {"gear": {**RING, "tip_diameter": 116.5, "root_diameter": 124.8, "cutter_teeth": 20, "cutter_tip_radius": 0.1, "rim_diameter": 140.0}}
    )  # fmt: skip
    gear = design.gears["gear"]
    assert (2 * gear.tip_radius, 2 * gear.root_radius) == pytest.approx((116.5, 124.8), rel=1e-14)
    assert (gear.orientation, gear.body_radius, gear.root_stated) == (-1, 70.0, True)
    assert isinstance(parse_design({"gear": {**RING, "fillet_radius": 0.4}}).gears["gear"].root_curve, FilletArc)
    assert "assumed" in parse_design({"gear": RING}).warnings[0]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"bore_diameter": 20.0}, "a ring has a rim_diameter"),
        ({"rack_tip_radius": 0.3}, "no rack cuts a ring"),
        ({"rim_diameter": 120.0}, "must be above the root diameter 125"),
        ({"teeth": 24}, r"lies inside the base circle.*profile_shift is ISO's: \+ makes a ring's teeth thicker"),
        ({"cutter_teeth": 20, "fillet_radius": 0.4}, "both given: one of them"),
        ({"cutter_teeth": 60}, "must be below the ring's 60"),
        ({"cutter_teeth": 20, "cutter_tip_radius": 0.9}, "too large for a cutter of 20 teeth, at most 0"),
        ({"cutter_tip_radius": 0.2}, "cutter_tip_radius without cutter_teeth"),
        ({"cutter_teeth": 57}, "foul"),
        ({"cutter_teeth": 12}, "cuts away the ring's tips"),
        ({"fillet_radius": 5.0}, "too large for the space"),
        ({"helix_angle": 20.0, "gap": 2.0}, "double helical rings are out of scope"),
        ({"internal": 1}, "true for a ring or false"),
        ({"teeth": -60}, "internal = true"),
        ({"internal": False, "rim_diameter": 140.0}, "rim_diameter belongs to a ring"),
    ],
)
def test_what_no_ring_can_be_is_refused_by_name(more, said):
    with pytest.raises(InputError, match=said):
        parse_design({"gear": {**RING, **more}})


def test_a_ring_without_a_rim_has_no_volume():
    with pytest.raises(InputError, match="rim_diameter is missing"):
        parse_design({"gear": RING}).gears["gear"].section_area()

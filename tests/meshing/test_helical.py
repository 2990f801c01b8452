"""Helical pairs: published cases, closed forms, and every slice at once in space."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.backlash import backlash, centre_distance_for_backlash, zero_backlash_centre_distance
from gearwear.meshing.contact import mesh_contact
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.linear import linear_contact
from gearwear.meshing.path import path_of_contact
from gearwear.meshing.recommended import recommended_backlash
from gearwear.meshing.shafts import shaft_movement, take_up, take_up_words
from tests.meshing.shift_sum import profile_shift_sum

BETA = math.radians(25.0)
BETA_B = math.asin(math.sin(BETA) * math.cos(math.radians(20.0)))


def pair(beta=BETA, width=(18.0, 16.0), thinning=0.1, teeth=(17, 31)):
    def spec(name, z, b, x, sign):
        return GearSpec(name, z, 2.5, b, helix_angle=sign * beta, profile_shift=x, thinning=thinning)

    return Gear.from_spec(spec("pinion", teeth[0], width[0], 0.1, 1)), Gear.from_spec(spec("gear", teeth[1], width[1], -0.1, -1))


def flanks(gear, radii=120, z=None):
    return nominal_profiles(gear, np.linspace(gear.root_radius, gear.tip_radius, radii), z)


def worn(profiles, depth, teeth, side=Side.LEFT):
    """Normal depth (mm) off one side of some teeth: a number, or (n_z, n_r)."""
    spec = profiles.gear.spec
    base = 0.5 * spec.normal_module * spec.teeth / math.cos(spec.helix_angle)
    base *= math.cos(math.atan(math.tan(spec.normal_pressure_angle) / math.cos(spec.helix_angle)))
    half_angle = profiles.half_angle.copy()
    half_angle[list(teeth), side.index] -= depth / (base * math.cos(BETA_B))
    return replace(profiles, half_angle=half_angle)


STANDARD = 0.5 * 2.5 * (17 + 31) / math.cos(BETA)


@pytest.mark.parametrize("apart", [0.0, 0.3])
@pytest.mark.parametrize("beta", [BETA, -math.radians(8.0)])
def test_a_perfect_pair_runs_without_error(beta, apart):
    pinion, gear = pair(beta)
    centre = 0.5 * 2.5 * 48 / math.cos(beta) + apart
    found = mesh_contact(flanks(pinion), flanks(gear), centre, positions_per_pitch=3)
    assert np.abs(found.transmission_error_um).max() < 1e-6
    # ISO 21771 from normal values alone: j_bt from involutes, normal to the flanks by cos β_b.
    alpha_t = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    working = math.acos((centre - apart) * math.cos(alpha_t) / centre)
    involutes = [math.tan(angle) - angle for angle in (working, alpha_t)]
    transverse = 2.0 * (centre - apart) * math.cos(alpha_t) * (involutes[0] - involutes[1]) + 2 * 0.1 / math.cos(beta) * math.cos(
        alpha_t
    )
    cos_base = math.cos(alpha_t) ** -1 * math.cos(math.radians(20.0)) * math.cos(beta)
    np.testing.assert_allclose(found.backlash, transverse * cos_base, atol=1e-12)
    np.testing.assert_allclose(found.angular_backlash_driver, transverse / pinion.base_radius, atol=1e-12)
    play = exact_meshing(pinion, gear, centre).backlash
    assert play.normal == pytest.approx(transverse * cos_base, abs=1e-12)
    assert play.circumferential == pytest.approx(transverse / math.cos(working), abs=1e-12)


@pytest.mark.parametrize("side", list(Side))
def test_a_uniform_loss_counts_by_the_base_helix(side):
    pinion, gear = pair()
    found = mesh_contact(worn(flanks(pinion), 0.01, range(17), side), flanks(gear), STANDARD, side, positions_per_pitch=3)
    np.testing.assert_allclose(found.transmission_error_um, -10.0 / math.cos(BETA_B), atol=1e-6)
    np.testing.assert_allclose(found.backlash - backlash(pinion, gear, STANDARD).normal, 0.01, atol=1e-9)


def test_neighbours_carry_for_one_worn_tooth():
    # ε_γ = 2.25: wherever the worn tooth would touch, another does. As spur gears (ε_α 1.5) it has to carry alone.
    pinion, gear = pair()
    found = mesh_contact(worn(flanks(pinion), 0.01, [0]), flanks(gear), STANDARD, positions_per_pitch=5)
    assert found.transmission_error_min.value == pytest.approx(0.0, abs=1e-9)
    straight = tuple(Gear.from_spec(replace(one.spec, helix_angle=0.0)) for one in (pinion, gear))
    own = flanks(straight[0])
    own.half_angle[0, 0] -= 0.01 / straight[0].base_radius
    found = mesh_contact(own, flanks(straight[1]), 0.5 * 2.5 * 48)
    assert found.transmission_error_min.value == pytest.approx(-0.01, abs=1e-9)


def in_space(own, mate, centre, turn, side):
    """Lead of the driven gear (rad) by holding a dense cloud of the driver's flank points in space against the mate's flanks."""
    (one, two), best = (own.gear, mate.gear), -np.inf
    radius = np.linspace(one.root_radius, one.tip_radius, 4001)
    twist = [
        math.tan(g.spec.helix_angle) * 2.0 * math.cos(g.spec.helix_angle) / (g.spec.normal_module * g.spec.teeth)
        for g in (one, two)
    ]
    half = 0.5 * min(one.face_width, two.face_width)
    for row, z in enumerate(own.z):
        height = z - 0.5 * one.face_width
        if abs(height) > half:
            continue
        first = -round(turn / one.pitch_angle)
        for k in range(first - 3, first + 4):
            tooth = side * k
            psi = one.half_angle(radius) + np.interp(
                radius, own.radius, own.half_angle[tooth % one.teeth, side.index, row] - one.half_angle(own.radius)
            )
            theta = turn + k * one.pitch_angle + side * twist[0] * height + psi  # in the sense in which the flank faces
            x, y = centre - radius * np.cos(theta), radius * np.sin(theta)
            rho = np.hypot(x, y)
            inside = (rho <= two.tip_radius) & (x > 0.0)
            if inside.any():
                partner = (-tooth + (side < 0)) % two.teeth
                excess = mate.half_angle[partner, side.index, row] - two.half_angle(mate.radius)
                w = two.half_angle(rho[inside]) + np.interp(rho[inside], mate.radius, excess)
                mid_face = np.arctan2(y, x)[inside] + w + side * twist[1] * height
                best = max(best, float(mid_face.max()) - np.pi / two.teeth - (turn + k * one.pitch_angle) * one.teeth / two.teeth)
    return best * two.base_radius


@pytest.mark.parametrize("side", [pytest.param(Side.LEFT, marks=pytest.mark.long), Side.RIGHT])
def test_worn_flanks_touch_where_dense_points_in_space_do(side):
    pinion, gear = pair(width=(9.0, 9.0))
    z = np.linspace(0.0, 9.0, 19)
    random = np.random.default_rng(5)
    profiles = []
    for one in (pinion, gear):
        amplitude = random.uniform(0.0, 0.03, (one.teeth, 2, 1, 1))
        across, along = np.linspace(-1.0, 1.0, 19)[:, None], np.linspace(-1.0, 1.0, 120)
        shape = amplitude * (across**2 + 0.5 * along**2 + 0.3 * across * along)
        nominal = flanks(one, z=z)
        profiles.append(replace(nominal, half_angle=nominal.half_angle - shape / one.base_radius))
    found = mesh_contact(*profiles, STANDARD + 0.05, side, positions_per_pitch=2)
    assert found.peak_to_peak_um > 5.0
    assert len(found.driver_pattern.z) == 19  # the rows given are close enough
    play = backlash(pinion, gear, STANDARD + 0.05).transverse
    for at in (0, 1, 13, 24):
        lead = in_space(*profiles, STANDARD + 0.05, found.rotation[at], side)
        assert found.transmission_error[at] == pytest.approx(lead + 0.5 * play, abs=1e-6)


@pytest.mark.long
def test_there_are_slices_enough():
    """Flanks alike at all heights have no rows of their own; with rows 0.15 mm apart the same comes out within 0.1 µm (flanks 20 µm off)."""
    pinion, gear = pair(width=(9.0, 9.0))
    slope = 0.02 * np.linspace(0.0, 1.0, 120)
    z = np.linspace(0.0, 9.0, 61)
    fine = worn(flanks(pinion, z=z), slope + 1e-12 * z[:, None], range(17))
    few, many = (
        mesh_contact(own, flanks(gear), STANDARD, positions_per_pitch=6, cycle="pitch")
        for own in (worn(flanks(pinion), slope, range(17)), fine)
    )
    assert len(few.driver_pattern.z) < 0.4 * len(many.driver_pattern.z)
    assert many.peak_to_peak_um > 1.0
    np.testing.assert_allclose(few.transmission_error_um, many.transmission_error_um, atol=0.1)


def test_gentle_deviations_agree_with_the_linear_model():
    # Contact moves by R δ' along the flank, which adds R δ'²/2: here δ' = 4 µm / 4 mm, R = 4 mm, so 2e-3 µm.
    pinion, gear = pair(width=(18.0, 18.0))
    z = np.linspace(0.0, 18.0, 37)
    shape = 0.004 * (np.linspace(-1.0, 1.0, 37)[:, None] ** 2 + 0.5 * np.linspace(-1.0, 1.0, 120) ** 2)
    own = worn(flanks(pinion, z=z), shape, range(0, 17, 2))
    rigid, linear = (solve(own, flanks(gear), STANDARD + 0.05, positions_per_pitch=5) for solve in (mesh_contact, linear_contact))
    assert rigid.peak_to_peak_um > 0.3
    np.testing.assert_allclose(rigid.transmission_error, linear.transmission_error, atol=2e-5)
    np.testing.assert_allclose(rigid.backlash, linear.backlash, atol=2e-5)


def test_only_the_common_face_touches():
    # The pinion is 18 mm wide, the gear 10: what is missing outside the middle 10 mm is not noticed, what is missing in it is.
    pinion, gear = pair(width=(18.0, 10.0))
    z = np.linspace(0.0, 18.0, 19)
    outside = np.where(np.abs(z - 9.0) > 5.5, 0.05, 0.0)[:, None]
    found = mesh_contact(worn(flanks(pinion, z=z), outside, range(17)), flanks(gear), STANDARD, positions_per_pitch=3)
    assert np.abs(found.transmission_error_um).max() < 1e-6
    inside = mesh_contact(worn(flanks(pinion, z=z), 0.05 - outside, range(17)), flanks(gear), STANDARD, positions_per_pitch=3)
    assert inside.transmission_error_um.max() < -10.0


def test_the_contact_ratio_is_that_of_path_and_overlap():
    pinion, gear = pair()
    path = path_of_contact(pinion, gear, STANDARD)
    assert path.overlap_ratio == pytest.approx(16.0 * math.sin(BETA) / (math.pi * 2.5), rel=1e-12)  # b sin β / (π m_n)
    assert path.total_contact_ratio == pytest.approx(path.contact_ratio + path.overlap_ratio)
    assert path.alone_pinion is None
    assert set(path.named_points) == {"A", "C", "E"}
    found = mesh_contact(flanks(pinion), flanks(gear), STANDARD, positions_per_pitch=10, tolerances=(1e-6,))
    # The ends of a pair's contact, two of them, lie anywhere between two positions.
    assert found.contact_ratio[0][1] == pytest.approx(path.total_contact_ratio, abs=2 * 0.5 / 10)


def test_published_helical_pair():
    # KHK, helical gears, normal system: m_n 3, 20°, β 30°, z 12 / 60, x 0.09809 / 0: α_t 22.79588°, α_wt 23.1126°, a 125.000.
    def make(name, z, x, sign):
        return Gear.from_spec(GearSpec(name, z, 3.0, 20.0, helix_angle=sign * math.radians(30.0), profile_shift=x))

    pinion, gear = make("pinion", 12, 0.09809, 1), make("gear", 60, 0.0, -1)
    assert math.degrees(pinion.transverse_pressure_angle) == pytest.approx(22.79588, abs=5e-6)
    centre = zero_backlash_centre_distance(pinion, gear)
    assert centre == pytest.approx(125.0, abs=5e-4)
    found = exact_meshing(pinion, gear, 125.0)
    assert math.degrees(found.working_pressure_angle) == pytest.approx(23.1126, abs=5e-5)
    assert 2.0 * found.pitch_radius_pinion == pytest.approx(41.667, abs=5e-4)
    assert 2.0 * found.pitch_radius_gear == pytest.approx(208.333, abs=5e-4)
    assert [2.0 * one.base_radius for one in (pinion, gear)] == pytest.approx([38.322, 191.611], abs=5e-4)
    assert profile_shift_sum(pinion, gear, 125.0) == pytest.approx(0.09809, abs=5e-6)


@pytest.mark.parametrize("kind", ["reference", "operating", "normal"])
def test_a_backlash_asked_for_is_the_one_found(kind):
    pinion, gear = pair()
    centre = centre_distance_for_backlash(pinion, gear, 0.25, kind)
    play = backlash(pinion, gear, centre)
    found = {"reference": play.circumferential_reference, "operating": play.circumferential, "normal": play.normal}[kind]
    assert found == pytest.approx(0.25, abs=1e-12)
    moved = shaft_movement(pinion, gear, STANDARD, 0.0, 0.25, kind)
    assert moved.centre_distance == pytest.approx(centre, abs=1e-10)
    assert moved.movement_linear == pytest.approx(moved.movement, rel=0.05)


def test_backlashes_of_one_pair():
    pinion, gear = pair()
    play = backlash(pinion, gear, STANDARD + 0.2)
    alpha_n = math.radians(20.0)
    assert play.normal == pytest.approx(play.circumferential_reference * math.cos(alpha_n) * math.cos(BETA), rel=1e-12)
    # Shifted along its axis by j_x the pinion has turned, as seen in any section, by what the backlash allows.
    assert play.axial == pytest.approx(play.angular_pinion / (math.tan(BETA) / pinion.reference_radius), rel=1e-12)
    straight = Gear.from_spec(replace(pinion.spec, helix_angle=0.0)), Gear.from_spec(replace(gear.spec, helix_angle=0.0))
    assert backlash(*straight, 60.2).axial is None


def test_where_neighbours_carry_there_is_nothing_to_take_up():
    pinion, gear = pair()
    play = backlash(pinion, gear, STANDARD).normal
    assert take_up_words(take_up(pinion, gear, STANDARD, (play, play), 0.05)).startswith("There is no play to take up")
    assert "closer" in take_up_words(take_up(pinion, gear, STANDARD, (play + 0.05, play + 0.05), 0.05))


def test_recommended_backlash_goes_by_the_normal_module():
    pinion, _ = pair()
    assert recommended_backlash(pinion, 66.0).least_normal == pytest.approx(2 / 3 * (0.06 + 0.033 + 0.075))


def test_two_right_hands_do_not_mesh():
    pinion, gear = pair()
    wrong = Gear.from_spec(replace(gear.spec, helix_angle=BETA))
    with pytest.raises(InputError, match=r"helix angles 25° and 25°"):
        mesh_contact(flanks(pinion), flanks(wrong), STANDARD)


def double_helical(thinning=0.1):
    return tuple(
        Gear.from_spec(replace(one.spec, face_width=width, gap=gap, thinning=thinning))
        for one, width, gap in zip(pair(), (26.0, 24.0), (4.0, 5.0), strict=True)
    )


def test_double_helical_gears_touch_with_both_halves():
    """One gear floats along its axis until both halves carry: what one half has lost counts by half, what both have lost in full."""
    pinion, gear = double_helical()
    z = np.array([0.0, 12.0, 14.0, 26.0])
    lower = np.array([0.01, 0.01, 0.0, 0.0])[:, None]
    play = backlash(pinion, gear, STANDARD).normal
    for depth, lost in ((lower, 0.005), (0.01 - lower, 0.005), (0.01, 0.01)):
        found = mesh_contact(worn(flanks(pinion, z=z), depth, range(17)), flanks(gear), STANDARD, positions_per_pitch=2)
        np.testing.assert_allclose(found.transmission_error_um, -1e3 * lost / math.cos(BETA_B), atol=1e-6)
        np.testing.assert_allclose(found.backlash, play + lost, atol=1e-9)
        assert found.peak_to_peak_um < 1e-6


def test_the_overlap_of_double_helical_gears_is_that_of_a_half():
    pinion, gear = double_helical()
    path = path_of_contact(pinion, gear, STANDARD)
    assert path.overlap_ratio == pytest.approx(9.5 * math.sin(BETA) / (math.pi * 2.5), rel=1e-12)
    found = mesh_contact(flanks(pinion), flanks(gear), STANDARD, positions_per_pitch=10, tolerances=(1e-6,))
    assert found.contact_ratio[0][1] == pytest.approx(path.total_contact_ratio, abs=2 * 0.5 / 10)
    heights = found.driver_pattern.z - 13.0
    assert (np.abs(heights) >= 2.5 - 1e-12).all()
    assert heights[[0, -1]] == pytest.approx([-12.0, 12.0])

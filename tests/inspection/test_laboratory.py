"""Sections, surfaces, waves and rolling with a master, on flanks of which it is known what was put in."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.profiles import nominal_profiles
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.inspection import Settings, inspect
from gearwear.inspection.areal import evaluate_areal
from gearwear.inspection.composite import MASTER_TEETH, POSITIONS, evaluate_composite
from gearwear.inspection.evaluation import evaluate
from gearwear.inspection.ranges import helix_range, profile_range
from gearwear.inspection.sections import take_sections
from gearwear.inspection.traces import FlankSamples, flank_samples, profile_traces
from gearwear.inspection.waviness import wave_spectrum
from gearwear.meshing.contact import mesh_contact
from tests.inspection.synthetic import displaced, flanks

UM = 1e-3
SPEC = GearSpec("pinion", 20, 3.0, 20.0)
NOISE = 2 * UM


@pytest.fixture(scope="module")
def gear():
    return Gear.from_spec(SPEC)


def scattered(gear, shape, noise=NOISE, count=100_000, seed=0):
    """Points anywhere on the flanks with deviation `shape(flank, roll, z)`, mm, and noise."""
    rng = np.random.default_rng(seed)
    flank = rng.integers(0, 2 * gear.teeth, count)
    roll, z = rng.uniform(gear.form_roll, gear.tip_roll, count), rng.uniform(0.0, gear.face_width, count)
    return FlankSamples(gear, flank, roll, z, shape(flank, roll, z) + rng.normal(0.0, noise, count), noise, 0)


def second_order(gear, slope=4.0, lean=5.0, crown=3.0, barrel=2.0, twist=60.0):
    """The surface of these parameters, µm, over the evaluation ranges."""
    profile, helix = profile_range(gear), helix_range(gear)

    def shape(flank, roll, z):
        u, v = (2.0 * (x - r.middle) / r.length for x, r in ((roll, profile), (z, helix)))
        hand = np.where(flank % 2 == 0, 1.0, -1.0)
        return UM * (0.5 * slope * u + 0.5 * hand * lean * v - crown * u**2 - barrel * v**2 + 0.25 * twist * u * v)

    return shape


@pytest.fixture(scope="module")
def twisted(gear):
    """Twisted flanks; the left one of tooth 3 with a pit of 20 µm at mid-face, 1.6 mm along L and 4 mm along z."""
    surface, profile, helix = second_order(gear), profile_range(gear), helix_range(gear)

    def shape(flank, roll, z):
        pit = (flank == 4) & (np.abs(roll - profile.middle) < 0.8) & (np.abs(z - helix.middle) < 2.0)
        return surface(flank, roll, z) - 20 * UM * pit

    return scattered(gear, shape, count=200_000)


def within(estimate, truth, sure=4.0):
    """All values within so many of their standard uncertainties."""
    return np.abs(estimate.value - truth) <= sure * estimate.standard


def test_areal_parameters_are_those_put_in(gear, twisted):
    found = evaluate_areal(twisted, profile_range(gear), helix_range(gear), NOISE)
    truth = {"profile_slope": 4.0, "helix_slope": 5.0, "profile_crowning": 3.0, "helix_crowning": 2.0, "twist": 60.0}
    whole = np.arange(gear.teeth) != 2  # of the pitted flank the pit itself is part
    for name, part in found.flanks.named().items():
        assert within(part.at(whole), truth[name] * UM).all(), name
        assert within(found.mean.named()[name].at(1), truth[name] * UM), name  # right flanks: no pit
        off = (part.value[whole] - truth[name] * UM) / part.standard[whole]
        assert 0.7 < off.std() < 1.3, name  # as uncertain as it says: 38 values


def test_a_pit_that_the_mean_hides_is_the_lowest_place(gear, twisted):
    profile, helix = profile_range(gear), helix_range(gear)
    found = evaluate_areal(twisted, profile, helix, NOISE)
    assert np.unravel_index(np.argmin(found.lowest.value), found.lowest.value.shape) == (2, 0)
    lowest = found.lowest.at(2, 0)
    assert abs(float(lowest.value) + 20 * UM) <= float(lowest.expanded)
    assert (np.abs(found.lowest_at[2, 0] - [profile.middle, helix.middle]) < [0.8, 2.0]).all()
    others = np.delete(found.lowest.value.ravel(), 4)
    # Of sound flanks the lowest place is noise: as large as U in one of twenty.
    assert (np.abs(others) <= np.delete(found.lowest.expanded.ravel(), 4)).mean() > 0.85


def test_sections_are_those_of_their_lines(gear, twisted):
    """Twist makes the slope of each line another one: f_Hα + S (z − middle) / b, and the helix alike."""
    profile, helix = profile_range(gear), helix_range(gear)
    found = take_sections(twisted, profile, helix, profile.middle, NOISE)
    whole = np.arange(gear.teeth) != 2
    hand = np.array(Side, dtype=float)
    for section in found.profiles:
        truth = UM * (4.0 + 60.0 * (section.at - helix.middle) / helix.length)
        assert within(section.evaluation.slope.at(whole), truth).all(), section.place
    for section in found.helices:
        truth = UM * (5.0 + hand * 60.0 * (section.at - profile.middle) / profile.length)
        assert within(section.evaluation.slope.at(whole), truth).all(), section.place
    assert within(found.profile_twist.at(whole), 60 * UM).all()
    assert within(found.helix_twist.at(whole), 60 * UM).all()


@pytest.mark.long
def test_twist_by_two_lines_is_as_unsure_as_by_the_surface(gear):
    """An axis that may be tilted moves the sections near both ends apart: all three twists of a flank are wrong by the same, and say so."""
    profile, helix, tilt, middle = profile_range(gear), helix_range(gear), 3e-4, np.array([0.0, 0.0, 0.5 * gear.face_width])
    turns = np.eye(3)[:2]
    motions = np.hstack([np.cross(middle, turns), turns]) * tilt
    covariance = motions.T @ motions
    plain = scattered(gear, lambda flank, roll, z: np.zeros(len(flank)), noise=1e-6, count=60_000)
    surface = evaluate_areal(plain, profile, helix, 1e-6, covariance=covariance).flanks.twist.standard
    lines = take_sections(plain, profile, helix, profile.middle, 1e-6, covariance=covariance)
    assert surface.min() > UM
    for twist in (lines.profile_twist, lines.helix_twist):
        np.testing.assert_allclose(twist.standard, surface, rtol=0.02)


@pytest.mark.long
def test_a_section_sees_the_pit_on_it(gear, twisted):
    profile, helix = profile_range(gear), helix_range(gear)
    found = take_sections(twisted, profile, helix, profile.middle, NOISE)
    pitted, sound = (found.profiles[1].evaluation.form.value[tooth, 0] for tooth in (2, 3))
    assert (
        found.profiles[1].half_width < 2.0
    )  # all of the strip is pitted, and the filter's cut-off is a third of the pit's length
    assert pitted - sound > 14 * UM
    traces = profile_traces(twisted, (helix.start, helix.end), profile.cutoff / 8, NOISE)
    mean = evaluate(traces, profile).form.value
    assert mean[2, 0] < 7 * UM  # 4 of 18 mm of face


def test_a_ghost_order_is_named_with_its_size_and_phase(gear):
    order, size, phase = 57, 0.6 * UM, 0.9

    def shape(flank, roll, z):
        side = np.where(flank % 2 == 0, 1, -1)
        angle = roll / gear.base_radius - side * 2 * np.pi / gear.teeth * (flank // 2)
        return second_order(gear)(flank, roll, z) + np.where(side > 0, size * np.cos(order * angle + phase), 0.0)

    found = wave_spectrum(scattered(gear, shape), profile_range(gear), helix_range(gear), NOISE)
    (wave,) = found.waves[0]
    assert wave.order == order
    assert found.is_ghost(wave)
    assert abs(wave.amplitude - size) <= 4.0 * wave.standard
    assert abs(wave.phase - phase) <= 4.0 * wave.standard / size
    assert found.waves[1] == ()


@pytest.mark.long
def test_white_noise_has_no_waves(gear):
    """The stated chance of one is 1 % a side: none in eight but once in thirteen such tests; two never."""
    named = 0
    for seed in range(4):
        some = scattered(gear, lambda flank, roll, z: 0.0 * roll, count=20_000, seed=seed)
        named += sum(len(waves) for waves in wave_spectrum(some, profile_range(gear), helix_range(gear), NOISE).waves)
    assert named <= 1


def test_a_wave_on_helical_flanks_runs_on_along_the_face():
    helical = Gear.from_spec(GearSpec("pinion", 20, 3.0, 20.0, helix_angle=math.radians(20.0)))

    def shape(flank, roll, z):
        side = np.where(flank % 2 == 0, 1, -1)
        turned = 2 * np.pi / helical.teeth * (flank // 2) + math.tan(helical.helix_angle) / helical.reference_radius * (z - 10.0)
        return 0.6 * UM * np.cos(83 * (roll / helical.base_radius - side * turned))

    found = wave_spectrum(scattered(helical, shape), profile_range(helical), helix_range(helical), NOISE)
    for waves in found.waves:
        assert [wave.order for wave in waves] == [83]
        assert abs(waves[0].amplitude - 0.6 * UM) <= 4.0 * waves[0].standard


def rolled(gear, deviation, n_z=8, noise=0.0):
    """The composite deviations of exact points with `deviation(points)`, mm normal to the flank."""
    points = flanks(gear, 60, n_z)
    samples = flank_samples(points.with_deviation(deviation(points)), gear)
    profile, helix = profile_range(gear), helix_range(gear)
    traces = profile_traces(samples, (helix.start, helix.end), profile.cutoff / 8, noise)
    return evaluate_composite(gear, evaluate(traces, profile), evaluate_areal(samples, profile, helix, noise))


def test_eccentricity_alone_reads_twice_itself(gear):
    """F_i″ = 2e, and F_i′ = 2e / cos α at the reference circle, for the flank's normal turns with the gear."""
    e, towards = 30 * UM, np.array([math.cos(0.7), math.sin(0.7), 0.0])
    found = rolled(gear, lambda points: e * points.normal @ towards)
    assert float(found.double_total.value) == pytest.approx(2 * e, rel=3e-3)
    assert found.single_total.value == pytest.approx(2 * e / math.cos(math.radians(20.0)), rel=3e-3)
    # Within a pitch the cosine changes by at most 2 e sin(π / z).
    assert float(found.double_tooth.value) == pytest.approx(2 * e * math.sin(math.pi / gear.teeth), rel=1e-2)


@pytest.mark.long
@pytest.mark.parametrize("drawn", [{"profile_crowning": 0.02}, pytest.param({"profile_slope": 0.02}, marks=pytest.mark.long)])
def test_a_master_feels_the_same_part_whatever_its_drawing(drawn):
    """Flanks that are modified on purpose, and flanks that came out so: one part, and one reading."""
    both = FlankModification(**drawn)
    spec = GearSpec("gear", 18, 3.0, 20.0)
    plain, modified = Gear.from_spec(spec), Gear.from_spec(replace(spec, left=both, right=both))
    asked = Settings(noise=1e-4, laboratory=True)
    on_purpose = inspect(flanks(modified, 60, 12), modified, asked).laboratory.composite
    points = flanks(plain, 60, 12)
    made = np.where(points.side > 0, *(modified.drawn(side).offset(points.roll, points.position[:, 2]) for side in Side))
    by_chance = inspect(displaced(points, made, plain), plain, asked).laboratory.composite
    for name in ("single_tooth", "double_total", "double_tooth"):
        there, here = getattr(by_chance, name).value, getattr(on_purpose, name).value
        assert here == pytest.approx(there, abs=5e-4) and np.max(there) > 4e-3  # traces of the other are filtered and binned
    assert on_purpose.double.mean() == pytest.approx(by_chance.double.mean(), abs=5e-4)


@pytest.mark.parametrize("sides", [1, 2])
def test_one_thick_tooth_lifts_the_centre_by_its_thickness(gear, sides):
    """``inv α″ − inv α = Σδ / (2 (r_b1 + r_b2))``: closed form, for δ on one or on both of its flanks."""
    d = 25 * UM
    found = rolled(gear, lambda points: np.where((points.tooth == 4) & (points.side >= (1 if sides == 1 else -1)), d, 0.0))
    base = gear.base_radius * (1 + MASTER_TEETH / gear.teeth)
    alpha = math.acos(base / found.centre_distance)
    lifted = alpha
    for _ in range(50):
        lifted += (math.tan(alpha) - alpha + sides * d / (2 * base) - math.tan(lifted) + lifted) / math.tan(lifted) ** 2
    jump = base / math.cos(lifted) - found.centre_distance
    assert float(found.double_total.value) == pytest.approx(jump, rel=1e-3)
    assert jump == pytest.approx(sides * d / (2 * math.sin(alpha)), rel=1e-2)


@pytest.mark.long
def test_as_rigid_contact_of_the_same_flanks_with_the_master(gear):
    """The program's contact knows no line of action: it seeks the first touch of bodies. Crowned flanks, so that no corner carries; but little,
    for what leaves the line of action gains the square of the slope, (dδ/dL · r_b / L)² ρ / 2: 0.1 µm here."""
    rng = np.random.default_rng(4)
    index, middle = rng.normal(0.0, 0.8 * UM, (gear.teeth, 2)), 0.5 * (gear.form_roll + gear.tip_roll)
    half = 0.5 * (gear.tip_roll - gear.form_roll)

    def delta(tooth, side, roll):
        return index[tooth, np.where(side > 0, 0, 1)] - 8 * UM * ((roll - middle) / half) ** 2

    found = rolled(gear, lambda points: delta(points.tooth, points.side, points.roll))
    master = Gear.from_spec(GearSpec("gear", MASTER_TEETH, 3.0, 20.0))
    radius = np.linspace(gear.form_radius, gear.tip_radius, 400)
    flanked = nominal_profiles(gear, radius, np.array([10.0]))
    tooth, side = np.indices((gear.teeth, 2))
    roll = np.sqrt(radius**2 - gear.base_radius**2)
    flanked.half_angle[:, :, 0] += delta(tooth[..., None], np.where(side == 0, 1, -1)[..., None], roll) / gear.base_radius
    centre = found.centre_distance + 0.02
    mate = nominal_profiles(master, np.linspace(master.form_radius, master.tip_radius, 400), np.array([10.0]))
    run = {one: mesh_contact(flanked, mate, centre, one, positions_per_pitch=POSITIONS) for one in Side}
    arc = math.cos(math.radians(20.0))
    for one in Side:
        assert found.single_total.value[one.index] == pytest.approx(np.ptp(run[one].transmission_error) / arc, abs=0.15 * UM)
    # Less play at a fixed centre is more tight centre distance, by 1 / (2 sin α) of it.
    alpha = math.acos((gear.base_radius + master.base_radius) / centre)
    tight = -run[Side.LEFT].backlash / (2 * math.sin(alpha))
    assert float(found.double_total.value) == pytest.approx(np.ptp(tight), abs=0.3 * UM)


def test_u_holds_the_truth_of_rolling(gear):
    """Eccentricity with noise: F_i″ of the flanks, seen through 5 µm, within its U."""
    rng, e = np.random.default_rng(5), 20 * UM
    towards = np.array([1.0, 0.0, 0.0])
    found = rolled(gear, lambda points: e * points.normal @ towards + rng.normal(0.0, 5 * UM, len(points)), 30, 5 * UM)
    assert abs(float(found.double_total.value) - 2 * e) <= float(found.double_total.expanded)
    assert float(found.double_total.expanded) < 12 * UM

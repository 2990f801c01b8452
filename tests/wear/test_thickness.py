"""Section thickness: closed forms, what was put in asked back, and its standard deviation."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from gearwear.design.gear import Gear
from gearwear.design.modification import FlankModification
from gearwear.design.surface import SurfacePoints, flank_points, locate
from gearwear.wear.section_sums import stations
from gearwear.wear.thickness import SectionThickness
from tests.placing.placing import designed, true_pose
from tests.synthetic import AbrasiveWear, Effect, GearNumbers, Patch, Recipe, SyntheticScan, make_scan
from tests.wear.sections import section_thickness

GEAR = designed()
R, RB = GEAR.reference_radius, GEAR.base_radius
RADII = [36.5, R, 40.0, 43.5]


def inv(angle: float) -> float:
    return math.tan(angle) - angle


def nominal_arc(radius: float, thinning: float = 0.0) -> float:
    """2 r (s / 2 r_ref + inv α − inv α_r), from the drawing."""
    alpha = math.radians(20.0)
    return radius * (
        (math.pi * 6.35 / 2.0 - thinning) / 38.1 + 2.0 * (inv(alpha) - inv(math.acos(38.1 * math.cos(alpha) / radius)))
    )


def even_flanks(left: np.ndarray, right: np.ndarray) -> SurfacePoints:
    """Flanks that stand so far off each, in mm, (12,), seen everywhere and without noise."""
    grid = np.meshgrid(np.arange(12), [1, -1], np.linspace(GEAR.form_roll, GEAR.tip_roll, 150), np.linspace(0.0, 15.0, 120))
    tooth, side, roll, z = (values.ravel() for values in grid)
    off = np.where(side > 0, left[tooth.astype(int)], right[tooth.astype(int)])
    return flank_points(GEAR, tooth.astype(int), side.astype(int), roll, z).with_deviation(off)


@pytest.mark.parametrize("radius", RADII)
def test_an_offset_of_the_flanks_is_a_turn_at_every_radius(radius):
    """s(r) = nominal + (r / r_b)(δ_left + δ_right): exact, and for any depth."""
    left, right = np.linspace(-1.2, 0.05, 12), np.linspace(0.03, -0.4, 12)
    found = section_thickness(even_flanks(left, right), GEAR, 0.0, radius)
    assert found.nominal == pytest.approx(nominal_arc(radius), abs=1e-12)
    expected = nominal_arc(radius) + radius / RB * (left + right)
    np.testing.assert_allclose(found.arc, np.broadcast_to(expected[:, None], found.arc.shape), rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found.chord, 2.0 * radius * np.sin(0.5 * found.arc / radius), rtol=1e-14)
    np.testing.assert_allclose(found.lost, nominal_arc(radius) - found.arc, rtol=0.0, atol=1e-12)


def test_arc_and_chord_at_the_reference_circle_are_the_references():
    """Reference B6: 9.974557 and 9.946096 mm."""
    found = section_thickness(even_flanks(np.zeros(12), np.zeros(12)), GEAR, 0.0)
    np.testing.assert_allclose(found.arc, 9.974557, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(found.chord, 9.946096, rtol=0.0, atol=1e-6)


def test_sections_are_the_papers():
    np.testing.assert_allclose(stations(12.8), np.arange(65) * 0.2)
    assert len(stations(15.0)) == 76
    np.testing.assert_allclose(stations(1.15), [0.075, 0.275, 0.475, 0.675, 0.875, 1.075])  # the same from either end
    assert stations(15.0)[-1] == pytest.approx(15.0)


def test_a_radius_off_the_involute_is_refused():
    for radius in (35.5, 44.5):
        with pytest.raises(ValueError, match="not on the involute"):
            section_thickness(even_flanks(np.zeros(12), np.zeros(12)), GEAR, 0.0, radius)


NOISE = 10.0
CASES = {
    "as drawn": (Recipe(), 0.0),
    "thinned": (Recipe(GearNumbers(thinning=0.1)), -0.1),
    "coated": (Recipe(effects=(Effect("coating", {"thickness_um": 20.0}),)), 2.0 * 0.020 * R / RB),
    "too thick": (Recipe(effects=(Effect("tooth_thickness", {"thickness_um": 30.0}),)), 0.030),
    "a worn flank": (Recipe(wear=(AbrasiveWear(80.0, 1),)), -0.080 * R / RB),
}


@cache
def scan_of(name: str, points: int) -> SyntheticScan:
    recipe, _ = CASES[name]
    return make_scan(replace(recipe, pose="none", jitter=1.0, noise_um=NOISE).of_size(points), 1)


def measured(name: str, points: int) -> SectionThickness:
    scan = scan_of(name, points)
    return section_thickness(locate(true_pose(scan).apply(scan.points), GEAR), GEAR, 1e-3 * NOISE)


@pytest.mark.parametrize("name", CASES)
def test_what_was_put_in_comes_back(name):
    found, change = measured(name, 30_000), CASES[name][1]
    own = slice(found.pooled // 2, None, found.pooled)  # sections that share no points
    off = found.arc[:, own] - nominal_arc(R) - change
    # All of them together: the mean within four of its standard deviations, 1.5 µm or less.
    assert abs(off.mean()) < 4.0 * math.sqrt((found.std[:, own] ** 2).mean() / off.size) < 0.0025


@pytest.mark.parametrize("points", [6_000, 30_000, 200_000])
def test_sections_scatter_as_they_say(points):
    """Sum of squares of errors in standard deviations, over sections that share no points, two-sided at 1 in 1,000."""
    found = measured("as drawn", points)
    own = slice(found.pooled // 2, None, found.pooled)
    pulls = ((found.arc - nominal_arc(R)) / found.std)[:, own]
    pulls = pulls[np.isfinite(pulls)]
    assert len(pulls) >= 30
    low, high = chi2.ppf([0.0005, 0.9995], len(pulls))
    assert low < (pulls**2).sum() < high


@pytest.mark.parametrize("points", [30_000, 200_000])
def test_points_that_scatter_more_on_flanks_say_how_sections_scatter(points):
    """10 µm on these flanks, 7 over all that was scanned: errors in standard deviations at 1 in 2,000; of 7 µm they are twice as much."""
    scan = scan_of("as drawn", points)
    located = locate(true_pose(scan).apply(scan.points), GEAR)
    found = section_thickness(located, GEAR, 0.7e-3 * NOISE)
    assert found.noise == pytest.approx(1e-3 * NOISE, rel=0.1)
    own = slice(found.pooled // 2, None, found.pooled)
    off = ((found.arc - nominal_arc(R)) / found.std)[:, own]
    off = off[np.isfinite(off)]
    assert off @ off < 1.2**2 * chi2.ppf(0.9995, len(off))  # the noise is known to a tenth
    assert section_thickness(located, GEAR, 1e-3 * NOISE).noise == 1e-3 * NOISE


def test_pits_on_some_teeth_are_no_noise_of_the_sections():
    random, points = np.random.default_rng(3), 150_000
    tooth, side = random.integers(0, 12, points), random.choice([1, -1], points)
    roll, z = random.uniform(GEAR.form_roll, GEAR.tip_roll, points), random.uniform(0.0, 15.0, points)
    off = 0.005 * random.normal(size=points) - 0.06 * ((tooth < 8) & (side > 0) & (np.hypot(roll - REACH, z % 1.5 - 0.75) < 0.3))
    found = section_thickness(flank_points(GEAR, tooth, side, roll, z).with_deviation(off), GEAR, 0.005)
    assert found.noise == 0.005


def test_thin_scans_pool_sections_and_dense_ones_do_not():
    pooled = [measured("as drawn", points).pooled for points in (6_000, 30_000, 200_000)]
    assert sorted(pooled, reverse=True) == pooled
    assert pooled[0] > 1 == section_thickness(even_flanks(np.zeros(12), np.zeros(12)), GEAR, 0.0).pooled


@pytest.mark.parametrize("seed", range(4))
def test_the_least_is_not_above_the_mean_nor_the_greatest_loss_below_it(seed):
    """Of teeth all alike, in few sections that overlap: 11 of 192 least ones lay above the mean of their tooth."""
    scan = make_scan(Recipe(jitter=1.0, noise_um=8.0).of_size(12_000), seed)
    teeth = section_thickness(locate(true_pose(scan).apply(scan.points), GEAR), GEAR, 0.008).teeth()
    assert all(tooth.seen for tooth in teeth)
    assert all(tooth.least <= tooth.mean for tooth in teeth)
    assert all(tooth.greatest_loss >= nominal_arc(R) - tooth.mean - 1e-9 for tooth in teeth)


def sampled(rolls: np.ndarray) -> SurfacePoints:
    """A point at each of these rolls in every section of every flank, on the design."""
    grid = np.meshgrid(np.arange(12), [1, -1], rolls, stations(15.0))
    tooth, side, roll, z = (values.ravel() for values in grid)
    return flank_points(GEAR, tooth.astype(int), side.astype(int), roll, z).with_deviation(np.zeros(tooth.size))


REACH = math.sqrt(R**2 - RB**2)
WINDOW = 0.1 * 6.35 * RB / REACH
"""mm of roll that 0.1 modules of arc are."""


@pytest.mark.parametrize("start", [-0.9, 0.1, 0.5])
def test_the_error_of_a_section_is_that_of_the_line_through_its_points(start):
    """(XᵀX)⁻¹ of the straight line at the radius: far greater than 1 / n where all points lie on one side of it."""
    x = WINDOW * np.linspace(start, 0.95, 15)
    line = np.column_stack([np.ones_like(x), x])
    variance = np.linalg.inv(line.T @ line)[0, 0]
    found = section_thickness(sampled(REACH + x), GEAR, 0.004)
    assert found.pooled == 1
    np.testing.assert_allclose(found.std, R / RB * 0.004 * math.sqrt(2.0 * variance), rtol=1e-6)


def test_points_within_a_tenth_of_a_module_of_arc_count_and_others_do_not():
    x = WINDOW * np.concatenate([np.linspace(-0.99, 0.99, 14), [1.01, -1.01, 1.5]])
    assert (section_thickness(sampled(REACH + x), GEAR, 0.0).count == 14).all()


@pytest.mark.parametrize(("points", "pooled"), [(12, 1), (11, 3), (4, 3), (3, 5), (2, 7)])
def test_sections_are_pooled_until_they_hold_twelve_points(points, pooled):
    assert section_thickness(sampled(REACH + WINDOW * np.linspace(-0.5, 0.5, points)), GEAR, 0.0).pooled == pooled


def test_wear_is_found_at_its_height_on_its_tooth():
    """A band across the whole flank between z = 6 and 9, flat for a millimetre, to its depth of 200 µm along the normal."""
    wear = (Patch(4, -1, 200.0, (30.0, 60.0), (5.0, 10.0), 1.0),)
    scan = make_scan(Recipe(pose="none", jitter=1.0, wear=wear, noise_um=NOISE).of_size(200_000), 1)
    found = section_thickness(locate(true_pose(scan).apply(scan.points), GEAR), GEAR, 1e-3 * NOISE)
    teeth = found.teeth()
    worst = max(teeth, key=lambda tooth: tooth.greatest_loss)
    assert worst.tooth == 4
    assert 6.0 <= worst.at_z <= 9.0
    (truth,) = scan.truth.flanks
    assert truth.thickness_loss_mm == pytest.approx(0.2 * R / RB)
    # The greatest of some fifteen running means of five sections on the flat: not more than three of their standard deviations above.
    assert -1.0 < (worst.greatest_loss - truth.thickness_loss_mm) / (worst.std / math.sqrt(5.0)) < 4.0
    assert worst.least == pytest.approx(nominal_arc(R) - worst.greatest_loss)
    outside = (found.z < 4.9) | (found.z > 10.1)
    assert np.abs(found.lost[4, outside] / found.std[4, outside]).max() < 4.5
    # On the others nothing; at the ends of the face the five sections are three, one of them half.
    assert max(tooth.greatest_loss for tooth in teeth if tooth.tooth != 4) < 4.5 * worst.std / math.sqrt(2.5)


@pytest.mark.parametrize("points", [20_000, 150_000])
def test_ends_that_are_relieved_as_drawn_are_in_the_least(points):
    """Pooled sections end in the middle of the last of them; what the drawing takes off beyond is known: at the ends twice the relief, as an arc."""
    relief = FlankModification(end_relief=0.04, end_relief_length=1.5, end_relief_form="parabolic")
    gear = Gear.from_spec(replace(GEAR.spec, left=relief, right=relief))
    random = np.random.default_rng(1)
    tooth, side = random.integers(0, 12, points), random.choice([1, -1], points)
    roll, z = random.uniform(gear.form_roll, gear.tip_roll, points), random.uniform(0.0, 15.0, points)
    off = 0.005 * random.normal(size=points)
    found = section_thickness(flank_points(gear, tooth, side, roll, z).with_deviation(off), gear, 0.005)
    least = np.array([one.least for one in found.teeth()])
    std = np.array([one.least_std for one in found.teeth()])
    assert np.all(np.abs(least - (nominal_arc(R) - 2.0 * 0.04 * R / RB)) < 4.0 * std)
    assert np.median(std) < 0.01


def tapering(points: int, taper: float, rounding: float = 0.0) -> SectionThickness:
    """Of flanks that all fall by so much towards the low end of the face, mm, and that are rounded off there within a millimetre."""
    random = np.random.default_rng(2)
    tooth, side = random.integers(0, 12, points), random.choice([1, -1], points)
    roll, z = random.uniform(GEAR.form_roll, GEAR.tip_roll, points), random.uniform(0.0, 15.0, points)
    off = taper * (z / 15.0 - 0.5) - rounding * np.maximum(1.0 - z, 0.0) ** 2 + 0.005 * random.normal(size=points)
    return section_thickness(flank_points(GEAR, tooth, side, roll, z).with_deviation(off), GEAR, 0.005)


def test_teeth_that_taper_are_seen_up_to_their_thin_end():
    """A draft of 0.6°, as of moulded teeth, is no rounded edge; what is rounded off such a tooth is one."""
    taper = 0.16
    found, rounded = tapering(150_000, taper), tapering(150_000, taper, 0.3)
    truth = nominal_arc(R) + 2.0 * R / RB * taper * (found.z / 15.0 - 0.5)
    assert (np.isfinite(found.arc).mean(axis=0) > 0.7).all()  # a half section may have fewer than three points
    # The outermost sections are half: their points lie a quarter of a step further in.
    assert np.nanmax(np.abs((found.arc - truth) / found.std)) < 4.5 + 0.05 * 2.0 * taper * R / RB / 15.0 / np.nanmin(found.std)
    seen = np.isfinite(rounded.arc).mean(axis=0)
    assert not seen[:2].any() and (seen[6:] > 0.7).all()


def test_pooled_arcs_of_teeth_that_are_known_to_taper_are_those_of_their_heights():
    """At an end the window is half, and its mean that of a place further in: told as the place itself it was 16 µm too thick."""
    taper = 0.16
    found = tapering(6_000, taper)
    made = np.broadcast_to(2.0 * R / RB * taper * (found.z / 15.0 - 0.5), found.arc.shape)
    known = found.made_with(made)
    assert found.pooled > 3
    off, std = np.nanmean(known.arc - nominal_arc(R) - made, axis=0), np.sqrt(np.nanmean(found.std**2, axis=0) / 12.0)
    assert np.abs(off[[0, -1]] / std[[0, -1]]).max() < 4.0
    assert abs(np.nanmean(found.arc - nominal_arc(R) - made, axis=0)[0]) > 8.0 * std[0]
    inside = slice(found.pooled // 2, -(found.pooled // 2))
    np.testing.assert_allclose(known.arc[:, inside], found.arc[:, inside], rtol=0.0, atol=1e-12)  # the windows are whole there
    worn = known.thinnest()
    assert worn is not None and worn.low <= nominal_arc(R) - R / RB * taper <= worn.high


def test_a_tooth_seen_from_one_side_has_no_thickness():
    flanks = even_flanks(np.zeros(12), np.zeros(12))
    found = section_thickness(flanks.take((flanks.tooth != 3) | (flanks.side > 0)), GEAR, 0.005)
    assert [tooth.tooth for tooth in found.teeth() if not tooth.seen] == [3]
    assert np.isnan(found.arc[3]).all()
    assert np.isfinite(np.delete(found.arc, 3, axis=0)).all()


@pytest.mark.parametrize("low_end", [True, False])
def test_in_a_thin_scan_the_end_of_a_tooth_that_leans_is_its_least(low_end):
    """Each flank of tooth 4 falls by 60 µm over the face; sections are pooled, and the mean of the last ones is half of their height off the end."""
    random = np.random.default_rng(4)
    number = 9000
    tooth, side = random.integers(0, 12, number), random.choice([-1, 1], number)
    roll, z = REACH + random.uniform(-1.0, 1.0, number), random.uniform(0.0, 15.0, number)
    points = flank_points(GEAR, tooth, side, roll, z)
    fall = -0.06 * (1.0 - z / 15.0 if low_end else z / 15.0) * (tooth == 4)
    found = section_thickness(points.with_deviation(fall + 0.001 * random.standard_normal(number)), GEAR, 0.001)
    assert found.pooled > 1
    worn, tooth_4 = found.thinnest(), found.teeth()[4]
    least = nominal_arc(GEAR.reference_radius) - 0.12 * GEAR.reference_radius / GEAR.base_radius
    assert worn.tooth == 4
    for value, std in ((worn.value, worn.std), (tooth_4.least, tooth_4.least_std)):
        assert abs(value - least) < 2.0 * std
        assert std < 0.01


@pytest.mark.parametrize(("count", "said"), [(2, False), (3, True)])
def test_two_points_on_a_side_say_no_thickness(count, said):
    """They may be two strays, and their scatter says nothing; a third can contradict."""
    points = even_flanks(np.zeros(12), np.zeros(12))
    its = (points.tooth == 4) & (points.side > 0)
    near = its & (np.abs(points.roll - GEAR.reference_roll) < 0.2) & (np.abs(points.position[:, 2] - 7.5) < 0.2)
    kept = np.flatnonzero(near)[:count]
    found = section_thickness(points.take(~its | np.isin(np.arange(len(points)), kept)), GEAR, 0.0)
    assert len(kept) == count
    assert np.isfinite(found.arc[4]).any() == said


def of_arcs(arc, made, std):
    """As measured at a radius of 40 mm in sections 0.2 mm apart, each known to `std` mm."""
    teeth, n = arc.shape
    flank, count = np.zeros((teeth, 2, n)), np.full((teeth, 2, n), 20.0)
    return SectionThickness(40.0, 0.2 * np.arange(n), 6.5, arc, flank, count, np.full(arc.shape, std), std, made)


@pytest.mark.long
def test_the_greatest_loss_of_unworn_teeth_is_none_though_some_tooth_always_seems_thin():
    """Of 21 teeth, each of 30 sections, the one with the greatest loss is two standard deviations of a section's mean thin by chance."""
    rng, std, made = np.random.default_rng(8), 0.004, np.full((21, 30), 6.5) + 0.01 * np.arange(21)[:, None]
    most, worst = [], []
    for _ in range(40):
        arc = made + std * rng.normal(size=made.shape)
        found = of_arcs(arc, made, std)
        most.append(found.most_lost())
        worst.append(max(tooth.greatest_loss for tooth in found.teeth()))
    assert np.mean(worst) > 2.0 * std / np.sqrt(5.0)
    pulls = np.array([one.value / one.std for one in most])
    assert abs(pulls.mean()) < 0.7 and (np.abs(pulls) < 2.0).mean() > 0.9


def test_the_greatest_loss_is_that_of_the_worn_tooth():
    made = np.full((21, 30), 6.5)
    arc = made + 0.002 * np.random.default_rng(9).normal(size=made.shape)
    arc[7, 10:20] -= 0.05
    found = of_arcs(arc, made, 0.002)
    most = found.most_lost()
    assert most.tooth == 7 and most.value == pytest.approx(0.05, abs=0.004) and 2.0 < most.at_z < 4.0
    # Drawn 30 µm thicker than they were made, it is below the drawing by that more, and known as well as what is left of it.
    below = replace(found, drawn=made + 0.03, made_std=np.full(21, 0.02)).below_drawing()
    assert (below.tooth, below.value, below.std) == (7, pytest.approx(most.value + 0.03, abs=1e-9), pytest.approx(most.std))
    # Made as drawn, the loss is the same, and what of it is not known of the making no matter.
    below, lost = (
        getattr(replace(found, drawn=made.copy(), made_std=np.full(21, 0.02)), of)() for of in ("below_drawing", "most_lost")
    )
    assert (below.value, below.std) == (most.value, most.std) and lost.std == pytest.approx(np.hypot(most.std, 0.02))


def test_the_nominal_is_as_drawn():
    """A slope of 40 µm along the profile makes an unworn tooth as thick as is nominal at mid-face."""
    sloped = FlankModification(profile_slope=0.04, helix_crowning=0.02)
    gear = Gear.from_spec(replace(GEAR.spec, left=sloped, right=sloped))
    grid = np.meshgrid(np.arange(12), [1, -1], np.linspace(gear.form_roll, gear.tip_roll, 60), np.linspace(0.0, 15.0, 41))
    tooth, side, roll, z = (values.ravel() for values in grid)
    points = flank_points(gear, tooth.astype(int), side.astype(int), roll, z)
    found = section_thickness(points, gear, 0.0)
    middle = np.argmin(np.abs(found.z - 7.5))
    np.testing.assert_allclose(found.arc[:, middle], found.nominal, rtol=0.0, atol=1e-5)
    u = 2.0 * (gear.reference_roll - gear.form_roll) / (gear.tip_roll - gear.form_roll) - 1.0
    assert found.nominal == pytest.approx(nominal_arc(R) + 0.04 * u * R / RB, abs=1e-9)


@pytest.mark.parametrize("points", [6_000, 30_000])
def test_what_else_made_the_teeth_so_widens_the_interval_by_as_much(points):
    """A coat of 20 µm of arc that may be none, and a scale of 30 µm that may be one: by these, and the value stays."""
    known = measured("a worn flank", points)
    plain, told = known.thinnest(), replace(known, otherwise=(-0.020, 0.030)).thinnest()
    assert (told.value, told.std, told.tooth) == (plain.value, plain.std, plain.tooth)
    assert told.low == pytest.approx(plain.low - 0.020, abs=1e-12)
    assert told.high == pytest.approx(plain.high + 0.030, abs=1e-12)

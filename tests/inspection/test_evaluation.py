"""In the manner of PTB's software test: traces of known slope, form and crown are put in and asked back."""

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points, locate
from gearwear.inspection.evaluation import evaluate, pressure_angle_deviation
from gearwear.inspection.filtering import gauss_filter
from gearwear.inspection.ranges import Range, helix_range, profile_range
from gearwear.inspection.tolerances import Edition
from gearwear.inspection.traces import flank_samples, helix_traces, profile_traces
from tests.inspection.synthetic import displaced, flanks, hand_traces

WHERE = Range(2.0, 22.0, 23.0, 0.8)
STATION = np.linspace(0.0, 24.0, 241)
T = (STATION - 12.0) / 20.0


def one_trace(deviation, error=1e-4, along="roll", where=WHERE):
    return evaluate(hand_traces(STATION, np.asarray(deviation)[None, None], np.array(error), along), where)


@pytest.mark.parametrize("wavelength", [0.2, 0.4, 0.8, 1.2, 3.0])
def test_filter_passes_the_closed_form_of_iso_16610_21(wavelength):
    cutoff = 0.8
    x = np.arange(0.0, 16.0, 0.02)
    inside = x[300:500]
    wave = np.exp(2j * np.pi * x / wavelength)
    passed = gauss_filter(inside, x, np.ones_like(x), cutoff) @ wave
    alpha = math.sqrt(math.log(2.0) / math.pi)
    expected = math.exp(-math.pi * (alpha * cutoff / wavelength) ** 2)
    np.testing.assert_allclose(passed, expected * np.exp(2j * np.pi * inside / wavelength), atol=1e-9)
    if wavelength == cutoff:
        assert expected == pytest.approx(0.5, abs=1e-12)


def test_filter_leaves_a_line_alone_at_ends_and_gaps():
    rng = np.random.default_rng(3)
    x = np.sort(rng.uniform(0.0, 20.0, 300))
    x = x[(x < 8.0) | (x > 9.5)]
    out = np.linspace(0.0, 20.0, 101)
    weight = rng.uniform(0.1, 50.0, len(x))
    np.testing.assert_allclose(gauss_filter(out, x, weight, 0.7) @ (3.0 - 0.2 * x), 3.0 - 0.2 * out, atol=1e-9)


@pytest.mark.parametrize("slope", [-0.035, 0.0, 0.008])
@pytest.mark.parametrize("crown", [0.0, 0.006, -0.4])
def test_slope_and_crown_come_back(slope, crown):
    found = one_trace(0.7 + slope * T - crown * (2.0 * T) ** 2)
    assert found.slope.value[0, 0] == pytest.approx(slope, abs=1e-9)
    assert found.line[0, 0, 1] == pytest.approx(slope, abs=1e-9)
    # the filter lowers a parabola evenly and does not change its height, but for its ends
    assert found.crowning.value[0, 0] == pytest.approx(crown, abs=1e-6 + 1e-3 * abs(crown))


def test_form_of_a_line_is_nothing_and_its_total_is_the_rise():
    found = one_trace(0.01 * T, where=Range(2.0, 22.0, 22.0, 0.8))
    assert found.form.value[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert found.total.value[0, 0] == pytest.approx(0.01, abs=1e-12)


def test_form_of_a_wave_is_its_filtered_height():
    where = Range(2.0, 22.0, 22.0, 0.8)
    wavelength = 20.0 / 6.0
    passed = math.exp(-math.log(2.0) * (0.8 / wavelength) ** 2)
    found = one_trace(0.004 * np.cos(2.0 * np.pi * 6.0 * T), where=where)
    # 24 stations a wave at least: the highest is missed by 1 − cos(π/24) at most
    assert found.form.value[0, 0] == pytest.approx(0.008 * passed, rel=1.0 - math.cos(math.pi / 16.0))
    assert found.slope.value[0, 0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("bump", "counts"), [(+0.01, True), (-0.01, False)])
def test_beyond_the_range_only_too_much_material_counts(bump, counts):
    deviation = np.where(STATION > 22.4, bump, 0.0)
    found = one_trace(deviation)
    assert found.form.value[0, 0] == pytest.approx(0.01 if counts else 0.0, abs=1e-3)
    assert found.total.value[0, 0] == pytest.approx(0.01 if counts else 0.0, abs=1e-3)


def test_form_and_total_scale_and_do_not_see_an_offset():
    rng = np.random.default_rng(5)
    shape = np.convolve(rng.normal(size=len(STATION)), np.ones(30) / 30, "same") * 0.01
    once, thrice = one_trace(shape), one_trace(3.0 * shape + 5.0)
    for part in ("slope", "form", "total", "crowning"):
        assert getattr(thrice, part).value[0, 0] == pytest.approx(3.0 * getattr(once, part).value[0, 0], abs=1e-9)
    assert once.total.value[0, 0] <= abs(once.slope.value[0, 0]) + once.form.value[0, 0] + 1e-12


def test_a_gap_stays_a_gap_and_a_large_one_ends_the_evaluation():
    traces = hand_traces(STATION, (0.01 * T)[None, None].repeat(3, 0), np.array(1e-4))
    for tooth, (low, high) in enumerate(((9.0, 9.3), (9.0, 11.0), (9.0, 15.0))):
        out = np.abs(STATION - 0.5 * (low + high)) < 0.5 * (high - low)
        traces.count[tooth, 0, out] = 0
        for part in (traces.station, traces.deviation, traces.standard_error):
            part[tooth, 0, out] = np.nan
    found = evaluate(traces, WHERE)
    in_gap = [np.isnan(found.filtered[k, 0, (found.station > 9.05) & (found.station < 9.3)]) for k in range(3)]
    assert not in_gap[0].any()  # narrower than the cut-off
    assert in_gap[1].all()
    assert in_gap[2].all()
    np.testing.assert_allclose(found.slope.value[:2, 0], 0.01, atol=1e-9)
    assert np.isnan(found.slope.value[2, 0])
    assert np.isnan(found.form.value[2, 0])
    np.testing.assert_allclose(found.share[:, 0], [1.0, 0.9, 0.7], atol=0.02)


def test_ranges_of_the_reference(pinion):
    new, old = profile_range(pinion), profile_range(pinion, Edition.ISO_1995)
    assert (round(new.length, 2), round(old.length, 2)) == (22.12, 21.42)
    assert new.start == pytest.approx(3.05745, abs=5e-6)
    assert round(new.cutoff, 3) == 0.737
    assert profile_range(pinion, start=20.0).cutoff == 0.25
    helix = helix_range(pinion)
    assert (helix.start, helix.end, helix.outer) == pytest.approx((0.75, 14.25, 14.25))


def test_end_chamfers_are_no_face():
    gear = Gear.from_spec(GearSpec("gear", 24, 2.0, 100.0, end_chamfer=1.0))
    where = helix_range(gear)
    assert (where.start, where.end) == pytest.approx((3.0, 97.0))  # chamfer 1, then one module, less than 5 % of 98


@pytest.mark.parametrize("side", [1, -1])
def test_profile_slope_from_points(pinion, side):
    points = flanks(pinion)
    where = profile_range(pinion)
    rise = np.where(points.side == side, 0.02, -0.01) * (points.roll - where.middle) / where.length
    traces = profile_traces(flank_samples(displaced(points, rise, pinion), pinion), (0.75, 14.25), 0.1)
    found = evaluate(traces, where)
    np.testing.assert_allclose(found.slope.value[:, 0 if side == 1 else 1], 0.02, atol=2e-8)
    np.testing.assert_allclose(found.slope.value[:, 1 if side == 1 else 0], -0.01, atol=2e-8)


def test_helix_slope_is_a_screw_and_taper_has_two_signs(pinion):
    points = flanks(pinion)
    zeta = points.position[:, 2] / pinion.face_width - 0.5
    where = helix_range(pinion)
    share = where.length / pinion.face_width
    screw = displaced(points, 0.03 * points.side * zeta, pinion)
    taper = displaced(points, 0.03 * zeta, pinion)
    found = [evaluate(helix_traces(flank_samples(p, pinion), (5.0, 24.0), 0.1), where) for p in (screw, taper)]
    np.testing.assert_allclose(found[0].slope.value, 0.03 * share, atol=2e-8)
    np.testing.assert_allclose(found[1].slope.value, 0.03 * share * np.array([[1.0, -1.0]] * 12), atol=2e-8)


def test_right_hand_is_positive(pinion):
    """A part really screwed right-handed: turned counter-clockwise more and more with rising z."""
    points = flanks(pinion)
    x, y, z = points.position.T
    turn = 1e-4 * z / pinion.face_width
    screwed = np.column_stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, z])
    samples = flank_samples(locate(screwed, pinion, workers=1), pinion)
    where = helix_range(pinion)
    found = evaluate(helix_traces(samples, (5.0, 24.0), 0.1), where)
    np.testing.assert_allclose(found.slope.value, 1e-4 * pinion.base_radius * where.length / 15.0, rtol=1e-3)


def test_pressure_angle_from_a_gear_cut_with_another(pinion):
    wrong = math.radians(0.1)
    cut = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, math.radians(20.0) + wrong, rack_tip_radius=0.25))
    points = flanks(cut)
    seen = (points.roll > 3.6) & (points.roll < 26.0)
    located = locate(points.position[seen], pinion, workers=1)
    where = profile_range(pinion, start=3.5)
    found = evaluate(profile_traces(flank_samples(located, pinion), (0.75, 14.25), 0.1), where)
    angle = pressure_angle_deviation(found, pinion)
    np.testing.assert_allclose(angle.value, wrong, rtol=0.01)
    # the reference: 0.1° makes 14.8 µm over 23.28 mm
    np.testing.assert_allclose(-1e3 * found.slope.value * 23.28 / where.length, 14.8, atol=0.15)


def test_the_filter_leaves_of_white_noise_what_its_weights_say():
    """∫ s² dx = 1 / (√2 α λ): of bins d apart, each unsure by σ, σ √(d / (√2 α λ)) is left."""
    alpha, step = math.sqrt(math.log(2.0) / math.pi), STATION[1] - STATION[0]
    found = one_trace(np.zeros_like(STATION), error=2e-3)
    middle = np.abs(found.station - WHERE.middle) < 5.0
    expected = 2e-3 * math.sqrt(step / (math.sqrt(2.0) * alpha * WHERE.cutoff))
    np.testing.assert_allclose(found.standard[0, 0, middle], expected, rtol=1e-3)


def test_scan_noise_on_known_slopes_is_within_the_claimed_uncertainty():
    rng = np.random.default_rng(11)
    n, error = 100, rng.uniform(5e-4, 3e-3, len(STATION))
    noisy = 0.004 * T + error * rng.normal(size=(n, 2, len(STATION)))
    found = evaluate(hand_traces(STATION, noisy, error), WHERE)
    for part, truth in ((found.slope, 0.004), (found.crowning, 0.0)):
        pulls = ((part.value - truth) / part.standard).ravel()
        assert abs(pulls.mean()) < 4.0 / math.sqrt(pulls.size)
        assert abs(pulls.std() - 1.0) < 4.0 / math.sqrt(2.0 * pulls.size)


@pytest.mark.long
@pytest.mark.parametrize("height", [0.0, 0.002, 0.02])
@pytest.mark.parametrize("shape", ["line", "wave", "step"])
def test_expanded_uncertainty_of_a_width_covers_its_noise(height, shape):
    """At least 95 % of noisy traces have the true form and total within U; the noise term is what a perfect trace reads."""
    clean = {"line": T, "wave": 0.5 * np.cos(6.0 * np.pi * T), "step": (T > 0.2).astype(float)}[shape] * height
    rng = np.random.default_rng(12)
    truth = one_trace(clean)
    noisy = clean + 1e-3 * rng.normal(size=(60, 2, len(STATION)))
    found = evaluate(hand_traces(STATION, noisy, np.array(1e-3)), WHERE)
    for part in ("form", "total"):
        estimate, true = getattr(found, part), getattr(truth, part).value[0, 0]
        covered = np.abs(estimate.value - true) <= estimate.expanded
        assert covered.mean() >= 0.95 - 2.0 * math.sqrt(0.05 * 0.95 / covered.size)
        if height == 0.0:
            np.testing.assert_allclose(estimate.noise.mean(), estimate.value.mean(), rtol=0.1)


def test_one_trace_at_a_height(pinion):
    points = flanks(pinion, 150, 60)
    twist = 0.02 * (points.position[:, 2] - 7.5) / 7.5 * (points.roll - 14.0) / 11.0
    samples = flank_samples(displaced(points, twist, pinion), pinion)
    where = profile_range(pinion)
    for z in (2.0, 7.5, 13.0):
        found = evaluate(profile_traces(samples, (z - 0.25, z + 0.25), 0.2), where)
        expected = 0.02 * (z - 7.5) / 7.5 * where.length / 11.0
        # points lie up to 0.25 mm from z: 0.02/7.5 × 0.25 × 2 at most, and the mean over about 200 of them
        np.testing.assert_allclose(found.slope.value, expected, atol=0.02 / 7.5 * 0.5)


def test_trace_bins_hold_the_means_of_their_points(pinion):
    rng = np.random.default_rng(8)
    n = 5000
    points = flank_points(pinion, np.full(n, 3), np.full(n, -1), rng.uniform(4.0, 26.0, n), rng.uniform(0.0, 15.0, n))
    points = points.with_deviation(rng.normal(0.0, 0.01, n))
    traces = profile_traces(flank_samples(points, pinion), (5.0, 10.0), 0.5)
    k = 20
    low, high = traces.centre[k] - 0.5 * traces.step, traces.centre[k] + 0.5 * traces.step
    mine = (points.roll >= low) & (points.roll < high) & (points.position[:, 2] >= 5.0) & (points.position[:, 2] <= 10.0)
    assert traces.count[3, 1, k] == mine.sum()
    assert traces.deviation[3, 1, k] == pytest.approx(points.deviation[mine].mean(), abs=1e-15)
    assert traces.standard_error[3, 1, k] == pytest.approx(0.01 / math.sqrt(mine.sum()), rel=0.25)
    assert np.isnan(traces.deviation[2]).all()
    assert traces.count[2].sum() == 0


def test_a_place_with_far_fewer_points_than_the_rest_is_a_gap():
    traces = hand_traces(STATION, (0.01 * T)[None, None], np.array(1e-4))
    traces.count[:] = 60
    few = STATION < 4.0
    traces.count[..., few] = 3
    found = evaluate(traces, WHERE)
    thin = found.station < 3.5
    assert np.isnan(found.filtered[0, 0, thin]).all()
    assert np.isfinite(found.filtered[0, 0, (found.station > 4.5) & (found.station < 23.0)]).all()
    assert found.slope.value[0, 0] == pytest.approx(0.01, abs=1e-9)

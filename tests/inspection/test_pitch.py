"""Pitch, index, runout: known errors and a gear really mounted off its axis."""

import math

import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.inspection import inspect
from gearwear.inspection.dimensions import over_pins
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.pitch import flank_positions, measuring_roll, pitch_deviations, runout
from gearwear.inspection.ranges import profile_range
from gearwear.inspection.tolerances import Edition
from tests.inspection.synthetic import displaced, flanks


def exact(value):
    return Estimate.plain(value, np.zeros_like(value))


def test_index_put_in_comes_back(pinion):
    index = np.random.default_rng(1).normal(0.0, 0.02, 12)
    index -= index.mean()
    points = flanks(pinion, 80, 12)
    turned = points.position.copy()
    angle = (index / pinion.reference_radius)[points.tooth]  # arc at the reference circle, + counter-clockwise
    x, y = points.position[:, 0], points.position[:, 1]
    turned[:, 0], turned[:, 1] = np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
    found = inspect(locate(turned, pinion, workers=1), pinion)
    pitch = found.pitch
    single = index - np.roll(index, 1)
    for side in (0, 1):
        np.testing.assert_allclose(pitch.index.value[:, side], index, atol=1e-9)
        np.testing.assert_allclose(pitch.single.value[:, side], single, atol=1e-9)
        assert pitch.cumulative.value[side] == pytest.approx(np.ptp(index), abs=1e-9)
        assert pitch.single_greatest.value[side] == pytest.approx(np.abs(single).max(), abs=1e-9)
        assert pitch.adjacent.value[side] == pytest.approx(np.abs(np.diff(np.append(single, single[0]))).max(), abs=1e-9)
        three = np.stack([index, np.roll(index, 1), np.roll(index, 2)])  # two pitches lie between three teeth
        assert pitch.sector_greatest.value[side] == pytest.approx(np.ptp(three, axis=0).max(), abs=1e-9)
        assert pitch.single.value[:, side].sum() == pytest.approx(0.0, abs=1e-12)
    # turned as a whole, no tooth changes its thickness
    np.testing.assert_allclose(found.dimensions.thickness.value, pinion.tooth_thickness, atol=1e-9)


def test_a_pitch_too_long_is_positive_on_both_sides(pinion):
    """Tooth 5 and all after it, up to the last, moved on by 10 µm: its pitch is long, that of tooth 0 short."""
    shift = np.where(np.arange(12) >= 5, 0.010, 0.0)
    delta = shift[:, None] * np.array([1.0, -1.0]) * math.cos(pinion.transverse_pressure_angle)
    single = pitch_deviations(exact(delta), pinion, 13.0).single.value
    expected = np.zeros(12)
    expected[5], expected[0] = 0.010, -0.010
    np.testing.assert_allclose(single, np.column_stack([expected, expected]), atol=1e-12)


@pytest.mark.parametrize("sector", [1, 2, 3, 6])
def test_sector_deviation_is_the_change_over_k_pitches_or_the_range_within_them(pinion, sector):
    """By the single pitches: 1995 sums k of them, 2013 the most there is among any run of at most k."""
    index = np.random.default_rng(sector).normal(size=12)
    delta = index[:, None] * np.array([1.0, -1.0]) * math.cos(pinion.transverse_pressure_angle)
    for edition, runs in ((Edition.ISO_1995, (sector,)), (Edition.ISO_2013, range(1, sector + 1))):
        found = pitch_deviations(exact(delta), pinion, 13.0, sector, edition=edition)
        single = found.single.value[:, 0]
        sums = [abs(single[[(i + j) % 12 for j in range(run)]].sum()) for i in range(12) for run in runs]
        assert found.sector_greatest.value[0] == pytest.approx(max(sums), abs=1e-12)


def of_eccentricity(gear, e, length):
    """F_r = 2 e, F_p = 2 e / cos α, the greatest f_p = 2 e sin(π/z) / cos α, exact for any z, and the amplitude of f_Hα = 2 e sin(L_α / (2 r_b))."""
    across = 2.0 * e / math.cos(gear.transverse_pressure_angle)
    return 2.0 * e, across, across * math.sin(math.pi / gear.teeth), 2.0 * e * math.sin(length / (2.0 * gear.base_radius))


def test_eccentric_gear_has_the_signature_of_the_closed_forms(pinion, wheel):
    """The points shifted as a whole, towards a space: F_r = 2e, F_p = 2e / cos α, f_p, and the slope that goes with them."""
    e = 0.020
    for gear in (pinion, wheel):
        direction = 2.5 * gear.pitch_angle
        points = flanks(gear, 160, 8)
        shifted = points.position + e * np.array([math.cos(direction), math.sin(direction), 0.0])
        found = inspect(locate(shifted, gear, workers=1), gear)
        where = profile_range(gear)
        runout, cumulative, single, slope = of_eccentricity(gear, e, where.length)
        # with z teeth a maximum can be missed by half a pitch: 1 − cos(π/z)
        missed = 1.0 - math.cos(math.pi / gear.teeth)
        assert found.runout.runout.value == pytest.approx(runout, rel=0.003)
        np.testing.assert_allclose(found.pitch.cumulative.value, cumulative, rtol=1.1 * missed)
        np.testing.assert_allclose(found.pitch.single_greatest.value, single, rtol=1.1 * missed)
        np.testing.assert_allclose(np.abs(found.profile.slope.value).max(axis=0), slope, rtol=1.1 * missed)
        # the runout's first harmonic is the shift itself: the balls sit where the gear went
        np.testing.assert_allclose(
            found.runout.eccentricity.value, e * np.array([math.cos(direction), math.sin(direction)]), atol=0.01 * e
        )


def test_eccentricity_numbers_of_the_reference(pinion):
    values = of_eccentricity(pinion, 0.020, 23.28)
    assert [round(1e3 * v, 1) for v in values] == [40.0, 42.6, 11.0, 12.8]
    assert round(values[-1] / 0.020, 3) == 0.639


def test_ball_positions_in_first_order(pinion):
    """y = (δ_left(k) + δ_right(k + 1)) / (2 sin α_M), + outward."""
    pins = over_pins(pinion)
    delta = np.random.default_rng(4).normal(0.0, 1e-5, (12, 2))
    found = runout(exact(delta), pinion, pins)
    expected = (delta[:, 0] + np.roll(delta[:, 1], -1)) / (2.0 * math.sin(pins.centre_angle))
    np.testing.assert_allclose(found.radial.value, expected, atol=1e-9)
    assert found.runout.value == pytest.approx(np.ptp(expected), abs=1e-9)


def test_a_worn_tooth_does_not_make_an_eccentricity(pinion):
    e, delta = 0.015, np.zeros((12, 2))
    angle = (np.arange(12) + 0.5) * pinion.pitch_angle
    pins = over_pins(pinion)
    delta[:, 0] = 2.0 * math.sin(pins.centre_angle) * e * np.cos(angle)
    delta[3, 0] -= 0.5
    found = runout(Estimate.plain(delta, np.full((12, 2), 1e-6)), pinion, pins)
    np.testing.assert_allclose(found.eccentricity.value, [e, 0.0], atol=2e-5)


def test_a_missing_flank_leaves_its_side_without_totals(pinion):
    delta = np.zeros((12, 2))
    delta[4, 1] = np.nan
    positions = Estimate.plain(delta, np.full((12, 2), 1e-3))
    found = pitch_deviations(positions, pinion, 13.0)
    assert np.isnan(found.cumulative.value[1])
    assert np.isfinite(found.cumulative.value[0])
    np.testing.assert_array_equal(np.isnan(found.single.value[:, 1]), np.isin(np.arange(12), [4, 5]))
    balls = runout(positions, pinion, over_pins(pinion))
    assert np.isnan(balls.runout.value)
    assert np.flatnonzero(np.isnan(balls.radial.value)).tolist() == [3]  # the space before tooth 4
    assert np.isfinite(balls.eccentricity.value).all()


def test_flank_position_is_the_line_at_the_circle_whatever_is_missing(pinion):
    points = flanks(pinion, 200, 10)
    where = measuring_roll(pinion)
    slope = 0.05 * (points.roll - where)
    keep = ~((points.tooth == 0) & (points.roll > where + 0.3))
    located = displaced(points, slope, pinion).take(keep)
    from gearwear.inspection.traces import flank_samples, profile_traces

    positions = flank_positions(profile_traces(flank_samples(located, pinion), (0.0, 15.0), 0.1), where, 1.2)
    np.testing.assert_allclose(positions.value, 0.0, atol=1e-9)
    gone = ~((points.tooth == 0) & (points.roll > where - 0.1))
    located = displaced(points, slope, pinion).take(gone)
    positions = flank_positions(profile_traces(flank_samples(located, pinion), (0.0, 15.0), 0.1), where, 1.2)
    np.testing.assert_array_equal(np.isnan(positions.value), np.arange(12)[:, None] == np.zeros((1, 2)))


def test_uncertainty_of_pitch_is_calibrated(pinion):
    rng = np.random.default_rng(6)
    truth = rng.normal(0.0, 0.01, (12, 2))
    error = rng.uniform(5e-4, 3e-3, (12, 2))
    arc = np.array([1.0, -1.0]) / math.cos(pinion.transverse_pressure_angle)
    single = truth * arc - np.roll(truth * arc, 1, axis=0)
    pulls, covered = [], []
    for _ in range(150):
        found = pitch_deviations(Estimate.plain(truth + error * rng.normal(size=(12, 2)), error), pinion, 13.0)
        pulls.append((found.single.value - single) / found.single.standard)
        covered.append(np.abs(found.cumulative.value - np.ptp(truth * arc, axis=0)) <= found.cumulative.expanded)
    flat = np.array(pulls).ravel()
    assert abs(flat.std() - 1.0) < 4.0 / math.sqrt(2.0 * flat.size)
    assert np.mean(covered) >= 0.95 - 2.0 * math.sqrt(0.05 * 0.95 / 300)


def test_measuring_circle(pinion):
    assert math.hypot(pinion.base_radius, measuring_roll(pinion)) == pytest.approx(38.1)

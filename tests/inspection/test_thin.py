"""Thin scans, a registration that is not sure, and ranges of one's own: what was put in is asked back, and U is true."""

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points, locate
from gearwear.inspection import Settings, inspect
from gearwear.inspection.additive import additive_form, levelled
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.filtering import usual_gap
from gearwear.inspection.pitch import pitch_deviations
from gearwear.inspection.ranges import helix_range, profile_range
from gearwear.inspection.registered import shared_errors
from gearwear.inspection.traces import flank_samples, profile_traces
from tests.inspection.synthetic import flanks

UM = 1e-3
HAND = np.array([1.0, -1.0])


@pytest.fixture(scope="module")
def small():
    """A pinion of a dental drive: module 0.28, 0.84 mm wide."""
    return Gear.from_spec(GearSpec("gear", 13, 0.28, 0.84, profile_shift=0.4, dedendum=1.15))


def scattered(gear, count, seed):
    """So many points on every flank, anywhere on it."""
    rng = np.random.default_rng(seed)
    flank = np.repeat(np.arange(2 * gear.teeth), count)
    roll = rng.uniform(gear.form_roll, gear.tip_roll, len(flank))
    return flank_points(gear, flank // 2, np.where(flank % 2, -1, 1), roll, rng.uniform(0.0, gear.face_width, len(flank)))


@pytest.mark.long
@pytest.mark.parametrize("count", [20, 100, 300])
def test_few_accurate_points_are_a_result_and_u_is_true(small, count):
    """Slopes and pitch of every flank asked back from 20 to 300 points with noise of 0.6 µm; about 95 % lie within U."""
    where, face = profile_range(small), helix_range(small)
    rng = np.random.default_rng(count)
    inside: dict[str, list[bool]] = {"profile": [], "helix": [], "index": []}
    values = 0
    for seed in range(4):
        points = scattered(small, count, seed)
        slope, screw, index = rng.normal(0.0, 5 * UM, (3, small.teeth, 2))
        side = (points.side < 0).astype(int)
        pick = points.tooth, side
        u, v = (points.roll - where.middle) / where.length, (points.position[:, 2] - 0.42) / face.length
        deviation = HAND[side] * (index[pick] + screw[pick] * v) + slope[pick] * u
        found = inspect(
            points.with_deviation(deviation + rng.normal(0.0, 0.6 * UM, len(points))), small, Settings(noise=0.6 * UM)
        )
        at = slope * (found.pitch.roll - where.middle) / where.length
        steps = (index + HAND * at) / math.cos(small.transverse_pressure_angle)
        steps = steps - np.nanmean(np.where(np.isfinite(found.pitch.index.value), steps, np.nan), axis=0)  # of those seen
        # an evaluation that begins higher says so, and its slope is the rise over what is left
        share = found.profile.range.length / where.length
        for name, part, true in (
            ("profile", found.profile.slope, share * slope),
            ("helix", found.helix.slope, screw),
            ("index", found.pitch.index, steps),
        ):
            seen = np.isfinite(part.value)
            values += int(seen.sum())
            inside[name] += list((np.abs(part.value - true) <= part.expanded)[seen])
            assert np.median(part.expanded[seen]) < 3.0 * UM
    assert values >= 0.95 * 3 * 4 * 2 * small.teeth
    for name, held in inside.items():
        assert np.mean(held) >= 0.95 - 2.5 * math.sqrt(0.05 * 0.95 / len(held)), name


def test_profile_slope_does_not_leak_into_a_thin_helix(small):
    """A pressure angle far off and points anywhere across: without the levelling the helix would scatter by the slope's share."""
    where = profile_range(small)
    points = scattered(small, 60, 5)
    found = inspect(points.with_deviation(0.1 * (points.roll - where.middle) / where.length), small, Settings(noise=1e-4))
    np.testing.assert_allclose(found.helix.slope.value, 0.0, atol=1e-6)
    np.testing.assert_allclose(found.profile.slope.value, 0.1 * found.profile.range.length / where.length, atol=1e-6)


def test_levelling_keeps_the_mean_over_the_band(small):
    """What is taken off has no mean over the band: evenly sampled traces stay what they are."""
    points = flanks(small, 40, 40, seed=3)
    z = points.position[:, 2]
    samples = flank_samples(points.with_deviation(0.01 * (z / 0.84) ** 2 + 0.02 * points.roll), small)
    area = (small.form_roll, small.tip_roll), (0.0, 0.84)
    band = (0.2, 0.6)
    level = levelled(samples, additive_form(samples, *area), "roll", band)
    mean = 0.01 / 0.84**2 * (0.6**3 - 0.2**3) / (3.0 * 0.4)
    np.testing.assert_allclose(level.deviation, mean + 0.02 * level.roll, atol=1e-12)


def test_a_wave_common_to_all_flanks_does_not_bend_the_line(small):
    """1.5 waves over the range: the slope is that of the least-squares line through the wave, 12 ∫ u sin(3πu) du = −8 / (3π²)."""
    where = profile_range(small, end=1.34)
    points = flanks(small, 120, 12)
    u = (points.roll - where.middle) / where.length
    found = inspect(
        points.with_deviation(0.003 * np.sin(3.0 * np.pi * u)), small, Settings(profile_end=1.34, profile_cutoff=0.02)
    )
    whole = found.profile.share == 1.0
    assert whole.sum() >= 20
    np.testing.assert_allclose(found.profile.slope.value[whole], -0.003 * 8.0 / (3.0 * np.pi**2), atol=0.02 * UM)


def test_holes_that_chance_and_rows_leave():
    rng = np.random.default_rng(2)
    held = []
    for _ in range(400):
        x = np.sort(rng.uniform(0.0, 1.0, 40))
        held.append(np.diff(x).max() <= usual_gap(x, np.ones(40)))
    assert np.mean(held) >= 0.95
    rows = np.arange(0.0, 1.0, 0.1)
    assert usual_gap(rows, np.full(10, 1000.0)) == pytest.approx(0.3)


def test_registration_errors_are_those_of_a_small_motion(pinion):
    """What moving the points really does to the traces, against the columns."""
    points = flanks(pinion, 40, 8)
    axis = np.array([0.003, -0.002, 0.0, 2e-5, 1e-5, 4e-5])
    moved = locate(points.position + axis[:3] + np.cross(axis[3:], points.position), pinion, workers=1)
    traces = profile_traces(flank_samples(points, pinion), (0.0, 15.0), 0.5)
    after = profile_traces(flank_samples(moved, pinion), (0.0, 15.0), 0.5)
    columns = shared_errors(traces, pinion, np.outer(axis, axis))
    size = np.abs(columns).sum(axis=-1)
    inner = slice(2, -2)
    np.testing.assert_allclose(np.abs(after.deviation - traces.deviation)[..., inner], size[..., inner], atol=0.05 * UM)


@pytest.mark.long
def test_pitch_and_runout_hold_the_uncertainty_of_the_axis(pinion):
    """Scans moved by what the covariance allows: index within U where the pose counts, and not where it is taken as known."""
    rng = np.random.default_rng(4)
    points = flanks(pinion, 60, 8)
    sigma = np.array([0.01, 0.01, 0.0, 1e-5, 1e-5, 1e-4])
    inside = {True: [], False: []}
    for _ in range(8):
        motion = rng.normal(0.0, 1.0, 6) * sigma
        scan = points.position + motion[:3] + np.cross(motion[3:], points.position)
        located = locate(scan, pinion, workers=1)
        located = located.with_deviation(located.deviation + rng.normal(0.0, 0.002, len(located)))
        for told, held in inside.items():
            found = inspect(located, pinion, Settings(noise=0.002, pose_covariance=np.diag(sigma**2) if told else None))
            held += list((np.abs(found.pitch.index.value) <= found.pitch.index.expanded).ravel())
            held += list((np.abs(found.profile.slope.value) <= found.profile.slope.expanded).ravel())
            held.append(bool(found.runout.runout.value <= found.runout.runout.expanded))
            held += list(found.pitch.cumulative.value <= found.pitch.cumulative.expanded)
            # what lies between flanks of the same gear does not know of the pose
            np.testing.assert_allclose(found.dimensions.span_lengths.value, found.dimensions.span.length, atol=0.005)
    assert np.mean(inside[True]) > 0.9
    assert np.mean(inside[False]) < 0.5


def test_errors_in_common_leave_differences_alone(pinion):
    """A rotation turns every flank alike: no pitch is less sure for it, though every position is."""
    position = Estimate.plain(np.zeros((12, 2)), np.full((12, 2), 1e-3), np.tile(HAND[:, None] * 0.1, (12, 1, 1)))
    found = pitch_deviations(position, pinion, 13.0)
    arc = 1e-3 / math.cos(pinion.transverse_pressure_angle)
    np.testing.assert_allclose(position.standard, math.hypot(0.1, 1e-3))
    np.testing.assert_allclose(found.single.standard, math.sqrt(2.0) * arc, rtol=1e-6)


def test_rounded_ends_are_no_helix(small):
    """Edges rounded off by 30 µm beyond z = 0.75: the range ends before them, and it is said; the slope stays."""
    points = scattered(small, 300, 8)
    z = points.position[:, 2]
    rounded = np.where(z > 0.75, -0.03 * ((z - 0.75) / 0.09) ** 2 - 0.02 * (z > 0.76), 0.0)
    found = inspect(points.with_deviation(rounded), small, Settings(noise=1e-4))
    assert 0.65 < found.helix.range.end <= 0.77
    assert any("rounded off" in note for note in found.notes)
    assert np.abs(found.helix.slope.value).max() < 1.0 * UM


def test_a_section_of_its_own_and_a_slope_over_another_length(pinion):
    """Taper and screw along z: a section at a height shows that height; the slope over twice the length is twice as much."""
    points = flanks(pinion, 120, 30)
    where = profile_range(pinion, start=6.0, end=20.0)
    z = points.position[:, 2]
    twist = 0.02 * (z - 7.5) / 7.5 * (points.roll - where.middle) / where.length
    chosen = Settings(
        control_roll=6.0, profile_end=20.0, profile_band=(10.0, 11.0), slope_length=28.0, pitch_roll=12.0, pitch_band=(2.0, 13.0)
    )
    found = inspect(points.with_deviation(twist), pinion, chosen)
    assert (found.profile.range.start, found.profile.range.end) == (6.0, 20.0)
    np.testing.assert_allclose(found.profile.slope.value, 2.0 * 0.02 * 3.0 / 7.5, atol=0.5 * UM)  # points lie up to 0.5 mm from z
    assert found.pitch.roll == 12.0

"""The ridge that sliding leaves at the pitch point: what all flanks of a side have of it is not in their thickness."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.wear.bend import without_ridge

TEETH, SECTIONS, POINTS, HALF, NOISE = 20, 4, 12, 1.1, 0.004
PLACES = np.arange(SECTIONS)


def moments(x, y):
    """Of points (teeth, 2, sections, points)."""
    each = (np.ones_like(x), x, y, x * x, x * y, y * y, abs(x), x * abs(x), abs(x) * y)
    return np.array([values.sum(axis=-1) for values in each])


def levels(sums):
    """Value at x = 0 of the straight line through each section, (teeth, 2, sections)."""
    n, x, y, xx, xy, _ = sums
    slope = (xy - x * y / n) / (xx - x * x / n)
    return (y - slope * x) / n


def scanned(ridge, seed=1, noise=NOISE):
    """Flanks with a level and a lean of their own; those of the left side fall off by `ridge` mm per mm to both sides of the middle."""
    random = np.random.default_rng(seed)
    shape = (TEETH, 2, SECTIONS, POINTS)
    x = random.uniform(-HALF, HALF, shape)
    level, lean = 0.05 * random.normal(size=(2, TEETH, 2, 1, 1))
    fall = np.array([ridge, 0.0])[None, :, None, None] * np.abs(x)
    return x, level + 0.1 * lean * x - fall + noise * random.normal(size=shape), level[..., 0]


def test_a_ridge_without_noise_leaves_nothing():
    x, y, level = scanned(0.004, noise=0.0)
    straight, std = without_ridge(moments(x, y), PLACES, 1e-9, HALF)
    np.testing.assert_allclose(levels(straight), np.broadcast_to(level, (TEETH, 2, SECTIONS)), atol=1e-9)
    assert std.max() < 1e-8


def test_a_ridge_that_is_sharper_towards_one_end_leaves_nothing():
    """Wear of a load that leans: by a mean over the face, either end would be a quarter of the ridge off."""
    x, _, level = scanned(0.0, noise=0.0)
    sharp = 0.004 * np.linspace(0.5, 1.5, SECTIONS)[:, None] * np.array([1.0, 0.0])[:, None, None]
    straight, std = without_ridge(moments(x, level[..., None] - sharp * np.abs(x)), PLACES, 1e-9, HALF)
    np.testing.assert_allclose(levels(straight), np.broadcast_to(level, (TEETH, 2, SECTIONS)), atol=1e-9)
    assert std.max() < 1e-8


def test_the_levels_are_true_within_their_standard_deviation_and_were_not():
    """Without it a mean over the band lies ridge × half / 2 too low on all flanks of the side."""
    ridge, errors, before = 0.004, [], []
    for seed in range(12):
        x, y, level = scanned(ridge, seed)
        sums = moments(x, y)
        straight, std = without_ridge(sums, PLACES[: sums.shape[-1]], NOISE, HALF)
        error = (levels(straight) - level).mean(axis=(0, 2))
        noise = NOISE / np.sqrt(TEETH * SECTIONS * POINTS)
        errors.append(error / np.hypot(std, noise))
        before.append((levels(sums[:6]) - level).mean(axis=(0, 2)))
    assert np.mean(before, axis=0) == pytest.approx([-0.5 * ridge * HALF, 0.0], abs=2e-4)
    assert np.abs(np.mean(errors, axis=0)).max() < 3.0 / np.sqrt(12)
    assert np.abs(errors).max() < 4.0


def test_straight_flanks_are_mostly_left_to_the_digit_and_a_pit_is_no_ridge():
    same = 0
    for seed in range(12):
        x, y, _ = scanned(0.0, seed)
        y[7, 0] -= np.where(np.abs(x[7, 0]) > 0.6, 0.2, 0.0)  # 50 times the noise, on both ends of one tooth's band
        sums = moments(x, y)
        straight, _ = without_ridge(sums, PLACES[: sums.shape[-1]], NOISE, HALF)
        same += np.array_equal(straight, sums[:6])
        assert np.abs(levels(straight) - levels(sums[:6])).max() < 0.25 * NOISE
    assert same >= 3  # the chance that neither side's slope is beyond its standard deviation is 0.47


def test_too_few_points_tell_of_no_ridge():
    x, y, _ = scanned(0.004)
    sums = moments(x[:, :, :1, :5], y[:, :, :1, :5])
    straight, std = without_ridge(sums, PLACES[: sums.shape[-1]], NOISE, HALF)
    np.testing.assert_array_equal(straight, sums[:6])
    assert not std.any()


@pytest.mark.parametrize("rows", [(-0.4, 0.3), (-0.7, 0.5), (0.35,)])
def test_rows_of_points_at_few_radii_tell_of_no_ridge(rows):
    """As a coordinate measuring machine, or a scan in slices, gives them: |x| of two rows is a straight line, and what is left of it is the noise along
    the normal, which moves a point in length of roll by as much."""
    random = np.random.default_rng(4)
    shape = (TEETH, 2, SECTIONS, POINTS)
    off = NOISE * random.normal(size=shape)
    x = np.resize(rows, shape) + off
    sums = moments(x, off)
    straight, std = without_ridge(sums, PLACES, NOISE, HALF)
    np.testing.assert_array_equal(straight, sums[:6])
    assert not std.any()


def test_a_few_places_with_points_between_two_rows_tell_of_no_ridge():
    """Triangles with two rows of corners in the band, and a few corners moved by wear: teeth came out 0.16 mm too thick by what those few were off."""
    random = np.random.default_rng(5)
    shape = (TEETH, 2, SECTIONS, POINTS)
    off = NOISE * random.normal(size=shape)
    x = np.resize((-0.25, 0.65), shape) + off
    x[:3, :, :, 0], off[:3, :, :, 0] = -0.05, 0.1
    sums = moments(x, off)
    straight, std = without_ridge(sums, PLACES, NOISE, HALF)
    np.testing.assert_array_equal(straight, sums[:6])
    assert not std.any()

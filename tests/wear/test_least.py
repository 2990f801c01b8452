"""The least of noisy values: without the bias of having looked for it."""

import numpy as np
import pytest
from scipy.stats import binom

from gearwear.wear.least import _correlated, _unit, least_mean, least_of_curves, places, unmixed
from gearwear.wear.surface import _random

NOISE = 0.004
TEETH, SECTIONS, SCANS = 20, 30, 40


def curves(kind: str) -> np.ndarray:
    truth = np.zeros((TEETH, SECTIONS))
    if kind == "half of the teeth lower":
        truth[:10] -= 0.01
    if kind == "all worn alike":
        truth -= 0.03 * np.sin(np.pi * np.linspace(0.0, 1.0, SECTIONS)) ** 2
    return truth


@pytest.mark.long
@pytest.mark.parametrize("kind", ["level", "half of the teeth lower", "all worn alike"])
def test_the_least_of_many_alike_is_not_below_them(kind):
    """Without correction the least of 20 × 30 values is 3.1 standard deviations too low. Mean error and share of 95 % intervals that hold the truth:
    refused at odds of 1 in 1,000 where that share is 90 %."""
    random, truth = np.random.default_rng(3), curves(kind)
    off, held = [], 0
    for _ in range(SCANS):
        found = least_of_curves(truth + NOISE * random.normal(size=truth.shape), np.full(truth.shape, NOISE))
        off.append(found.overall - truth.min())
        held += abs(off[-1]) < 1.96 * found.overall_std
    assert abs(np.mean(off)) < 0.4 * NOISE
    assert held >= binom.ppf(0.001, SCANS, 0.9)


@pytest.mark.parametrize("shape", [(27, 1), (22, 3), pytest.param((60, 3), marks=pytest.mark.long)], ids=str)
def test_of_few_places_on_many_curves_alike_the_least_of_all_is_theirs(shape):
    """As thin scans leave them: the least of the curves' means, 1.1 to 2.2 standard deviations of a value too low, says nothing of the least of all."""
    random, held, off = np.random.default_rng(5), 0, []
    for _ in range(SCANS):
        found = least_of_curves(NOISE * random.normal(size=shape), np.full(shape, NOISE), most=0)
        off.append(found.overall)
        held += abs(off[-1]) < 1.96 * found.overall_std
    assert abs(np.mean(off)) < 0.6 * NOISE
    assert held >= binom.ppf(0.001, SCANS, 0.95)


def test_a_single_low_curve_is_itself():
    truth = np.zeros((TEETH, SECTIONS))
    truth[7, 10:20] = -0.1
    values = truth + NOISE * np.random.default_rng(1).normal(size=truth.shape)
    found = least_of_curves(values, np.full(truth.shape, NOISE))
    assert found.curve == 7
    assert 10 <= found.at[7] < 20
    assert found.value[7] == pytest.approx(-0.1, abs=4.0 * found.std[7])
    assert abs(found.value[3]) < 4.0 * found.std[3]


@pytest.mark.parametrize("seed", range(4))
def test_no_least_lies_above_the_mean_of_its_curve(seed):
    """True of any curve whatever its errors: the bias that is taken off is that of all curves, and may be more than one of them has."""
    random = np.random.default_rng(seed)
    values = NOISE * random.normal(size=(TEETH, SECTIONS))
    values[3, 5:10] = np.nan
    least = least_of_curves(values, np.full(values.shape, NOISE))
    assert (least.value <= np.nanmean(values, axis=1)).all()
    assert least.overall <= np.nanmean(values, axis=1).mean()


def test_what_nobody_saw_has_no_least():
    values = np.zeros((3, 10))
    values[1] = np.nan
    found = least_of_curves(values, np.full(values.shape, NOISE))
    assert np.isnan(found.value[1]) and np.isnan(found.std[1]) and found.at[1] == -1
    assert np.isfinite(found.overall)
    nothing = least_of_curves(np.full((2, 5), np.nan), np.full((2, 5), np.nan))
    assert nothing.curve == -1 and np.isnan(nothing.overall)


def test_values_far_apart_stay_and_values_alike_come_together():
    far = np.array([0.0, 1.0, 2.0])
    np.testing.assert_allclose(unmixed(far, np.full(3, 0.01))[0], far, atol=1e-6)
    alike = 0.01 * np.random.default_rng(2).normal(size=200)
    assert np.std(unmixed(alike, np.full(200, 0.01))[1]) < 0.3 * np.std(alike)


def test_the_deepest_mean_of_a_flat_floor_is_its_depth():
    """40 floors of 12 × 12 cells: the greatest of 100 windows would be 2.5 of their standard deviations too deep."""
    random = np.random.default_rng(5)
    where, std = np.ones((12, 12), dtype=bool), np.full((12, 12), NOISE)
    found = np.array([least_mean(-0.1 + NOISE * random.normal(size=where.shape), where, std, (2, 2)) for _ in range(40)])
    assert abs(found[:, 0].mean() + 0.1) < 0.4 * NOISE
    assert (np.abs(found[:, 0] + 0.1) < 1.96 * found[:, 1]).sum() >= binom.ppf(0.001, 40, 0.9)


@pytest.mark.long
def test_how_sure_a_window_is_hangs_on_noise_and_bend_not_on_luck():
    """40 flat floors: that of the deepest window scatters with what chance left near it. With 4 of the noise's deviations of a bend allowed for, over
    24 and in both ways, a window of one cell that lies on a flat floor is known to σ √(1 + (1/3)²); twice the noise, twice that."""
    random, where = np.random.default_rng(5), np.ones((12, 12), dtype=bool)
    unit = [random.normal(size=where.shape) for _ in range(40)]
    found, twice = (
        np.array([least_mean(-0.1 + noise * one, where, np.full(where.shape, noise), (1, 1)) for one in unit])
        for noise in (NOISE, 2.0 * NOISE)
    )
    assert found[:, 2].min() == pytest.approx(NOISE * np.hypot(1.0, 1.0 / 3.0), rel=1e-9)
    assert (twice[:, 2] > found[:, 2]).all()
    assert found[:, 2].std() < 0.5 * found[:, 1].std()


@pytest.mark.parametrize("width", [1, 3, 5, 9, 15, 25])
def test_places_hide_no_hollow_and_are_the_same_from_either_end(width):
    """Of 72 sections in windows of 25 two from either end would leave 22 in the middle that nobody looks at."""
    for count in range(width, 100):
        middles = places(count, width)
        assert (middles == count - 1 - middles[::-1]).all()
        covered = np.zeros(count, dtype=bool)
        for middle in middles:
            covered[max(middle - width // 2, 0) : middle + width // 2 + 1] = True
        # What is left over of the row lies about its middle, and is little where there is room for three windows.
        gap = np.flatnonzero(~covered)
        assert len(gap) <= (0.5 * width if count >= 3 * width else width) and (np.abs(gap - 0.5 * (count - 1)) < width).all()
        assert abs(len(middles) - count / width) < 2.0


def test_the_least_mean_of_a_surface_upside_down_is_the_same():
    """Windows of two rows too, whose middles lie between them."""
    rng = np.random.default_rng(2)
    value, std, where = rng.normal(size=(15, 12)), rng.uniform(0.2, 0.4, (15, 12)), rng.random((15, 12)) < 0.6
    for window in ((1, 1), (2, 2), (3, 3)):
        way, turned = (least_mean(value[::step], where[::step], std[::step], window, 0.01, (0.5, 0.5)) for step in (1, -1))
        assert way == pytest.approx(turned, rel=1e-9)


@pytest.mark.parametrize("kept", [lambda: _unit((3, 4)), lambda: _correlated((3, 4), (0.5, 0.5), (2, 2)), lambda: _random(5)])
def test_draws_that_surfaces_share_nobody_can_change(kept):
    assert kept() is kept()
    with pytest.raises(ValueError, match="read-only"):
        kept()[0] += 1.0

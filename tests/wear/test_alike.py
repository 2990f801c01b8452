"""Depths of flanks that wore alike, against draws of which the truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.wear.alike import alike

STD = np.linspace(0.004, 0.014, 28)


MEAN_STD = 0.0005


def drawn(seed, spread=0.0, apart=0.0):
    """True greatest depths of flanks three times as deep as on average, what they show, and their mean depths as shown."""
    random = np.random.default_rng(seed)
    mean = random.uniform(0.008, 0.016, len(STD))
    true = 3.2 * mean + random.normal(0.0, spread, len(STD)) if spread else 3.2 * mean
    level = random.normal(0.0, apart, len(STD)) if apart else np.zeros(len(STD))
    return true, true + level + random.normal(0.0, STD), mean + level + random.normal(0.0, MEAN_STD, len(STD))


def known(apart=0.0):
    return np.full(len(STD), np.hypot(MEAN_STD, apart))


def test_of_flanks_that_are_alike_the_deepest_is_not_the_luckiest():
    raw, better = [], []
    for seed in range(40):
        true, shown, mean = drawn(seed)
        value, _ = alike(shown, STD, mean, known())
        raw.append(shown.max() - true.max())
        better.append(value.max() - true.max())
    assert np.mean(raw) > 0.008  # 8 µm too deep for having been looked for
    assert abs(np.mean(better)) < 0.2 * np.mean(raw)


@pytest.mark.parametrize(("spread", "apart"), [(0.0, 0.0), (0.01, 0.0), (0.1, 0.0), (0.0, 0.002)])
def test_intervals_hold_the_truth(spread, apart):
    held, worse = [], []
    for seed in range(60):
        true, shown, mean = drawn(seed, spread, apart)
        value, std = alike(shown, STD, mean, known(apart), apart)
        held.append(np.abs(value - true) < 1.96 * std)
        worse.append(np.mean((value - true) ** 2) / np.mean((shown - true) ** 2))
    assert 0.90 < np.mean(held) <= 0.995
    assert np.mean(worse) < 1.02  # no flank is known worse for it, and where they are alike far better
    assert spread > 0.05 or np.mean(worse) < 0.75


def test_a_place_that_one_flank_has_alone_stays_as_deep():
    _, shown, mean = drawn(1)
    shown[5] = 0.6
    value, std = alike(shown, STD, mean, known())
    assert value[5] == 0.6 and std[5] == STD[5]
    others = np.arange(len(STD)) != 5
    np.testing.assert_allclose(value[others], 3.2 * mean[others], rtol=0.2)


def test_few_flanks_are_left_as_they_are():
    _, shown, mean = drawn(2)
    value, std = alike(shown[:5], STD[:5], mean[:5], known()[:5])
    np.testing.assert_array_equal(value, shown[:5])
    np.testing.assert_array_equal(std, STD[:5])

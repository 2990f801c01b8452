"""A drive that reverses, told from the other side of the teeth: wear by a generator that shares nothing with the law's fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.arrays import Floats
from gearwear.running.other_side import on_the_other_side
from gearwear.wear_law.fit import WearFit, fit_wear_law
from tests.running.maps import CENTRE, PAIR
from tests.synthetic.ran import RanWear

NOISE = 0.0004
"""mm; of a place of the mean profile."""
WORN = RanWear(single_um=14.0, load=100.0, bridged=True)


def fitted(depth: Floats, seed: int) -> WearFit:
    """The law on a mean profile with noise."""
    roll = WORN.table[0]
    noisy = depth + NOISE * np.random.default_rng(seed).normal(size=len(roll))
    return fit_wear_law(*PAIR, CENTRE, roll, noisy, np.full(len(roll), NOISE))[0]


def profile(wear: RanWear) -> Floats:
    return np.asarray(wear.table[2].mean(axis=1))


@pytest.mark.parametrize("share", [0.25, 0.6])
def test_the_share_put_in_is_asked_back(share: float):
    other = fitted(profile(replace(WORN, single_um=share * WORN.single_um)), 1)
    (found,) = on_the_other_side(fitted(profile(WORN), 2), other)
    size = found.parameters["share"]
    assert isinstance(size.value, float) and isinstance(size.std, float)
    assert found.name == "reversing_drive" and found.alternatives == ("gear_turned_round",)
    assert abs(size.value - share) < max(3.0 * size.std, 0.03 * share)
    assert found.after.all < 0.5 * found.before.all


def test_an_even_loss_noise_or_hardly_any_sliding_is_no_reversal():
    """Thinner teeth, unworn flanks, and a hundredth of the sliding: no name in any of 60."""
    drive = fitted(profile(WORN), 3)
    even, nothing, faint = (
        np.full(len(WORN.table[0]), 0.012),
        np.zeros(len(WORN.table[0])),
        profile(replace(WORN, single_um=0.14)),
    )
    named = [on_the_other_side(drive, fitted(depth, seed)) for depth in (even, nothing, faint) for seed in range(20)]
    assert sum(map(bool, named)) <= 1  # at three standard deviations, one-sided, 60 make 0.08 on average
    assert on_the_other_side(drive, None) == ()

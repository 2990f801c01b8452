"""Flanks that differ, against draws whose variances are known."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.diagnose.flanks_differ import differ_more

TEETH, CELLS, NOISE = 20, 60, 0.002
SHAPE = np.abs(np.linspace(-1.0, 1.0, CELLS))


def told(left_um, right_um, draws, side=Side.LEFT):
    """How often of some draws left and right flanks that have the shape by N(0, left²) and N(0, right²) µm are told to differ more on a side."""
    random = np.random.default_rng(7)
    size = 1e-3 * random.normal(size=(draws, TEETH, 2)) * [left_um, right_um] + [
        0.02,
        0.0,
    ]  # what all have alike is no difference
    level = random.normal(size=(draws, TEETH, 2, 1)) * 0.01
    flanks = size[..., None] * SHAPE + level + NOISE * random.normal(size=(draws, TEETH, 2, CELLS))
    weight = np.full((TEETH, 2, CELLS), NOISE**-2)
    return np.mean([differ_more(one, weight, SHAPE, side) for one in flanks])


@pytest.mark.parametrize("side", Side)
def test_where_both_sides_were_cut_alike_chance_tells_one_in_a_hundred(side):
    assert told(6.0, 6.0, 1000, side) == pytest.approx(0.01, abs=0.01)


def test_three_times_the_spread_is_told():
    assert told(18.0, 6.0, 200) > 0.98
    assert told(18.0, 6.0, 200, Side.RIGHT) == 0.0


def test_a_side_that_only_noise_parts_decides_nothing():
    """What the other side's flanks differ in is then told by the fit that asked."""
    assert told(1.2, 0.0, 200) > 0.97

"""The generator of worn pairs against closed forms: what it is wrong in, the tests that use it would be wrong in."""

import math

import numpy as np
import pytest

from tests.synthetic.outline import PINION, WHEEL, Outline
from tests.synthetic.ran import RanWear

ONE, TWO = Outline.of(PINION), Outline.of(WHEEL)
LINE = 114.3 * math.sin(math.radians(20.0))
PITCH = math.pi * 6.35 * math.cos(math.radians(20.0))


def sliding(roll: np.ndarray) -> np.ndarray:
    return np.abs(1.0 - (LINE - roll) / (2.0 * roll))


def test_single_contact_loses_what_archard_says():
    """One pair carries alone: depth = k w N |K|, whatever the springs are."""
    for soft in (0.5, 2.0):
        roll, _, depth = RanWear(single_um=12.0, softness=soft).table
        alone = (roll > roll[-1] - PITCH + 0.9) & (roll < roll[0] + PITCH - 0.9)
        assert alone.sum() >= 4
        assert depth[alone] == pytest.approx(0.012 * sliding(roll[alone])[:, None] * np.ones(depth.shape[1]), rel=2e-3)


def test_the_mean_over_the_face_in_single_contact_does_not_hang_on_misalignment():
    """The pair carries the whole force wherever it lies along the face."""
    roll, _, aligned = RanWear(single_um=12.0).table
    _, _, askew = RanWear(single_um=12.0, gap_um=40.0).table
    alone = (roll > roll[-1] - PITCH + 0.9) & (roll < roll[0] + PITCH - 0.9)
    assert askew[alone].mean(axis=1) == pytest.approx(aligned[alone].mean(axis=1), rel=2e-3)
    assert askew[alone][:, 0].min() > 3.0 * askew[alone][:, -1].max()


def test_the_depth_at_a_node_is_that_of_the_table():
    wear = RanWear(single_um=12.0, gap_um=20.0, factors=(2.0,) + (1.0,) * 11)
    roll, height, depth = wear.table
    got = wear.depth(ONE, np.array([0, 3, 3]), np.array([1, 1, -1]), roll[[4, 4, 4]], height[[2, 2, 2]])
    assert got == pytest.approx([2.0 * depth[4, 2], depth[4, 2], 0.0], rel=1e-12)

"""The generator of worn pairs against closed forms: what it is wrong in, the tests that use it would be wrong in."""

import math

import numpy as np
import pytest

from tests.synthetic.outline import PINION, WHEEL, Outline
from tests.synthetic.ran import RanWear, _nearest

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


def test_a_pair_that_is_ahead_takes_what_two_springs_say():
    """New flanks, one spring a pair, the next pair ahead by e: w₁ = (w q₂ + e) / (q₁ + q₂), and 0 or all of the load beyond."""
    early, load = 5.0, 150.0
    roll, _, depth = RanWear(single_um=1e-3, load=load, early_um=early).table
    low, high = roll[0], min(ONE.tip_roll, LINE - TWO.form_roll)
    soft = (1.0 + 0.5 * ((2.0 * roll - low - high) / (high - low)) ** 2) / 14e3
    rate = depth[:, 4] / sliding(roll) * load / 1e-6
    late = np.arange(20, len(roll))  # those that carry already, a pitch on
    first = late - 20
    own = (load * soft[late] + 1e-3 * early) / (soft[first] + soft[late])
    assert (own < load).all() and len(late) >= 4
    assert rate[first] == pytest.approx(own, rel=1e-6) and rate[late] == pytest.approx(load - own, rel=1e-6)


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


def test_across_a_step_two_flanks_touch_on_its_upper_side_as_a_parabola_lets_them():
    """Beside a step of h the distance at x from it is min(h, x² / 2R), and the contact lies at the step as long as that is the less."""
    arc, radius, step = np.linspace(0.0, 4.0, 401), 7.0, 0.004
    depth = np.where(arc > 2.0, step, 0.0)
    apart, way = _nearest(arc, arc[::-1], np.full(401, radius), depth, np.zeros(401))
    off = arc - 2.0
    wanted = np.where(off > 0.0, np.minimum(step, off**2 / (2.0 * radius)), 0.0)
    inside = (arc > 0.9) & (arc < 3.1)
    assert apart[inside] == pytest.approx(
        wanted[inside], abs=1.3e-4
    )  # the places tried are 0.05 mm apart, the ramp of the step 0.01
    bridged = inside & (off > 0.1) & (off < np.sqrt(2.0 * radius * step) - 0.05)
    assert way[bridged] == pytest.approx(-off[bridged], abs=0.02)


def test_bridging_moves_wear_and_takes_none_away():
    """One pair carries alone inside, two at the ends: the step between them is smoothed, and the section lost stays that of the load to 1 %."""
    plain, bridged = (RanWear(single_um=20.0, load=60.0, bridged=on).table for on in (False, True))
    width = np.gradient(plain[0] ** 2)
    lost = [float((depth.mean(axis=1) * width).sum()) for _, _, depth in (plain, bridged)]
    assert lost[1] == pytest.approx(lost[0], rel=0.01)
    rough = [float(np.abs(np.diff(depth.mean(axis=1)))[:9].max()) for _, _, depth in (plain, bridged)]
    assert rough[1] < 0.7 * rough[0]

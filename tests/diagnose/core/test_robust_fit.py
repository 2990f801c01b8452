"""Robust fits with a share for every flank, against the dense fit of all columns."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.diagnose.columns import cuts_among
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.robust_fit import Shares, robust_fit


def case(seed, flanks=9, each=40):
    draw = np.random.default_rng(seed)
    which = np.repeat(np.arange(flanks), each)
    columns = draw.normal(size=(len(which), 4))
    loss = np.where(draw.random(len(which)) < 0.7, -draw.random(len(which)), 0.0)
    loss[which == 3] = 0.0  # one flank has lost nothing
    return draw, which, columns, loss


@pytest.mark.parametrize("seed", range(3))
def test_shares_solved_each_by_itself_are_those_of_the_fit_on_all_columns(seed):
    draw, which, columns, loss = case(seed)
    target, weight = draw.normal(size=len(which)), draw.random(len(which))
    shares = Shares.of(loss, which)
    flanks = np.unique(which[loss != 0.0])
    dense = np.hstack([columns, np.where(which[:, None] == flanks, loss[:, None], 0.0)])
    root = np.sqrt(weight)[:, None]
    expected = np.linalg.lstsq(dense * root, target * root[:, 0], rcond=None)[0]
    found = shares.amplitudes(columns, target, weight, Gram.whole(columns, target, weight))
    assert shares.count == len(flanks) == 8
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(shares.times(found[4:]), dense[:, 4:] @ found[4:], atol=1e-12)


def test_cells_in_any_order_have_the_same_shares():
    draw, which, columns, loss = case(5)
    target, weight, order = draw.normal(size=len(which)), draw.random(len(which)), draw.permutation(len(which))
    one = Shares.of(loss, which).amplitudes(columns, target, weight, Gram.whole(columns, target, weight))
    other = Shares.of(loss[order], which[order]).amplitudes(
        columns[order], target[order], weight[order], Gram.whole(columns[order], target[order], weight[order])
    )
    np.testing.assert_allclose(one, other, rtol=1e-9)


def test_torn_cells_do_not_bend_a_fit_and_cost_a_fixed_price():
    draw, which, columns, loss = case(7)
    true, own = np.array([3.0, -2.0, 1.0, 0.5]), 5.0 + np.arange(8.0)
    shares = Shares.of(loss, which)
    target = columns @ true + shares.times(own)
    torn = draw.choice(len(target), 20, replace=False)
    target[torn] += 100.0
    fitted = robust_fit(target, np.ones(len(target)), columns, shares)
    np.testing.assert_allclose(fitted.amplitudes, [*true, *own], atol=1e-6)
    assert (fitted.weight[torn] == 0.0).all()
    assert fitted.square == pytest.approx(9.0 * 20, abs=1e-6)


def test_losses_have_no_amplitude_below_zero():
    draw, _, columns, _ = case(11)
    target = columns @ np.array([1.0, 2.0, -3.0, 4.0]) + 0.1 * draw.normal(size=len(columns))
    amplitudes = robust_fit(target, np.full(len(target), 100.0), columns, losses=2).amplitudes
    assert amplitudes[2] == 0.0 and amplitudes[3] > 0.0


def test_columns_of_few_cells_have_the_same_fit_stretch_by_stretch():
    """Those of nine flanks, in stretches that begin where a flank does, and some with no cell."""
    draw, which, columns, _ = case(13)
    own = np.where(which[:, None] == np.arange(9), draw.normal(size=(len(which), 1)), 0.0)
    target, weight = draw.normal(size=len(which)), draw.uniform(0.5, 2.0, len(which))
    wide = np.hstack([columns[:, :2], own])
    cuts = cuts_among(np.arange(0, 360, 60), np.flatnonzero(which != 4))  # the cells of flank 4 are no part of the fit
    kept = which != 4
    assert cuts.tolist() == [0, 60, 120, 180 - 20, 200, 260]
    whole = robust_fit(target[kept], weight[kept], wide[kept])
    parts = robust_fit(target[kept], weight[kept], wide[kept], cuts=cuts)
    assert np.count_nonzero(wide[kept]) < wide[kept].size / 3
    np.testing.assert_allclose(parts.amplitudes, whole.amplitudes, rtol=1e-9, atol=1e-12)
    assert parts.square == pytest.approx(whole.square, rel=1e-12)

"""CellColumns kept stretch by stretch against the same columns in full."""

import numpy as np
import pytest

from gearwear.diagnose.columns import LEAST_ROWS, CellColumns, cuts_of
from gearwear.diagnose.gram import Gram, _weighted
from tests.diagnose.core.toy import grid

CUTS = np.array([0, 30, 31, 70])
ROWS = 90


def case(seed: int):
    """Columns of which most are zero on most stretches, one everywhere, and two more behind them; target, weights, folds."""
    rng = np.random.default_rng(seed)
    values = rng.normal(size=(ROWS, 9))
    for start, stop in zip(CUTS, [*CUTS[1:], ROWS], strict=True):
        values[start:stop, rng.random(9) > 0.4] = 0.0
    values[:, 4] = 0.0
    weight = rng.uniform(0.0, 2.0, ROWS) * (rng.random(ROWS) > 0.3)
    weight[30:31] = 0.0
    return values, rng.normal(size=ROWS), weight, rng.integers(0, 3, ROWS)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("folds", [1, 3])
def test_sums_are_those_of_the_columns_in_full(seed, folds):
    values, target, weight, fold = case(seed)
    fold = fold % folds
    kept = CellColumns.of(values[:, :7], CUTS), CellColumns.of(values[:, 7:], CUTS)
    one, other = Gram.of(kept, target, weight, fold, folds), Gram.of(values, target, weight, fold, folds)
    np.testing.assert_allclose(one.information, other.information, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(one.moment, other.moment, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal([one.square, one.weight], [other.square, other.weight])


@pytest.mark.parametrize("seed", range(4))
def test_sums_go_on_with_columns_that_come_behind(seed):
    values, target, weight, _ = case(seed)
    one = np.zeros(ROWS, np.int64)
    first, more = CellColumns.of(values[:, :6], CUTS), CellColumns.of(values[:, 6:], CUTS)
    widened = Gram.of((first,), target, weight, one, 1).widened((first, more), target, weight)
    other = Gram.of(values, target, weight, one, 1)
    for name in ("information", "moment", "square", "weight"):
        np.testing.assert_allclose(getattr(widened, name), getattr(other, name), rtol=1e-13, atol=1e-13)


def test_columns_come_back_as_they_were():
    values, *_ = case(1)
    kept = CellColumns.gathered((values[:, i : i + 2] for i in range(0, 9, 2)), CUTS, together=3)
    out = np.zeros((ROWS, 3))
    kept.put(np.array([1, -1, -1, 0, -1, -1, -1, -1, 2]), out)
    np.testing.assert_array_equal(out, values[:, [3, 0, 8]])
    np.testing.assert_allclose(kept.times(np.arange(9.0)), values @ np.arange(9.0), rtol=1e-13, atol=1e-14)
    some = np.random.default_rng(1).random(ROWS) < 0.1
    np.testing.assert_array_equal(kept.seen(some), values[some].any(axis=0))
    assert (kept.rows, kept.count) == values.shape and kept.cuts.tolist() == CUTS.tolist()
    assert sum(stretch.values.size for stretch in kept.stretches) < 0.7 * values.size


def test_columns_that_are_kept_already_stand_where_they_are_given():
    values, *_ = case(2)
    kept = CellColumns.of(values[:, 2:5], CUTS)
    every = CellColumns.gathered([values[:, :2], kept, values[:, 5:6], values[:, 6:]], CUTS)
    out = np.zeros_like(values)
    every.put(np.arange(9), out)
    np.testing.assert_array_equal(out, values)
    assert every.cuts.tolist() == CUTS.tolist()


def test_cells_without_weight_take_no_part_in_products():
    """What is left out of a fit costs nothing: as many rows are multiplied as have a weight."""
    values, _, weight, _ = case(3)
    kept, rows = (CellColumns.of(values[:, :7], CUTS), CellColumns.of(values[:, 7:], CUTS)), np.flatnonzero(weight)
    parts = list(_weighted(kept, np.sqrt(weight), rows))
    np.testing.assert_array_equal(np.concatenate([at for at, _, _ in parts]), rows)
    assert [len(part) for _, _, part in parts] == [len(at) for at, _, _ in parts]


@pytest.mark.parametrize("size", [0.4, 1.6])
def test_stretches_of_a_grid_are_whole_sides_or_teeth_of_one_surface(size):
    one = grid(size)
    cuts = cuts_of(one)
    starts = [start for start, _ in one.blocks.values()]
    assert (np.diff(cuts) > 0).all() and set(starts) <= set(cuts.tolist()) and cuts[-1] < one.count
    first, many = next(iter(one.blocks.values()))
    assert {(cut - first) % (one.rows * one.flank) for cut in cuts.tolist() if cut < first + many} == {0}
    # Where a third of the cells are seen, stretches are three times as long.
    longer = np.diff(cuts_of(one, 1.0 / 3.0)[np.isin(cuts_of(one, 1.0 / 3.0), cuts)])
    assert set(cuts_of(one, 1.0 / 3.0).tolist()) >= set(starts) and longer[0] >= min(3 * LEAST_ROWS, many)

"""Sufficient statistics against dense least squares on the rows themselves."""

import numpy as np
import pytest

from gearwear.diagnose.beside import Beside, blocks_of
from gearwear.diagnose.gram import Gram
from tests.diagnose.core.toy import left

SEEDS = range(6)


def case(seed):
    rng = np.random.default_rng(seed)
    n, p = int(rng.integers(60, 200)), int(rng.integers(4, 9))
    columns = rng.normal(size=(n, p)) * 10.0 ** rng.uniform(-4, 4, p)
    target, weight = rng.normal(size=n), rng.uniform(0.0, 5.0, n) * (rng.random(n) > 0.2)
    return columns, target, weight, rng.integers(0, 5, n)


def dense(columns, target, weight):
    root = np.sqrt(weight)
    return columns * root[:, None], target * root


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("folds", [1, 5])
def test_amplitudes_inverse_and_rest_are_those_of_dense_least_squares(seed, folds):
    columns, target, weight, fold = case(seed)
    gram = Gram.of(columns, target, weight, fold if folds > 1 else np.zeros(len(fold), int), folds)
    which = np.arange(columns.shape[1])[::2]
    x, y = dense(columns[:, which], target, weight)
    amplitudes, inverse = gram.solve(which)
    size = np.linalg.norm(x, axis=0)
    np.testing.assert_allclose(amplitudes * size, np.linalg.lstsq(x, y, rcond=None)[0] * size, rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(inverse @ (x.T @ x), np.eye(len(which)), atol=1e-6 * np.outer(1 / size, size).max())
    assert gram.residual_square(which) == pytest.approx(left(x, y), rel=1e-7)
    assert gram.residual_square(np.arange(0)) == pytest.approx(y @ y)
    assert gram.weight.sum() == pytest.approx(weight.sum())


@pytest.mark.parametrize("seed", SEEDS)
def test_gains_are_the_fall_of_the_dense_sum_of_squares(seed):
    columns, target, weight, fold = case(seed)
    gram = Gram.of(columns, target, weight, fold, 5)
    base, blocks = np.array([0, 1]), [np.array([2]), np.array([2, 3]), np.arange(2, columns.shape[1])]
    x, y = dense(columns, target, weight)
    expected = [left(x[:, base], y) - left(x[:, [*base, *block]], y) for block in blocks]
    np.testing.assert_allclose(gram.gains(base, blocks), expected, rtol=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_fold_left_out_is_predicted_by_the_others(seed):
    columns, target, weight, fold = case(seed)
    gram = Gram.of(columns, target, weight, fold, 5)
    which = np.arange(3)
    x, y = dense(columns[:, which], target, weight)
    expected = []
    for f in range(5):
        amplitudes = np.linalg.lstsq(x[fold != f], y[fold != f], rcond=None)[0]
        expected.append(np.sum((y[fold == f] - x[fold == f] @ amplitudes) ** 2))
        size = np.linalg.norm(x, axis=0)
        np.testing.assert_allclose(gram.solve(which, without=f)[0] * size, amplitudes * size, rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(gram.held_out(which), expected, rtol=1e-6)
    assert gram.held_out(which).sum() > gram.residual_square(which)


def test_collinear_columns_are_solved_and_gain_nothing():
    columns, target, weight, fold = case(3)
    twice = np.column_stack([columns, -3.0 * columns[:, 0], columns[:, 0] + columns[:, 1] * columns[0, 0] / columns[0, 1]])
    p = columns.shape[1]
    gram = Gram.of(twice, target, weight, fold, 5)
    x, y = dense(columns, target, weight)
    every = np.arange(p + 1)
    assert np.isfinite(gram.solve(every)[0]).all()
    assert gram.residual_square(every) == pytest.approx(left(x, y), rel=1e-6)
    assert gram.gains(np.arange(2), [np.array([p]), np.array([p + 1])]).tolist() == [0.0, 0.0]


def test_a_column_nobody_sees_gets_no_amplitude_and_harms_nobody():
    columns, target, weight, fold = case(4)
    blind = np.where(weight > 0.0, 0.0, 7.0)
    wide = np.column_stack([columns, blind])
    gram, p = Gram.of(wide, target, weight, fold, 5), columns.shape[1]
    with_it, without = gram.solve(np.arange(p + 1))[0], gram.solve(np.arange(p))[0]
    assert with_it[-1] == 0.0
    np.testing.assert_allclose(with_it[:-1], without, rtol=1e-9)
    assert gram.gains(np.arange(2), [np.array([p])])[0] == 0.0
    both = gram.gains(np.arange(2), [np.array([2, p]), np.array([2])])
    assert both[0] == pytest.approx(both[1], rel=1e-12)


def test_rows_without_weight_do_not_count_even_if_not_finite():
    columns, target, weight, fold = case(5)
    torn = np.where((weight > 0.0)[:, None], columns, np.nan)
    one, other = (Gram.of(c, target, weight, fold, 5) for c in (columns, torn))
    np.testing.assert_array_equal(one.information, other.information)


@pytest.mark.parametrize("seed", SEEDS)
def test_bounded_amplitudes_are_those_of_a_bounded_dense_fit(seed):
    from scipy.optimize import lsq_linear

    columns, target, weight, fold = case(seed)
    gram = Gram.of(columns, target, weight, fold, 5)
    free, bounded = np.array([0]), np.arange(1, columns.shape[1])
    x, y = dense(columns, target, weight)
    size = np.linalg.norm(x, axis=0)
    low = np.where(np.isin(np.arange(len(size)), bounded), 0.0, -np.inf)
    expected = lsq_linear(x / size, y, (low, np.inf), tol=1e-12).x
    amounts = gram.solve_non_negative(free, bounded) * size
    assert (amounts[1:] >= 0.0).all() and (amounts[1:] == 0.0).any() == (expected[1:] < 1e-6).any()
    np.testing.assert_allclose(amounts, expected, atol=1e-5)


def test_a_bounded_column_that_nobody_sees_gets_no_amplitude():
    columns, target, weight, fold = case(0)
    columns[:, 2] = 0.0
    gram = Gram.of(columns, target, weight, fold, 5)
    every, bounded = np.arange(columns.shape[1]), np.arange(1, columns.shape[1])
    amounts = gram.solve_non_negative(every[:1], bounded)
    others = gram.solve_non_negative(every[:1], np.delete(bounded, 1))
    assert amounts[2] == 0.0
    np.testing.assert_allclose(np.delete(amounts, 2), others, rtol=1e-9)


def test_bounded_columns_of_which_nobody_sees_any_leave_the_fit_on_the_others():
    columns, target, weight, fold = case(1)
    columns[:, 2:] = 0.0
    gram = Gram.of(columns, target, weight, fold, 5)
    free, bounded = np.arange(2), np.arange(2, columns.shape[1])
    np.testing.assert_array_equal(gram.solve_non_negative(free, bounded), [*gram.amplitudes(free), *np.zeros(len(bounded))])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_fit_beside_what_is_always_in_is_the_fit_on_both(seed):
    """Frisch, Waugh and Lovell: amplitudes, the rest and gains are those of the whole fit."""
    columns, target, weight, fold = case(seed)
    gram = Gram.of(columns, target, weight, fold, 5)
    always, which = np.array([1, 0]), np.array([3, 2])
    beside, both = gram.beside(always), np.concatenate([always, which])
    amplitudes, square = beside.fit(which)
    np.testing.assert_allclose(amplitudes, gram.solve(both)[0][2:], rtol=1e-6)
    np.testing.assert_allclose(beside.solve(which)[1], gram.solve(both)[1][2:, 2:], rtol=1e-6)
    assert square == pytest.approx(gram.residual_square(both), rel=1e-9)
    assert beside.fit(np.arange(0))[1] == pytest.approx(gram.residual_square(always), rel=1e-9)
    candidates = [np.array([i]) for i in range(columns.shape[1])] + [np.array([0, 2])]
    tried = gram.beside(always, candidates)
    squares, gains = tried.tried(np.array([[3], [2]]))
    for i, one in enumerate((3, 2)):
        base = np.array([*always, one])
        np.testing.assert_allclose(gains[i], gram.gains(base, candidates), rtol=1e-6)
        assert squares[i] == pytest.approx(gram.residual_square(base), rel=1e-9)
    assert (gains[0][[0, 1, 3]] == 0.0).all()
    np.testing.assert_allclose(tried.beside(which[:1]).tried(np.array([[2]]))[1], tried.tried(np.array([[3, 2]]))[1], rtol=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_columns_that_nobody_sees_take_no_part_in_what_is_held_beside_others(seed):
    """Of teeth that are not among the cells: fits and gains are those without these columns."""
    columns, target, weight, fold = case(seed)
    p = columns.shape[1]
    place = 2 * np.arange(p)  # one of nothing behind each
    wide = np.zeros((len(columns), 2 * p))
    wide[:, place] = columns
    few, many = (Gram.of(of, target, weight, fold, 5) for of in (columns, wide))
    few_beside, beside = few.beside(np.array([0])), many.beside(np.array([1, 0, 3]), [place[[2]], np.array([1, place[3]])])
    assert beside.information.shape == (p, p)
    amplitudes, square = beside.fit(np.array([3, place[1], place[2]]))
    assert amplitudes[0] == 0.0
    expected = few_beside.fit(np.array([1, 2]))
    np.testing.assert_allclose(amplitudes[1:], expected[0], rtol=1e-9)
    assert square == pytest.approx(expected[1], rel=1e-9)
    gains = few.gains(np.array([0, 1]), [np.array([2]), np.array([3])])
    np.testing.assert_allclose(beside.tried(np.array([[5, place[1]]]))[1][0], gains, rtol=1e-6)
    np.testing.assert_allclose(beside.beside(np.array([5, place[1]])).tried(np.zeros((1, 0), int))[1][0], gains, rtol=1e-6)


def test_of_columns_that_are_spanned_already_rounding_may_leave_less_than_nothing():
    """With so little left of them no third column can lose anything to them."""
    left = np.diag([-1e-8, -1e-8, 0.5])
    place = np.array([0, 1, 2, -1])
    beside = Beside(place, left, np.array([0.0, 0.0, 0.3]), 2.0, np.ones(3), 1, blocks_of(place, [np.array([2])]))
    both = beside.beside(np.array([0, 1]))
    assert both.square == pytest.approx(2.0) and both.information[2, 2] == pytest.approx(0.5)
    assert both.tried(np.zeros((1, 0), int))[1][0, 0] == pytest.approx(0.3**2 / 0.5)


def test_bounded_amplitudes_beside_many_free_columns_are_those_of_dense_least_squares():
    """All below 0 but where the target was made: then the bounds do not bind, and it is plain least squares."""
    random = np.random.default_rng(3)
    columns, weight = random.normal(size=(400, 60)) * 10.0 ** random.uniform(-3, 3, 60), random.uniform(0.5, 2.0, 400)
    target = columns @ (random.uniform(1.0, 2.0, 60) / np.linalg.norm(columns, axis=0)) + 1e-3 * random.normal(size=400)
    gram = Gram.of(columns, target, weight, np.zeros(400, int), 1)
    x, y = dense(columns, target, weight)
    size = np.linalg.norm(x, axis=0)
    found = gram.solve_non_negative(np.arange(55), np.arange(55, 60))
    np.testing.assert_allclose(found * size, np.linalg.lstsq(x / size, y, rcond=None)[0], rtol=1e-6)

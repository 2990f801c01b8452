"""Correlated residuals against fields drawn with a known correlation, by recursion and not from a matrix."""

import numpy as np
import pytest

from gearwear.design.surface import FLANK, TIP
from gearwear.diagnose.covariance import CellCovariance, effective_number, estimate_covariance
from tests.diagnose.core.toy import TEETH, cells_of, grid

ROW, COLUMN, TEXTURE, NOISE, COUNT = 0.7, 0.5, 0.004, 0.006, 9.0


def recursion(rng, shape, step, axis):
    """Unit variance, correlation step^lag along one axis."""
    value = np.moveaxis(rng.normal(size=shape), axis, 0)
    for i in range(1, len(value)):
        value[i] = step * value[i - 1] + np.sqrt(1.0 - step**2) * value[i]
    return np.moveaxis(value, 0, axis)


def drawn(rng, one, draws=1, row=ROW, column=COLUMN):
    """Texture and noise on flanks, (draws, teeth, 2, rows, flank); neighbours along both axes hang together, sides do not."""
    shape = (draws, TEETH, 2, one.rows, one.flank)
    field = recursion(rng, shape, row, 3)
    scaled = field.copy()
    for i in range(1, shape[4]):  # the second axis by recursion on what the first left
        scaled[..., i] = column * scaled[..., i - 1] + np.sqrt(1.0 - column**2) * field[..., i]
    return TEXTURE * scaled + NOISE / np.sqrt(COUNT) * rng.normal(size=shape)


def known(one):
    return CellCovariance(one, np.full(one.count, NOISE**2 / COUNT), TEXTURE**2, ROW, COLUMN)


def on_flanks(one, values):
    start, size = one.blocks[FLANK]
    result = np.zeros(one.count)
    result[start : start + size] = np.asarray(values).ravel()
    return result


def test_the_variance_of_a_weighted_mean_is_that_of_many_draws():
    one, rng = grid(2.5), np.random.default_rng(1)
    weights = rng.normal(size=(2, TEETH, 2, one.rows, one.flank)) + np.array([0.0, 1.0])[:, None, None, None, None]
    sums = np.einsum("ntsrc,ptsrc->pn", drawn(rng, one, 3000), weights)
    columns = np.column_stack([on_flanks(one, w) for w in weights])
    claimed = columns.T @ known(one).apply(columns)
    empirical = np.cov(sums)
    # 3000 draws: a standard deviation to 1.3 %, a variance to 2.6 %.
    np.testing.assert_allclose(np.diag(claimed), np.diag(empirical), rtol=4 * 0.026)
    scale = np.sqrt(claimed[0, 0] * claimed[1, 1])
    assert abs(claimed[0, 1] - empirical[0, 1]) < 4 * scale * np.sqrt(1.0 / 3000)


def test_is_symmetric_positive_and_the_dense_matrix_of_its_definition():
    one = grid(4.0)
    cover = known(one)
    dense = cover.apply(np.eye(one.count))
    np.testing.assert_allclose(dense, dense.T, atol=1e-18)
    assert np.linalg.eigvalsh(dense)[0] > 0.0
    start = one.blocks[FLANK][0]
    shape = (TEETH, 2, one.rows, one.flank)
    here = start + np.ravel_multi_index((3, 1, 0, 0), shape)
    for at, expected in (
        ((3, 1, 0, 0), TEXTURE**2 + NOISE**2 / COUNT),
        ((3, 1, 2, 0), TEXTURE**2 * ROW**2),
        ((3, 1, 1, 2), TEXTURE**2 * ROW * COLUMN**2),
        ((3, 0, 0, 0), 0.0),
        ((4, 1, 0, 0), 0.0),
    ):
        assert dense[here, start + np.ravel_multi_index(at, shape)] == pytest.approx(expected, abs=1e-18)
    tip = one.blocks[TIP][0]
    assert dense[here, tip] == 0.0
    np.testing.assert_allclose(cover.weight, 1.0 / np.diag(dense))


def estimated(one, seed, **steps):
    values = drawn(np.random.default_rng(seed), one, **steps)[0]
    sheets = np.concatenate([np.full((TEETH, 2, one.rows, one.fillet), np.nan), values], axis=-1)
    cells = cells_of(one, sheets, COUNT, NOISE)
    use = on_flanks(one, np.ones(values.shape)) > 0.0
    return estimate_covariance(cells, np.nan_to_num(cells.points.deviation), use, NOISE)


def test_texture_and_correlation_come_back():
    """The neighbour correlations come from integral scales, over lags that end: each within a tenth on average, and per draw."""
    found = [estimated(grid(0.8), seed) for seed in range(12)]
    texture, row, column = (np.array([getattr(one, name) for one in found]) for name in ("texture", "row_step", "column_step"))
    assert np.sqrt(texture.mean()) == pytest.approx(TEXTURE, rel=0.05)
    assert row.mean() == pytest.approx(ROW, abs=0.07) and row.std() < 0.07
    assert column.mean() == pytest.approx(COLUMN, abs=0.07) and column.std() < 0.07


def test_white_noise_has_no_texture_to_speak_of():
    rng, one = np.random.default_rng(3), grid(0.8)
    values = NOISE / np.sqrt(COUNT) * rng.normal(size=(TEETH, 2, one.rows, one.fillet + one.flank))
    cells = cells_of(one, values, COUNT, NOISE)
    found = estimate_covariance(cells, np.nan_to_num(cells.points.deviation), cells.seen, NOISE)
    # Of N cells the mean square is known to √(2 / N).
    assert found.texture < 4.0 * np.sqrt(2.0 / values.size) * NOISE**2 / COUNT


def test_what_is_not_in_use_does_not_count():
    rng, one = np.random.default_rng(4), grid(1.6)
    values = rng.normal(size=(TEETH, 2, one.rows, one.fillet + one.flank))
    cells = cells_of(one, values, COUNT, NOISE)
    use = cells.seen & (cells.points.tooth < 6)
    spoilt = np.where(use, np.nan_to_num(cells.points.deviation), 1e3)
    plain = estimate_covariance(cells, np.nan_to_num(cells.points.deviation), use, NOISE)
    other = estimate_covariance(cells, spoilt, use, NOISE)
    assert plain.texture > 0.5
    assert (other.texture, other.row_step, other.column_step) == (plain.texture, plain.row_step, plain.column_step)


def test_effective_number_is_the_cells_over_the_gain_of_variance():
    one = grid(2.5)
    cover = known(one)
    use = on_flanks(one, np.ones((TEETH, 2, one.rows, one.flank))) > 0.0
    count = use.sum()
    even = np.ones(one.count)
    # Sum over a chain of n with correlation ρ: n + 2 Σ (n − k) ρ^k; both axes are separable.
    chain = [n + 2.0 * sum((n - k) * step**k for k in range(1, n)) for n, step in ((one.rows, ROW), (one.flank, COLUMN))]
    white = NOISE**2 / COUNT
    inflated = (TEXTURE**2 * chain[0] * chain[1] / (one.rows * one.flank) + white) / (TEXTURE**2 + white)
    assert effective_number(even, cover, use) == pytest.approx(count / inflated, rel=1e-9)
    alone = CellCovariance(one, cover.white, 0.0, 0.0, 0.0)
    assert effective_number(even, alone, use) == pytest.approx(count)

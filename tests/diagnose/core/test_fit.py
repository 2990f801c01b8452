"""A fit of toy effects to sheets of cells: amplitudes, errors and their covariance against draws and dense algebra."""

import numpy as np
import pytest

from gearwear.design.surface import FLANK
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.fit import design_unit
from gearwear.diagnose.judge import sandwich
from gearwear.diagnose.masks import folds
from tests.diagnose.core.toy import TEETH, Toy, fit_of, grid, left, sides_of

NOISE, COUNT = 0.005, 20.0


def blocks_of(at):
    slope, bow = at.across - 0.5, (2.0 * at.z - 1.0) ** 2
    return [(Toy("slope"), slope[..., None]), (Toy("bow"), bow[..., None])]


def test_residual_is_the_dense_one_and_parts_say_where():
    one = grid()
    at, rng = sides_of(one), np.random.default_rng(1)
    fit = fit_of(one, 0.01 * rng.normal(size=at.z.shape), blocks_of(at), NOISE)
    model = fit.dictionary.candidates
    rows = fit.use
    columns = fit.columns(model)[rows]
    amplitudes = np.linalg.lstsq(columns, fit.target[rows], rcond=None)[0]
    np.testing.assert_allclose(fit.residual(model)[rows], fit.target[rows] - columns @ amplitudes, atol=1e-10)
    assert [(part.start, part.stop) for part in fit.parts(model)] == [(1, 2), (2, 3)]


def test_errors_are_the_points_mean_square_inside_and_between_cells():
    """A cell of n points with mean d and scatter s has n d² + (n − 1) s²: over all points the plain mean square."""
    one, rng = grid(), np.random.default_rng(2)
    at = sides_of(one)
    fit = fit_of(one, 0.01 * rng.normal(size=at.z.shape), blocks_of(at), NOISE, COUNT)
    by_tooth, _ = folds(fit.cells)
    inside, left_out = fit.errors((), by_tooth)
    residual = fit.residual(())[fit.use]
    points = [COUNT * residual**2 + (COUNT - 1.0) * NOISE**2]
    assert inside == pytest.approx(np.sqrt(np.sum(points) / (COUNT * len(residual))), rel=1e-9)
    # Left out by hand: the constant of the other teeth predicts each tooth.
    tooth, value = fit.cells.points.tooth[fit.use], fit.target[fit.use]
    outer = sum(np.sum((value[tooth == t] - value[tooth != t].mean()) ** 2) for t in range(TEETH))
    between = np.mean(residual**2)
    ratio = outer / left(np.ones((len(value), 1)), value)
    assert left_out == pytest.approx(np.sqrt(inside**2 + between * (ratio - 1.0)), rel=1e-6)


def test_sandwich_is_the_spread_of_refitted_amplitudes():
    """Textured residuals drawn by recursion along z; the weights take cells as independent, so only the sandwich can be right."""
    one, rng = grid(2.5), np.random.default_rng(3)
    at, row, texture = sides_of(one), 0.8, 0.004
    fit = fit_of(one, np.zeros(at.z.shape), blocks_of(at), NOISE, COUNT)
    model = fit.dictionary.candidates
    # Cells of one surface hang together; fillets and flanks do not.
    cover = CellCovariance(one, np.where(fit.use, NOISE**2 / COUNT, 1.0), texture**2, row, 0.0)
    columns = fit.columns(model)[fit.use]
    draws = []
    for _ in range(2500):
        field = rng.normal(size=at.z.shape)
        for i in range(1, field.shape[2]):
            field[:, :, i] = row * field[:, :, i - 1] + np.sqrt(1.0 - row**2) * field[:, :, i]
        value = texture * field + NOISE / np.sqrt(COUNT) * rng.normal(size=at.z.shape)
        draws.append(one.on_cells(value)[fit.use])
    amplitudes = np.linalg.lstsq(columns, np.array(draws).T, rcond=None)[0]
    weight = cover.weight[fit.use]
    inverse = np.linalg.inv((columns * weight[:, None]).T @ columns)
    claimed = sandwich(fit.columns(model), fit.use, cover, inverse)
    # 2500 draws give a variance to √(2 / 2500) = 2.8 %.
    np.testing.assert_allclose(np.diag(claimed), amplitudes.var(axis=1), rtol=4 * 0.028)
    naive = np.diag(inverse)
    assert naive[1] < 0.8 * amplitudes.var(axis=1)[1] or naive[2] < 0.8 * amplitudes.var(axis=1)[2]


@pytest.mark.parametrize(
    ("name", "half"), [("height", lambda at: at.z < 0.5), ("side", lambda at: at.left), ("everywhere", lambda at: at.z < 2.0)]
)
def test_an_effect_of_one_half_alone_is_as_uneven_as_can_be(name, half):
    """Size 1 on a share p of the cells and 0 on the others is p everywhere when fitted: relative sizes 1 / p and 0; an even one has one."""
    one, rng = grid(), np.random.default_rng(4)
    at = sides_of(one)
    wave = np.cos(3.0 * 2.0 * np.pi * at.tooth / TEETH)
    there = np.where(half(at), 0.02 * wave, 0.0) + NOISE / np.sqrt(COUNT) * rng.normal(size=at.z.shape)
    fit = fit_of(one, there, [(Toy("wave"), wave[..., None])], NOISE, COUNT)
    model = fit.dictionary.candidates
    amplitudes, _ = fit.problem(1.0, None).gram.solve(np.arange(2))
    uneven = fit.uneven(model, amplitudes, 0)
    assert uneven == (0.0 if name == "everywhere" else pytest.approx(1.0 / half(at).mean(), rel=0.02))


@pytest.mark.parametrize(("kind", "lower", "upper"), [(Kind.MANUFACTURE, 0.0, 0.2), (Kind.MEASUREMENT, 0.6, 2.0)])
def test_halves_of_the_profile_at_levels_of_their_own_make_what_the_maker_cut_along_the_face_not_uneven(kind, lower, upper):
    """The mean of a bow is a level; what only looks like one stays held to it. A bow of one half alone is uneven whoever made it."""
    one, rng = grid(), np.random.default_rng(6)
    at = sides_of(one)
    bow, tip = (2.0 * at.z - 1.0) ** 2, at.across > 0.55
    noise = NOISE / np.sqrt(COUNT) * rng.normal(size=at.z.shape)

    def uneven(there):
        fit = fit_of(one, there + noise, [(Toy("bow", kind=kind), bow[..., None])], NOISE, COUNT)
        amplitudes, _ = fit.problem(1.0, None).gram.solve(np.arange(2))
        return fit.uneven(fit.dictionary.candidates, amplitudes, 0)

    assert lower <= uneven(0.01 * bow + np.where(tip, 0.005, -0.005)) <= upper
    assert uneven(0.01 * np.where(tip, bow, 0.0)) > 0.6


def test_the_design_unit_is_one_for_independent_cells_and_the_variance_ratio_for_blocks_that_move_as_one():
    one = grid(2.5)
    at = sides_of(one)
    fit = fit_of(
        one, np.zeros(at.z.shape), [(Toy("tooth"), np.where(at.tooth == k, 1.0, 0.0)[..., None]) for k in range(4)], NOISE
    )
    assert design_unit(fit.dictionary, fit.use, fit.covariance) == pytest.approx(1.0)
    # Texture that is one value on a whole side of a surface: n cells of variance s² each sum to n² s².
    flanks = fit.use & (fit.cells.points.surface == FLANK)
    whole = CellCovariance(one, np.full(one.count, 1e-12), 1e-4, 1.0, 1.0)
    assert design_unit(fit.dictionary, flanks, whole) == pytest.approx(one.rows * one.flank, rel=1e-6)


def test_an_amplitude_no_cell_speaks_of_is_not_known():
    one, rng = grid(), np.random.default_rng(5)
    at = sides_of(one)
    both = np.stack([at.across - 0.5, np.zeros_like(at.z)], axis=-1)
    fit = fit_of(one, 0.01 * rng.normal(size=at.z.shape), [(Toy("two"), both)], NOISE)
    model = fit.dictionary.candidates
    amplitudes, _ = fit.problem(1.0, None).gram.solve(np.arange(3))
    (spread,) = fit.uncertainty(model, amplitudes, None, NOISE)
    assert np.isfinite(spread[0, 0]) and np.isnan(spread[1, 1])


def test_what_teeth_differ_in_an_effect_is_the_spread_of_its_size():
    """Each tooth has its own share of a slope: the fitted size of all scatters from gear to gear by what one gear's teeth tell."""
    one, rng, spread = grid(2.5), np.random.default_rng(4), 0.4
    at = sides_of(one)
    sizes, errors = [], []
    for _ in range(60):
        share = 1.0 + spread * rng.normal(size=TEETH)[at.tooth]
        fit = fit_of(one, 0.01 * share * (at.across - 0.5) + 1e-5 * rng.normal(size=at.z.shape), blocks_of(at), NOISE)
        model = fit.dictionary.candidates
        columns = fit.columns(model)[fit.use]
        sizes.append(np.linalg.lstsq(columns, fit.target[fit.use], rcond=None)[0][1] / 0.01)
        (error, number), _ = fit.apart_by_teeth(model)
        errors.append(error * sizes[-1])
        assert number == pytest.approx(TEETH, rel=0.01)  # every tooth tells as much; a slope has one size
    assert np.std(sizes) == pytest.approx(spread / np.sqrt(TEETH), rel=0.25)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(spread / np.sqrt(TEETH), rel=0.1)

"""Shape values put in and asked back: a wave of a length that is not on the grid, and a step."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from gearwear.diagnose.by_tooth import ByTooth
from gearwear.diagnose.dictionary import build_dictionary, cell_basis
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, ReliefEffect
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.parameter import Parameter, Role
from gearwear.diagnose.search import exchange, forward
from gearwear.diagnose.shapes import REFINED, _gain_beside, _most_likely, orthonormal, polish, refine_shapes, shape_columns
from tests.diagnose.core.toy import WIDTH, fit_of, grid, sides_of

NOISE, COUNT = 0.004, 20.0
AT = sides_of(grid())


@dataclass(frozen=True)
class Bump(CatalogueEffect):
    """δ = a exp(−½ ((z − c) / w)²) with a centre and a width to be found."""

    name = "bump"
    kind = Kind.MANUFACTURE
    source = tells_apart = phrase = ""
    parameters = (Parameter("height_um"), Parameter("centre_mm", Role.PLACE), Parameter("width_mm", Role.PLACE))

    def shapes(self, context):
        return [(centre, width) for centre in (2.0, 5.0, 8.0, 11.0) for width in (2.0, 4.0)]

    def bracket(self, shape, context):
        return [(shape[0] - 3.0, shape[0] + 3.0), (0.5 * shape[1], 2.0 * shape[1])]

    def basis(self, points, context, shape):
        return np.exp(-0.5 * ((points.position[:, 2] - shape[0]) / shape[1]) ** 2)[:, None]


@dataclass(frozen=True)
class Ripple(CatalogueEffect):
    """δ = a cos(2π z / λ), averaged over a cell's height."""

    name = "ripple"
    kind = Kind.MANUFACTURE
    averaged = "z"
    source = tells_apart = phrase = ""

    def basis(self, points, context, shape):
        return np.cos(2.0 * np.pi * points.position[:, 2] / shape[0])[:, None]


def context_of(one):
    return Context(one.gear, frozenset({0, 1}), np.eye(3))


def searched(true, effects, seed=1):
    one = grid()
    about = context_of(one)
    deviation = true + NOISE / np.sqrt(COUNT) * np.random.default_rng(seed).normal(size=AT.z.shape)
    plain = fit_of(one, deviation, [], NOISE, COUNT)
    book = build_dictionary(plain.cells, effects, replace(about, planar=False))
    fit = Fit(plain.cells, plain.target, book, plain.use, plain.covariance)
    problem = fit.problem(1.0, about)
    return fit, problem, exchange(problem, forward(problem))


def bump(centre, width):
    return np.exp(-0.5 * ((WIDTH * AT.z - centre) / width) ** 2)


@pytest.mark.parametrize(("centre", "width"), [(6.4, 2.7), (9.3, 1.9), (4.1, 3.3)])
def test_a_shape_between_the_points_of_its_grid_comes_back(centre, width):
    fit, problem, model = searched(0.02 * bump(centre, width), (Bump(),))
    assert [c.name for c in model] == ["bump"]
    dictionary, book, refined = problem.dictionary, problem.dictionary, model
    for _ in range(2):  # one axis after the other: once more from where it came to
        again = Fit(fit.cells, fit.target, book, fit.use, fit.covariance).problem(1.0, problem.context)
        book, refined = refine_shapes(again, refined, fit.cells, fit.target, fit.use, fit.covariance)
    assert refined[0].shape == pytest.approx((centre, width), abs=0.35)
    after = Fit(fit.cells, fit.target, book, fit.use, fit.covariance)
    chi_square = np.sum(after.weight * after.residual(refined) ** 2)
    # The noise alone has one a cell, ± √(2 / cells).
    assert chi_square / fit.use.sum() == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / fit.use.sum()))
    assert len(dictionary.candidates) < len(book.candidates)


@dataclass(frozen=True)
class Twin(Bump):
    """A bump with a flat head: of the same kind, and no other bump."""

    name = "twin"

    def basis(self, points, context, shape):
        return np.exp(-0.5 * ((points.position[:, 2] - shape[0]) / shape[1]) ** 4)[:, None]


def test_polish_puts_the_right_effect_in_the_place_of_one_that_was_refined_first():
    fit, problem, _ = searched(0.02 * bump(6.4, 2.7), (Bump(), Twin()))
    wrong = tuple(c for c in problem.dictionary.candidates if c.name == "twin")[3:4]
    book, wrong = refine_shapes(problem, wrong, fit.cells, fit.target, fit.use, fit.covariance)
    again = Fit(fit.cells, fit.target, book, fit.use, fit.covariance).problem(1.0, problem.context)
    book, polished = polish(again, wrong, fit.cells, fit.target, fit.use, fit.covariance)
    assert [c.name for c in polished] == ["bump"]
    after = Fit(fit.cells, fit.target, book, fit.use, fit.covariance)
    assert np.sum(after.weight * after.residual(polished) ** 2) < np.sum(after.weight * after.residual(wrong) ** 2)


def test_of_many_models_the_cheapest_are_refined_and_each_once():
    _, problem, _ = searched(0.02 * bump(6.4, 2.7), (Bump(), Twin()))
    bumps, twins = ([c for c in problem.dictionary.candidates if c.name == name] for name in ("bump", "twin"))
    pairs = [(one, other) for one in bumps for other in twins]
    likely = _most_likely(problem, [*pairs, *((other, one) for one, other in pairs)])
    assert len(likely) == REFINED < len(pairs)
    dearest = max(problem.cost(pair) for pair in likely)
    assert sum(problem.cost(pair) < dearest for pair in pairs) == REFINED - 1


@dataclass(frozen=True)
class Relief(ReliefEffect):
    """Straight or a parabola from a place on, on a grid that is coarse."""

    name = "relief"
    kind = Kind.MANUFACTURE
    source = tells_apart = phrase = ""
    parameters = (Parameter("amount_um"), Parameter("start_mm", Role.PLACE), Parameter("exponent", Role.PLACE))

    def shapes(self, context):
        return [(start, *form) for form in ((), (2.0,)) for start in (2.0, 5.0, 8.0, 11.0)]

    def bracket(self, shape, context):
        return [(shape[0] - 3.0, shape[0] + 3.0)]

    def basis(self, points, context, shape):
        share = np.clip((points.position[:, 2] - shape[0]) / (WIDTH - shape[0]), 0.0, None)
        return -(share ** self.exponent(shape))[:, None]


@pytest.mark.parametrize(("start", "exponent"), [(6.6, 1.0), (3.7, 1.0), (5.5, 2.0)])
def test_a_relief_between_the_points_of_its_grid_has_the_form_it_has(start, exponent):
    """On the grid the other form may come nearer: a parabola from 5 mm on to a straight relief from 6.6 mm on."""
    true = -0.07 * np.clip((WIDTH * AT.z - start) / (WIDTH - start), 0.0, None) ** exponent
    fit, problem, _ = searched(true, (Relief(),))
    other = [c for c in problem.dictionary.candidates if (len(c.shape) > 1) != (exponent > 1.0)]
    nearest = min(other, key=lambda c: problem.cost((c,)))
    _, (found,) = refine_shapes(problem, (nearest,), fit.cells, fit.target, fit.use, fit.covariance)
    assert Relief().exponent(found.shape) == exponent
    assert found.shape[0] == pytest.approx(start, abs=0.1)


def test_columns_of_the_shape_are_its_derivatives():
    fit, problem, model = searched(0.02 * bump(8.0, 2.0), (Bump(),))
    own = replace(model[0], shape=(8.0, 2.0))
    found = shape_columns(own, np.array([0.02]), fit.cells, problem.context)
    z = WIDTH * AT.z
    by_centre = 0.02 * bump(8.0, 2.0) * (z - 8.0) / 2.0**2
    by_width = 0.02 * bump(8.0, 2.0) * (z - 8.0) ** 2 / 2.0**3
    for column, true in zip(found.T, (by_centre, by_width), strict=True):
        # Central differences over 2 % of the bracket: off by the square of that step.
        np.testing.assert_allclose(fit.cells.grid.sides(column), true, atol=0.01 * np.abs(true).max())


@pytest.mark.parametrize("wavelength", [3.0, 5.0, 12.0])
def test_a_wave_is_averaged_over_its_cell(wavelength):
    """The mean of cos over a height h is its middle times sinc(h / λ)."""
    one = grid()
    cells = fit_of(one, np.zeros(AT.z.shape), [], NOISE).cells
    basis = cell_basis(Ripple(), cells.points.take(cells.seen), context_of(one), (wavelength,), one)
    middle = np.cos(2.0 * np.pi * cells.points.position[cells.seen, 2] / wavelength)
    np.testing.assert_allclose(basis[:, 0], middle * np.sinc(WIDTH / one.rows / wavelength), atol=2e-3)


@pytest.mark.parametrize("alike", [1.0, 1e-3, 1e-7, 0.0])
def test_a_frame_spans_its_columns_and_nothing_else(alike):
    """Also where one column is nearly another, or nobody sees one."""
    rng = np.random.default_rng(4)
    columns = rng.normal(size=(400, 6)) * 10.0 ** rng.uniform(-3, 3, 6)
    columns[:, 5] = columns[:, 0] + alike * rng.normal(size=400) * np.abs(columns[:, 0]).mean()
    if alike == 0.0:
        columns[:, 5] = 0.0
    frame = orthonormal(columns)
    np.testing.assert_allclose(frame.T @ frame, np.eye(6), atol=1e-13)
    off = columns - frame @ (frame.T @ columns)
    assert np.abs(off).max() < 1e-12 * np.abs(columns).max()


def test_what_is_by_tooth_is_taken_out_as_columns_are():
    """Against the fall of a least-squares fit of all columns together; two amounts a tooth, of mean 0, and columns that lean on them."""
    rng = np.random.default_rng(4)
    teeth, cells = 9, 40
    tooth, weight = np.repeat(np.arange(teeth), cells), rng.uniform(0.5, 2.0, teeth * cells)
    amounts = []
    for own in (np.ones(teeth * cells), rng.choice([-1.0, 1.0], teeth * cells)):
        each = np.where(tooth[:, None] == np.arange(teeth), own[:, None], 0.0)
        amounts.append(each[:, :-1] - each[:, [-1]])
    by_tooth, base = np.hstack(amounts), rng.normal(size=(teeth * cells, 3)) + 0.1 * tooth[:, None]
    tried, target = rng.normal(size=(teeth * cells, 2)) + by_tooth[:, :2], rng.normal(size=teeth * cells)
    root = np.sqrt(weight)

    def left(*columns):
        return np.linalg.lstsq(np.hstack(columns) * root[:, None], target * root)[1][0]

    def weighted(*columns):
        return np.hstack(columns) * root[:, None]

    taken_out, aim = ByTooth.of(weighted(by_tooth)), weighted(target[:, None])
    gained = left(base, by_tooth) - left(base, by_tooth, tried)
    assert _gain_beside(weighted(base), aim, taken_out)(weighted(tried)) == pytest.approx(gained, rel=1e-9)
    assert _gain_beside(weighted(base, by_tooth), aim)(weighted(tried)) == pytest.approx(gained, rel=1e-9)
    assert np.abs(taken_out.columns.T @ taken_out.beside(base)).max() < 1e-12


@pytest.mark.parametrize("columns", [np.eye(6)[:, [0, 1, 1]], np.eye(6)[:, :2] * [1.0, 0.0]], ids=["twice the same", "nothing"])
def test_columns_that_are_nearly_the_same_are_not_by_tooth(columns):
    assert ByTooth.of(columns) is None

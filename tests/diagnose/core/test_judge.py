"""Evidence of an effect against closed forms, and its p-value in noise."""

from dataclasses import replace

import numpy as np
import pytest

from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.judge import alternatives, judge
from gearwear.diagnose.masks import folds
from tests.diagnose.core.toy import Toy, fit_of, grid, sides_of

NOISE, COUNT = 0.005, 20.0
AT = sides_of(grid())
U, ZETA = 2.0 * AT.across - 1.0, 2.0 * AT.z - 1.0


def evidence(deviation, blocks, index=0, covariance=None):
    fit = fit_of(grid(), deviation, [(toy, field[..., None]) for toy, field in blocks], NOISE, COUNT)
    fit = replace(fit, covariance=covariance or fit.covariance)
    model, problem = fit.dictionary.candidates, fit.problem(1.0, None)
    by_tooth, _ = folds(fit.cells)
    return judge(problem, model, index, fit.use, fit.covariance, fit.folded(model, by_tooth), NOISE)


def noise(seed, white=1.0):
    return white * NOISE / np.sqrt(COUNT) * np.random.default_rng(seed).normal(size=AT.z.shape)


def test_contribution_and_size_are_root_mean_squares_in_millimetres():
    """Of two fields that share a part the size is the whole, the contribution what the other cannot explain."""
    both = evidence(0.01 * U + 0.006 * (U + ZETA), [(Toy("u"), U), (Toy("sum"), U + ZETA)])
    alone = U - U.mean()
    assert both.size == pytest.approx(0.01 * np.sqrt(np.mean(alone**2)), rel=1e-6)
    # u less its part along u + ζ: the two are orthogonal, so (u² − u⁴ / (u² + ζ²)).
    u, z = np.mean(U**2), np.mean(ZETA**2)
    assert both.contribution == pytest.approx(0.01 * np.sqrt(u * z / (u + z)), rel=1e-5)


def test_statistic_is_the_ratio_to_the_noise():
    """One column, independent cells: F = a² Σ b² / σ²."""
    found = evidence(0.002 * U, [(Toy("u"), U)])
    assert found.statistic == pytest.approx(0.002**2 * np.sum(U**2) / (NOISE**2 / COUNT), rel=1e-5)
    assert found.degrees[0] == 1.0
    assert found.effective_number == pytest.approx(U.size)


@pytest.mark.long
def test_p_values_in_noise_are_even_times_the_number_of_candidates():
    p = np.array([evidence(noise(seed), [(Toy("u"), U)]).p_value for seed in range(300)])
    for level in (0.1, 0.3, 0.6):
        assert abs(np.mean(p < level) - level) < 3.5 * np.sqrt(level * (1 - level) / 300)
    three = evidence(noise(1), [(Toy("u"), U), (Toy("z"), ZETA), (Toy("uz"), U * ZETA)]).p_value
    one = evidence(noise(1), [(Toy("u"), U)]).p_value
    assert three == pytest.approx(min(1.0, 3.0 * one), rel=0.05)


def test_noise_is_not_accepted_and_a_shared_field_is():
    assert not any(evidence(noise(seed), [(Toy("u"), U)]).accepted for seed in range(60))
    assert all(evidence(noise(seed) + 0.003 * U, [(Toy("u"), U)]).accepted for seed in range(20))


JUMP = np.where(AT.tooth < 6, AT.tooth / 5.5 - 1.0, (AT.tooth - 11.0) / 5.5) ** 5
"""Round the gear, about nothing but on a few teeth: what a drift is on both hands of its jump."""


def test_without_noise_left_out_teeth_show_all_of_a_field_that_is_theirs():
    found = evidence(0.002 * U + 0.001 * ZETA, [(Toy("u"), U), (Toy("z"), ZETA)])
    assert found.shown == pytest.approx(1.0, abs=1e-6)
    assert found.shown_error < 1e-6
    gain = 1e6 * 0.002**2 * np.mean((U - U.mean()) ** 2)
    assert found.held_out_gain == pytest.approx(gain, rel=0.02)  # each left-out tooth is fitted about a mean of its own


def test_gain_is_the_fall_of_the_left_out_mean_squares():
    deviation, blocks = noise(3) + 0.001 * U, [(Toy("u"), U[..., None]), (Toy("z"), ZETA[..., None])]
    fit = fit_of(grid(), deviation, blocks, NOISE, COUNT)
    problem, model, (by_tooth, _) = fit.problem(1.0, None), fit.dictionary.candidates, folds(fit.cells)
    folded = fit.folded(model, by_tooth)
    every = np.arange(len(problem.columns(model)))
    fall = folded.held_out(np.delete(every, -2)) - folded.held_out(every)
    found = judge(problem, model, 0, fit.use, fit.covariance, folded, NOISE)
    assert found.held_out_gain == pytest.approx(1e6 * np.mean(fall / folded.weight), rel=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_what_is_large_on_a_few_teeth_alone_is_shown_by_those(seed):
    """The gain differs from tooth to tooth as the field does: against that scatter it would be nothing sure."""
    found = evidence(noise(seed) + 0.003 * JUMP, [(Toy("jump"), JUMP)])
    assert found.accepted
    assert abs(found.shown - 1.0) < 4.0 * found.shown_error
    assert found.shown_error < 0.1


@pytest.mark.parametrize("seed", range(6))
def test_one_bad_tooth_speaks_for_no_effect_of_all(seed):
    """It rules the fit, and what that predicts the others do not show."""
    bad = np.where(AT.tooth == 3, 0.02 * U, 0.0)
    found = evidence(noise(seed) + bad, [(Toy("u"), U)])
    assert found.p_value < 1e-6
    assert not found.accepted


@pytest.mark.parametrize(("amplitude", "accepted"), [(0.003, True), (-0.003, False)])
def test_what_an_effect_cannot_be_is_not_accepted_however_clear(amplitude, accepted):
    """A relief takes metal away: left alone by others that fell, it may be fitted as adding some."""
    assert evidence(noise(1) + amplitude * U, [(Toy("relief", low=0.0), U)]).accepted is accepted


def test_texture_weakens_the_same_field():
    """Var a = bᵀΣb / (bᵀb)², with Σ summed here over rows and columns of fillets and flanks apart."""
    one, step, texture, white = grid(), 0.8, (0.5 * NOISE) ** 2, NOISE**2 / COUNT
    cover = CellCovariance(one, np.where(one.on_cells(np.ones(AT.z.shape, bool)), white, 1.0), texture, step, step)
    found = evidence(0.001 * U, [(Toy("u"), U)], covariance=cover)

    def chain(values):
        lag = np.abs(np.subtract.outer(np.arange(len(values)), np.arange(len(values))))
        return values @ step**lag @ values

    u = U[0, 0, 0]
    along = chain(np.ones(one.rows))
    tied = U.shape[0] * 2 * along * (chain(u[: one.fillet]) + chain(u[one.fillet :]))
    square = np.sum(U**2)
    assert found.statistic == pytest.approx(0.001**2 * square**2 / (texture * tied + white * square), rel=1e-5)
    assert found.effective_number == pytest.approx(
        U.size * (texture + white) * square / (texture * tied + white * square), rel=1e-5
    )


def test_alternatives_are_what_would_do_as_well():
    """A twin within the noise, not a field that explains half of it, nor one whose sign cannot be, nor one of many freedoms."""
    rng = np.random.default_rng(3)
    near = U + 0.01 * rng.normal(size=U.shape)
    teeth = np.where(AT.tooth[..., None] == np.arange(8), U[..., None], 0.0)
    blocks = [
        (Toy("true"), U[..., None]),
        (Toy("twin"), near[..., None]),
        (Toy("half"), (U + ZETA)[..., None]),
        (Toy("negative", high=0.0), near[..., None]),
        (Toy("many"), teeth),
    ]
    fit = fit_of(grid(), 0.01 * U + noise(4), blocks, NOISE, COUNT)
    assert alternatives(fit.problem(1.0, None), fit.dictionary.candidates[:1], 0) == ("twin",)


def test_what_explains_more_but_not_the_same_is_no_alternative():
    """A freedom for every tooth that hardly pays for itself, beside a field across it that explains far more."""
    rng = np.random.default_rng(5)
    sign = np.where(AT.tooth % 2, -1.0, 1.0)
    teeth = np.where(AT.tooth[..., None] == np.arange(12), np.ones_like(U)[..., None], 0.0)
    twin = np.where(AT.tooth[..., None] == np.arange(12), 1.0 + 0.01 * rng.normal(size=U.shape)[..., None], 0.0)
    blocks = [(Toy("teeth"), teeth), (Toy("other"), ZETA[..., None]), (Toy("twin"), twin)]
    fit = fit_of(grid(), 0.0006 * sign + 0.002 * ZETA + noise(6), blocks, NOISE, COUNT)
    problem = fit.problem(1.0, None)
    effect, other = fit.dictionary.candidates[:2]
    assert problem.cost((other,)) < problem.cost((effect,)) < problem.cost(())
    assert alternatives(problem, (effect,), 0) == ("twin",)


@pytest.mark.parametrize(("table", "told"), [(0.004, ("table",)), (0.0005, ())])
def test_most_of_what_each_tooth_has_may_be_a_wave_of_the_table(table, told):
    """A wave beside errors of the teeth of 1 µm; where these are the larger part they are the teeth's own. Nor is a maker's wave named, nor one across."""
    angle = 2.0 * np.pi * AT.tooth / 12
    wave = np.stack([np.cos(2.0 * angle), np.sin(2.0 * angle)], axis=-1)
    teeth = np.where(AT.tooth[..., None] == np.arange(12), np.ones_like(U)[..., None], 0.0)
    blocks = [
        (Toy("teeth", tooth_specific=True), teeth),
        (Toy("table", kind=Kind.MEASUREMENT), wave),
        (Toy("maker", kind=Kind.MANUFACTURE), wave),
        (Toy("other order", kind=Kind.MEASUREMENT), np.stack([np.cos(3.0 * angle), np.sin(3.0 * angle)], axis=-1)),
        (Toy("across", kind=Kind.MEASUREMENT), (ZETA * np.cos(2.0 * angle))[..., None]),
    ]
    errors = 0.001 * np.random.default_rng(7).normal(size=12)
    fit = fit_of(grid(), table * wave[..., 1] + errors[AT.tooth] + noise(8), blocks, NOISE, COUNT)
    assert alternatives(fit.problem(1.0, None), fit.dictionary.candidates[:1], 0) == told


@pytest.mark.parametrize(("within", "told"), [(0.0, ("teeth",)), (0.6, ())], ids=["not within a tooth", "within a tooth"])
def test_an_error_of_the_table_may_be_the_index_unless_flanks_turn_within_a_tooth(within, told):
    """A wave round the gear that is the same all over a flank is twelve numbers, one for each tooth, as well."""
    angle = 2.0 * np.pi * AT.tooth / 12.0 + within * U
    wave = np.cos(2.0 * angle)
    teeth = np.where(AT.tooth[..., None] == np.arange(12), np.ones_like(U)[..., None], 0.0)
    blocks = [
        (Toy("table", kind=Kind.MEASUREMENT), wave[..., None]),
        (Toy("teeth", tooth_specific=True), teeth),
        (Toy("mount", tooth_specific=True, kind=Kind.MEASUREMENT), teeth),
    ]
    fit = fit_of(grid(), 0.002 * wave + noise(9), blocks, NOISE, COUNT)
    assert alternatives(fit.problem(1.0, None), fit.dictionary.candidates[:1], 0) == told


def test_errors_of_the_index_are_no_level_of_all_teeth():
    """Each tooth has one besides: that explains more than the level does, and not the same."""
    errors = 0.01 * np.random.default_rng(3).normal(size=12)
    sense = np.where(AT.left, 1.0, -1.0)
    teeth = np.where(AT.tooth[..., None] == np.arange(12), sense[..., None], 0.0)
    blocks = [(Toy("offset", kind=Kind.MEASUREMENT), np.ones_like(U)[..., None]), (Toy("index", tooth_specific=True), teeth)]
    fit = fit_of(grid(), 0.002 + sense * errors[AT.tooth] + noise(2), blocks, NOISE, COUNT)
    assert alternatives(fit.problem(1.0, None), fit.dictionary.candidates[:1], 0) == ()

"""How surely the size of an effect is known, against amplitudes drawn from their covariance."""

import numpy as np
import pytest

from gearwear.comparison.contributions import relative_std
from gearwear.diagnose.effects import named_effects
from tests.diagnose.sample import BORED, CLOSE, context, feet

CASES = {
    "coating": ((), [0.02]),
    "profile_slope": ((1.0,), [0.012, -0.007]),
    "turntable_angle": ((3.0,), [4e-4, -2e-4]),
    "feed_marks": ((3.1, 0.0), [0.003, 0.004]),
    "view_registration": ((0.3, 2.1), [0.03, -0.01, 2e-4]),
    "pitch": ((1.0,), (0.02 * np.cos(np.arange(11))).tolist()),
    "root_form": ((), [0.01, 0.03, -0.02, 0.015, 0.02, 0.01, -0.01]),
}


def spread_of(amplitudes: np.ndarray, share: float, seed: int) -> np.ndarray:
    """A covariance with correlations, of some per cent of each amplitude's own unit."""
    root = np.random.default_rng(seed).normal(size=(len(amplitudes), len(amplitudes)))
    size = share * np.abs(amplitudes)
    return (root @ root.T / len(amplitudes)) * np.outer(size, size)


@pytest.mark.parametrize("name", CASES)
def test_is_the_spread_of_the_root_mean_square_of_drawn_fields(name):
    effect, (shape, values) = named_effects()[name], CASES[name]
    amplitudes = np.array(values)
    basis = effect.basis(feet(BORED, CLOSE), context(), shape)
    covariance = spread_of(amplitudes, 0.04, len(name))
    rng = np.random.default_rng(1)
    drawn = rng.multivariate_normal(amplitudes, covariance, size=6000, method="svd")
    gram = basis.T @ basis
    rms = np.sqrt(np.einsum("ni,ij,nj->n", drawn, gram, drawn))
    # 6000 draws give a standard deviation to 1 / √12000 = 0.9 %; second order adds about the square of 4 %.
    assert relative_std(basis, amplitudes, covariance) == pytest.approx(rms.std() / rms.mean(), rel=0.04)


def test_a_change_of_units_of_the_amplitudes_changes_nothing():
    """Millimetres beside radians: in microns and seconds of arc it is the same field with the same spread."""
    effect = named_effects()["view_registration"]
    amplitudes, unit = np.array([0.03, -0.01, 2e-4]), np.array([1e3, 1e3, np.degrees(3600.0)])
    basis, covariance = effect.basis(feet(BORED, CLOSE), context(), (0.3, 2.1)), spread_of(np.array([0.03, -0.01, 2e-4]), 0.1, 3)
    other = relative_std(basis / unit, unit * amplitudes, covariance * np.outer(unit, unit))
    assert other == pytest.approx(relative_std(basis, amplitudes, covariance), rel=1e-12)


def test_columns_of_one_length_need_the_amplitudes_and_their_covariance_alone():
    rng = np.random.default_rng(4)
    basis = 7.0 * np.linalg.qr(rng.normal(size=(50, 3)))[0]
    amplitudes, root = rng.normal(size=3), rng.normal(size=(3, 3))
    covariance = root @ root.T
    plain = np.sqrt(amplitudes @ covariance @ amplitudes) / (amplitudes @ amplitudes)
    assert relative_std(basis, amplitudes, covariance) == pytest.approx(plain, rel=1e-12)


def test_what_is_not_known_adds_nothing_and_no_field_has_no_spread():
    basis = np.column_stack([np.ones(5), np.zeros(5)])
    unknown = np.array([[0.01, np.nan], [np.nan, np.nan]])
    assert relative_std(basis, np.array([2.0, 0.0]), unknown) == pytest.approx(0.05)
    assert relative_std(basis, np.array([0.0, 1.0]), unknown) == 0.0

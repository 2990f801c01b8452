"""Whether wear leans across the face, told from the scatter of few teeth: as seldom by chance as three standard deviations are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.wear_law.across import AcrossFace, mean_of_teeth

CHANCE = math.erfc(3.0 / math.sqrt(2.0))
DRAWS = 40_000


def across(lean: float, std: float, freedom: float) -> AcrossFace:
    return AcrossFace(np.arange(4.0), np.full(4, 0.02), np.full(4, 1e-3), lean, std, 0.0, 1.0, freedom)


@pytest.mark.parametrize("teeth", [3, pytest.param(5, marks=pytest.mark.long), 12])
def test_teeth_that_lean_at_random_are_seldom_said_to_lean(teeth):
    """By 3 standard deviations of their own scatter 9.5 % of three teeth were, 4.0 % of five and 1.2 % of twelve."""
    leans = np.random.default_rng(5).normal(0.0, 0.02, (teeth, DRAWS))
    mean, std, freedom = mean_of_teeth(leans, np.zeros(DRAWS))
    assert (freedom == teeth - 1).all()
    said = sum(across(*one).leans for one in zip(mean.tolist(), std.tolist(), freedom.tolist(), strict=True))
    assert abs(said - CHANCE * DRAWS) < 4.0 * math.sqrt(CHANCE * DRAWS)


def test_noise_that_is_known_otherwise_and_greater_counts_as_known():
    mean, std, freedom = mean_of_teeth(np.array([[0.9], [1.0], [1.1]]), np.array([0.04]))
    assert (mean[0], std[0], freedom[0]) == (pytest.approx(1.0), pytest.approx(0.2), math.inf)
    assert across(0.61, 0.2, math.inf).leans and not across(0.59, 0.2, math.inf).leans
    assert not across(0.61, 0.2, 2.0).leans

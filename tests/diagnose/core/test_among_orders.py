"""An effect of one order round the gear beside waves of other orders: named where it stands out, else left to the form it is a part of."""

import numpy as np
import pytest

from gearwear.diagnose.among_orders import hidden_among_orders
from gearwear.diagnose.elimination import eliminate
from gearwear.diagnose.parameter import Spread, angular
from tests.diagnose.core.toy import TEETH, Toy, fit_of, grid, sides_of

NOISE, COUNT = 0.005, 20.0
AT = sides_of(grid())
ANGLE = 2.0 * np.pi * AT.tooth / TEETH
SHAPE = 0.3 + AT.across
OVAL = SHAPE[..., None] * np.stack([np.cos(2.0 * ANGLE), np.sin(2.0 * ANGLE)], axis=-1)


def wave(height, order, phase):
    return height * SHAPE * np.cos(order * ANGLE + phase)


def fitted(field, seed=1, seen=None):
    noise = NOISE / np.sqrt(COUNT) * np.random.default_rng(seed).normal(size=AT.z.shape)
    fit = fit_of(grid(), field + noise, [(Toy("oval"), OVAL)], NOISE, COUNT, turns=True)
    return fit, fit.problem(1.0, None), fit.dictionary.candidates


@pytest.mark.parametrize(
    ("others", "stands"),
    [
        pytest.param((), True, id="alone"),
        pytest.param(((0.0004, 3), (0.0003, 5)), True, id="thirty times its neighbours in power"),
        pytest.param(((0.006, 3),), False, id="a blank of three lobes and more"),
        pytest.param(((0.0015, 3), (0.0015, 4)), False, id="a form that falls off with the order"),
    ],
)
def test_it_is_named_where_it_stands_out_of_the_orders_beside_it(others, stands):
    field = wave(0.004, 2, 0.7) + sum(wave(height, order, 1.0 + order) for height, order in others)
    assert (hidden_among_orders(*fitted(field)) is None) == stands
    fit, problem, model = fitted(field)
    found = eliminate(fit, problem, model, NOISE)
    assert (len(found.model) == 1) == stands
    assert stands or 2 in {pattern.order for pattern in found.patterns}  # it is told as what it is: a wave without a name


STEP = np.where((AT.tooth >= 2) & (AT.tooth < 7), SHAPE, 0.0)
"""A sector of five teeth."""


@pytest.mark.parametrize(
    ("field", "stands"),
    [
        pytest.param(0.004 * STEP, True, id="a sector"),
        pytest.param(0.004 * STEP + wave(0.0004, 2, 0.3), True, id="a sector on a gear that is no circle"),
        pytest.param(wave(0.003, 2, 0.7) + wave(0.003, 1, 0.2), False, id="a form of two orders"),
    ],
)
def test_a_jump_is_one_where_its_waves_belong_together(field, stands):
    """A sector has waves of all orders, a form of few orders some of them alone."""
    noise = NOISE / np.sqrt(COUNT) * np.random.default_rng(2).normal(size=AT.z.shape)
    jumping = Toy("sector", parameters=(angular("start_deg", spread=Spread.JUMP),))
    fit = fit_of(grid(), field + noise, [(jumping, STEP[..., None])], NOISE, COUNT, turns=True)
    problem, model = fit.problem(1.0, None), fit.dictionary.candidates
    assert (hidden_among_orders(fit, problem, model) is None) == stands


@pytest.mark.parametrize("seed", range(8))
def test_noise_beside_it_is_no_form(seed):
    """Small enough that chance in the other orders would hide it, were it not known from the cells how large chance is."""
    assert hidden_among_orders(*fitted(wave(0.0003, 2, 0.2), seed)) is None


def test_of_a_part_of_the_gear_no_order_is_known():
    fit, problem, model = fitted(wave(0.004, 2, 0.7) + wave(0.006, 3, 0.0))
    unseen = grid().on_cells((AT.tooth == 3).astype(float)) > 0.0
    part = type(fit)(fit.cells, fit.target, fit.dictionary, fit.use & ~unseen, fit.covariance)
    assert hidden_among_orders(part, problem, model) is None

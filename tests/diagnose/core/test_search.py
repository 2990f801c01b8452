"""The search on toy dictionaries whose best set of effects is known from trying all of them."""

from itertools import combinations

import numpy as np
import pytest

from gearwear.diagnose.rules import RULES
from gearwear.diagnose.search import exchange, forward, penalty, promising
from tests.diagnose.core.toy import Toy, left, problem

ROWS = 400


def best_of_all(one, most=4):
    """Least cost over every set of at most so many candidates, an effect once at most."""
    sets = [s for n in range(most + 1) for s in combinations(one.dictionary.candidates, n) if len({c.name for c in s}) == n]
    return min(sets, key=one.cost)


def names(model):
    return {candidate.name for candidate in model}


def found(one):
    return exchange(one, forward(one))


def random_problem(seed, correlation):
    """Eight effects of one to three columns that share a common part, three of them there."""
    rng = np.random.default_rng(seed)
    common = rng.normal(size=ROWS)
    blocks = []
    for number in range(8):
        own = rng.normal(size=(ROWS, 1 + number % 3))
        blocks.append((Toy(f"e{number}"), np.sqrt(1 - correlation) * own + np.sqrt(correlation) * common[:, None]))
    there = rng.choice(8, 3, replace=False)
    target = rng.normal(size=ROWS) + sum(blocks[i][1] @ rng.uniform(0.5, 2.0, blocks[i][1].shape[1]) for i in there)
    return problem(rng.normal(size=(ROWS, 2)), blocks, target), {f"e{i}" for i in there}


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("seed", range(6))
def test_finds_the_set_of_least_cost(seed, correlation):
    one, there = random_problem(seed, correlation)
    best = best_of_all(one)
    assert one.cost(found(one)) == pytest.approx(one.cost(best), rel=1e-9)
    assert names(found(one)) == names(best) == there


def test_cost_is_the_dense_rest_and_the_penalties():
    one, _ = random_problem(1, 0.5)
    some = one.dictionary.candidates[:3]
    columns = one.dictionary.columns[:, one.columns(some)]
    # The target itself from its statistics: its part outside all columns is the same for every set.
    every = one.dictionary.columns
    amplitudes = np.linalg.lstsq(every.T @ every, one.gram.moment[0], rcond=None)[0]
    outside = one.gram.square.sum() - np.sum((every @ amplitudes) ** 2)
    expected = left(columns, every @ amplitudes) + outside + sum(penalty(c) for c in some)
    assert one.cost(some) == pytest.approx(expected, rel=1e-7)


def decoy_problem():
    """Two effects that together are the target, and a third that is nearer to it than either and explains nothing beside both."""
    rng = np.random.default_rng(7)
    a, b, noise = np.linalg.qr(rng.normal(size=(ROWS, 3)))[0].T
    decoy = a + b + 0.35 * np.linalg.norm(a + b) * noise
    target = 40.0 * (a + b) + rng.normal(size=ROWS)
    return problem(np.ones((ROWS, 1)), [(Toy("a"), a[:, None]), (Toy("b"), b[:, None]), (Toy("decoy"), decoy[:, None])], target)


def test_exchange_takes_out_the_decoy_that_greed_took_first():
    one = decoy_problem()
    greedy = forward(one)
    assert greedy[0].name == "decoy"
    assert names(exchange(one, greedy)) == names(best_of_all(one)) == {"a", "b"}


def test_one_effect_takes_the_place_of_two_that_stand_in_for_it():
    rng = np.random.default_rng(8)
    q = np.linalg.qr(rng.normal(size=(ROWS, 4)))[0]
    whole = q[:, 0] + q[:, 1]
    target = 40.0 * whole + rng.normal(size=ROWS)
    blocks = [(Toy("low"), q[:, [0]]), (Toy("high"), q[:, [1]]), (Toy("whole"), whole[:, None])]
    one = problem(np.ones((ROWS, 1)), blocks, target)
    pair = one.dictionary.candidates[:2]
    assert names(exchange(one, pair)) == names(best_of_all(one)) == {"whole"}


def test_two_effects_take_the_place_of_one_that_stands_in_for_them():
    one = decoy_problem()
    assert names(exchange(one, (one.dictionary.candidates[2],))) == {"a", "b"}


def test_noise_alone_is_left_alone():
    rng = np.random.default_rng(9)
    taken = 0
    for _ in range(40):
        blocks = [(Toy(f"e{i}"), rng.normal(size=(ROWS, 1 + i % 3))) for i in range(8)]
        taken += len(found(problem(np.ones((ROWS, 1)), blocks, rng.normal(size=ROWS))))
    # An effect of one column must gain 11 where chance gives χ²₁: P = 0.9 ‰, of 320 tries 0.3; of more columns it is rarer still.
    assert taken <= 2


def test_correlated_noise_raises_the_price_by_its_unit():
    rng = np.random.default_rng(10)
    block = [(Toy("e"), np.repeat(rng.normal(size=(ROWS // 20, 1)), 20, axis=0))]
    target = np.repeat(rng.normal(size=ROWS // 20), 20)
    gain = left(np.ones((ROWS, 1)), target) - left(np.column_stack([np.ones(ROWS), block[0][1]]), target)
    price = penalty(problem(np.ones((ROWS, 1)), block, target).dictionary.candidates[0])
    for unit, taken in ((0.99 * gain / price, True), (1.01 * gain / price, False)):
        assert bool(found(problem(np.ones((ROWS, 1)), block, target, unit))) is taken


def test_what_cannot_be_is_not_chosen_however_well_it_fits():
    rng = np.random.default_rng(11)
    x = rng.normal(size=(ROWS, 1))
    near = x + 0.5 * rng.normal(size=(ROWS, 1))
    blocks = [(Toy("positive", low=0.0), x), (Toy("free"), near)]
    one = problem(np.ones((ROWS, 1)), blocks, -3.0 * x[:, 0] + 0.1 * rng.normal(size=ROWS))
    assert one.cost(one.dictionary.candidates[:1]) == np.inf
    assert names(found(one)) == {"free"}


def test_a_model_that_became_impossible_is_left_for_the_best_there_is():
    """Three effects whose sign cannot be: no single move, and no swap of two, leads out of it."""
    rng = np.random.default_rng(14)
    q = np.linalg.qr(rng.normal(size=(ROWS, 5)))[0]
    blocks = [(Toy(f"up{i}", low=0.0), q[:, [i]]) for i in range(3)] + [(Toy("a"), q[:, [3]]), (Toy("b"), q[:, [4]])]
    one = problem(np.ones((ROWS, 1)), blocks, q @ np.array([-30.0, -30.0, -30.0, 30.0, 30.0]) + rng.normal(size=ROWS))
    wrong = one.dictionary.candidates[:4]
    assert one.cost(wrong) == np.inf
    assert names(one.possible_part(wrong)) == {"a"}
    assert names(exchange(one, wrong)) == names(best_of_all(one)) == {"a", "b"}


def test_an_effect_is_taken_once_in_its_best_shape():
    rng = np.random.default_rng(12)
    shapes = rng.normal(size=(3, ROWS, 1))
    toy = Toy("shaped")
    target = 2.0 * shapes[1, :, 0] + 1.0 * shapes[2, :, 0] + rng.normal(size=ROWS)
    one = problem(np.ones((ROWS, 1)), [(toy, shape) for shape in shapes], target)
    (only,) = found(one)
    assert only.shape == (1.0,)
    assert [c.shape for c in promising(one, (), 5)] == [(1.0,)]


def test_as_many_effects_are_taken_as_are_worth_their_price():
    """A gear of class 8 with levels of the drawing needs a dozen: an end to their number made wear of what it left out."""
    rng = np.random.default_rng(13)
    q = np.linalg.qr(rng.normal(size=(ROWS, 12)))[0]
    blocks = [(Toy(f"e{i}"), q[:, [i]]) for i in range(12)]
    size = np.r_[np.linspace(50.0, 100.0, 10), 0.5 * np.sqrt(RULES.effect_penalty + RULES.parameter_penalty) * np.ones(2)]
    one = problem(np.zeros((ROWS, 0)), blocks, q @ size)
    assert names(forward(one)) == {f"e{i}" for i in range(10)}


def test_parameters_and_shape_values_have_a_price():
    toy = Toy("shaped")
    wide = problem(
        np.ones((5, 1)),
        [(Toy("one"), np.eye(5)[:, :1]), (Toy("two"), np.eye(5)[:, :2]), (toy, np.eye(5)[:, :1]), (toy, np.eye(5)[:, 1:2])],
        np.ones(5),
    )
    one, two, shaped, _ = (penalty(c) for c in wide.dictionary.candidates)
    assert 0.0 < one < two < shaped + 10.0 and shaped > one


def test_an_amount_that_no_cell_speaks_of_is_free():
    columns = np.zeros((6, 2))
    columns[:, 0] = np.arange(6)
    one = problem(np.ones((6, 1)), [(Toy("both sides"), columns)], np.arange(6.0))
    assert one.penalty(one.dictionary.candidates[0]) == RULES.effect_penalty + RULES.parameter_penalty

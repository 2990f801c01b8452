"""Flanks worn all over, from levels alone: depths put in are asked back, and what goes up as far as down is none."""

import math

import numpy as np
import pytest

from gearwear.design.surface import locate
from gearwear.diagnose import worn_flanks
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.worn_flanks import Levels, low_flanks, waves
from gearwear.placing.cells import CellGrid, bin_points, noise
from tests.diagnose.plain import PLAIN_AND_ALL
from tests.placing.placing import designed
from tests.synthetic import AbrasiveWear, Recipe, make_scan

PINION = designed()

NOISE = 0.4e-3
"""Standard deviation of a level, mm."""
DEPTH = 0.02


def levels(left: np.ndarray, right: np.ndarray) -> Levels:
    """Of gears whose pose is free: either side's own level, and a shift across the axis, which moves flanks as their normals point."""
    teeth = len(left)
    angle, lean = 2.0 * math.pi * np.arange(teeth) / teeth, math.radians(20.0 + 90.0 / teeth)
    base = np.zeros((2 * teeth, 4))
    for half, sign in ((0, 1.0), (1, -1.0)):
        normal = angle + sign * (0.5 * math.pi - lean)
        base[half::2] = np.column_stack([np.full(teeth, half == 0), np.full(teeth, half == 1), np.cos(normal), np.sin(normal)])
    value = np.column_stack([left, right]).ravel()
    basis = np.linalg.qr(base)[0]
    return Levels(np.arange(teeth), teeth, value / NOISE, basis, (), tuple(waves(np.arange(teeth), teeth, np.full(2, NOISE))))


def scatter(
    seed: int, teeth: int, left: float = NOISE, right: float = NOISE, index: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Levels that teeth are made with: each flank by itself, and both of a tooth in opposite senses."""
    random = np.random.default_rng(seed)
    own, off = random.normal(size=(2, teeth)), index * random.normal(size=teeth)
    return left * own[0] + off, right * own[1] - off


def places(teeth: np.ndarray, half: int) -> tuple[int, ...]:
    return tuple(sorted((2 * teeth + half).tolist()))


@pytest.mark.parametrize(("teeth", "step"), [(24, 3), (36, 3), (36, 4), (25, 6), (18, 6)])
@pytest.mark.parametrize("half", [0, pytest.param(1, marks=pytest.mark.long)])
def test_every_so_many_flanks_of_a_side(teeth, step, half):
    """They could be waves of one side alone, which nothing makes."""
    sides, worn = scatter(teeth, teeth), np.arange(0, teeth - teeth % step, step)
    sides[half][worn] -= DEPTH
    assert low_flanks(levels(*sides)) == places(worn, half)


@pytest.mark.parametrize("teeth", [20, 36])
def test_every_second_flank_is_an_error_of_the_index_too_where_no_fillets_tell(teeth):
    """Of half as many waves as teeth, whose nodes are the flanks of the other side: a quarter of a pitch off the middle of a tooth."""
    left, right = scatter(teeth, teeth)
    left[::2] -= DEPTH
    assert low_flanks(levels(left, right)) == ()


@pytest.mark.parametrize("seed", range(4))
def test_each_by_its_own_depth_beside_errors_of_index(seed):
    random = np.random.default_rng(seed)
    sides, worn = scatter(seed, 22, index=0.004), random.permutation(22)[: random.integers(3, 10)]
    sides[0][worn] -= random.uniform(0.6, 1.4, len(worn)) * 2.0 * DEPTH
    assert low_flanks(levels(*sides)) == places(worn, 0)


@pytest.mark.parametrize("sense", [1.0, pytest.param(-1.0, marks=pytest.mark.long)])
@pytest.mark.parametrize("order", [1.0, 3.4, 4.0, 7.3, 11.0])
def test_waves_of_both_sides_are_no_wear(order, sense):
    """Whole or not, alike or opposite."""
    left, right = scatter(7, 24)
    wave = DEPTH * np.cos(2.0 * math.pi * order * np.arange(24) / 24 + 0.7)
    assert low_flanks(levels(left + wave, right + sense * wave)) == ()


@pytest.mark.parametrize(("order", "phase"), [(5.0, 0.4), (8.0, 0.4), (2.0, 0.0)])
def test_a_wave_of_one_side_that_is_not_of_two_levels_is_no_wear(order, phase):
    left, right = scatter(8, 24)
    left += DEPTH * np.cos(2.0 * math.pi * order * np.arange(24) / 24 + phase)
    assert low_flanks(levels(left, right)) == ()


@pytest.mark.long
def test_scatter_is_no_wear():
    """Of 60 gears whose teeth scatter in several ways at most 2: more than the 1 % of p below which effects are accepted has a chance of 2 %."""
    kinds = [{}, {"index": 0.006}, {"left": 0.004}, {"left": 0.003, "right": 0.003}]
    found = [low_flanks(levels(*scatter(seed, 18 + seed % 9, **kinds[seed % 4]))) for seed in range(60)]
    assert sum(bool(one) for one in found) <= 2


def with_fillets(value: np.ndarray) -> Levels:
    """Of flanks and fillets, (n, 4); the pose shifts across the axis."""
    teeth = len(value)
    angle, lean = 2.0 * math.pi * np.arange(teeth) / teeth, math.radians(20.0 + 90.0 / teeth)
    base = np.zeros((4 * teeth, 6))
    for surface, sign in enumerate((1.0, -1.0, 1.0, -1.0)):
        normal = angle + sign * (0.5 * math.pi - lean)
        base[surface::4, surface] = 1.0
        base[surface::4, 4:] = np.column_stack([np.cos(normal), np.sin(normal)])
    every = tuple(waves(np.arange(teeth), teeth, np.full(4, NOISE)))
    return Levels(np.arange(teeth), teeth, value.ravel() / NOISE, np.linalg.qr(base)[0], (), every, wide=4)


@pytest.mark.long
def test_beside_two_worn_flanks_of_twelve_teeth_no_other_is_called_worn():
    """A covariance of four surfaces, told by twelve teeth, follows whichever lies off: 6 of these 40 named others too where that was not counted."""
    others, worn = 0, [3, 4]
    for seed in range(40):
        random = np.random.default_rng(seed)
        own, together = random.normal(size=(12, 4)), random.normal(size=(12, 2))
        value = 3.0 * NOISE * math.sqrt(0.5) * (own + together[:, [0, 1, 0, 1]])
        value[worn, 1] -= 0.4 * DEPTH
        others += bool(set(low_flanks(with_fillets(value))) - {4 * tooth + 1 for tooth in worn})
    assert others <= 2


def test_a_side_of_which_every_flank_lost_its_share_is_not_some_of_it():
    for seed in range(6):
        left, right = scatter(seed, 24)
        left -= DEPTH * np.random.default_rng(seed).uniform(0.6, 1.4, 24)
        assert low_flanks(levels(left, right)) == ()


def test_metal_does_not_come_back():
    """What is high on as many flanks is not what the others lost."""
    left, right = scatter(3, 24)
    left[::4] += DEPTH
    assert low_flanks(levels(left, right)) == ()


@PLAIN_AND_ALL
@pytest.mark.parametrize("step", [3, pytest.param(2, marks=pytest.mark.long)])
def test_worn_flanks_at_even_steps_are_neither_waves_nor_effects(step, effects):
    """In a scan whose wear is put in by code that shares nothing with the fit; without them the others tell of nothing else."""
    worn = tuple(range(1, 12, step))
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=(AbrasiveWear(12.0, 1, worn),)).of_size(20_000), 5)
    located = locate(scan.points, PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=0.3)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), effects)
    assert ([effect.name for effect in loop.effects], loop.patterns, loop.worn_sides, loop.others) == ([], (), frozenset(), ())
    assert [tuple(place) for place in np.argwhere(loop.worn_flanks)] == [(tooth, 0) for tooth in worn]


def test_no_model_is_fitted_twice(monkeypatch):
    """Searches from five starts come by the same models, and by most of them more than once."""
    asked = list[tuple[bytes, tuple[int, ...]]]()

    def counted(of, columns, low=(), fitted=worn_flanks._fitted):
        asked.append((columns.tobytes(), low))
        return fitted(of, columns, low)

    monkeypatch.setattr(worn_flanks, "_fitted", counted)
    left, right = scatter(3, 24)
    left[[4, 9, 10]] -= DEPTH
    assert low_flanks(levels(left, right)) == places(np.array([4, 9, 10]), 0)
    # Without any flank apart they are asked for twice: with waves that have no cause, and without.
    beside = [one for one in asked if one[1]]
    assert len(beside) == len(set(beside)) > 20


def test_a_flank_with_a_depth_of_its_own_tells_nothing_else():
    """However deep it lies, its depth takes it up: cost and what the other flanks show stay. Both flanks of tooth 3 are low."""
    left, right = scatter(5, 20, index=0.004)
    low = (4, 6, 7, 11, 30)
    plain = levels(left, right).explained(low=low)
    moved = levels(left, right)
    moved.value[list(low)] -= np.arange(1.0, 6.0) * 50.0
    deep = moved.explained(low=low)
    others = np.setdiff1d(np.arange(20), np.array(low) // 2)
    assert deep._with_own.misfit == pytest.approx(plain._with_own.misfit, rel=1e-6)
    np.testing.assert_allclose(deep.below[others], plain.below[others], atol=1e-4)
    sunk = np.subtract(deep._with_own.amplitudes, plain._with_own.amplitudes)
    np.testing.assert_allclose(sunk, [0.0] * 4 + [50.0, 100.0, 150.0, 200.0, 250.0], atol=1e-4)

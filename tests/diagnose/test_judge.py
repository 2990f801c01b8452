"""Judging on toy dictionaries, where what each effect explains is put in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from gearwear.diagnose.columns import CellColumns
from gearwear.diagnose.dictionary import Candidate, Dictionary
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.judge import Evidence, alternatives, judge
from gearwear.diagnose.search import Problem


@dataclass(frozen=True)
class Toy:
    """An effect whose every amplitude is allowed."""

    name: str
    tooth_specific: bool = False
    kind: Kind = Kind.MANUFACTURE

    def allowed(self, amplitudes, shape, context) -> bool:
        return True

    def tolerance(self, context) -> None:
        return None


@dataclass(frozen=True)
class White:
    """Cells that err by themselves."""

    white: np.ndarray
    weight: np.ndarray
    texture = 0.0

    def apply(self, values):
        return self.white[:, None] * values


CELLS, FOLDS = 2400, 24
RANDOM = np.random.default_rng(7)
COLUMNS = np.linalg.qr(RANDOM.normal(size=(CELLS, 20)))[0] * np.sqrt(CELLS)
"""Orthogonal, each of root mean square 1: an amplitude is what its effect explains."""


def problem_of(blocks: dict[str, np.ndarray], target: np.ndarray) -> tuple[Problem, Gram]:
    """One pose column, a candidate of each block; all cells weigh 1. And the statistics fold by fold."""
    pose = COLUMNS[:, :1]
    columns, candidates = [pose], []
    start = 1
    for name, block in blocks.items():
        candidates.append(Candidate(Toy(name), (), np.arange(start, start + block.shape[1])))
        columns.append(block)
        start += block.shape[1]
    whole = np.hstack(columns)
    weight, fold = np.ones(CELLS), np.arange(CELLS) % FOLDS
    gram, folded = (Gram.of(whole, target, weight, which, n) for which, n in ((0 * fold, 1), (fold, FOLDS)))
    return Problem(
        Dictionary(CellColumns.of(whole, np.array([0])), np.arange(1), np.arange(1), tuple(candidates)), gram, 1e-8, None
    ), folded


@pytest.mark.parametrize(("extra", "named"), [(0, True), (3, True), (4, False)])
def test_an_alternative_needs_at_most_three_amplitudes_more(extra, named):
    """It holds the named effect's column and so explains all it does; with many more it would explain anything."""
    other = COLUMNS[:, 2 : 3 + extra] + COLUMNS[:, 1:2]
    other[:, 0] = COLUMNS[:, 1] + 0.001 * COLUMNS[:, 2]
    problem, _ = problem_of({"found": COLUMNS[:, 1:2], "other": other}, 0.01 * COLUMNS[:, 1])
    chosen = problem.dictionary.candidates[:1]
    assert alternatives(problem, chosen, 0) == (("other",) if named else ())


@pytest.mark.parametrize(("share", "named"), [(0.98, True), (0.96, False)])
def test_an_alternative_explains_97_per_cent_of_what_the_named_effect_does(share, named):
    """A column at an angle whose squared cosine is that share."""
    other = np.sqrt(share) * COLUMNS[:, 1:2] + np.sqrt(1.0 - share) * COLUMNS[:, 2:3]
    problem, _ = problem_of({"found": COLUMNS[:, 1:2], "other": other}, 0.01 * COLUMNS[:, 1])
    assert alternatives(problem, problem.dictionary.candidates[:1], 0) == (("other",) if named else ())


SCATTER = 1e-5
"""mm."""


def judged(amounts: tuple[float, ...], noise: float) -> list[Evidence]:
    """What some effects of these sizes, mm, far above their own scatter, are worth at a noise of points."""
    target = COLUMNS[:, 1 : 1 + len(amounts)] @ np.array(amounts) + SCATTER * np.random.default_rng(1).normal(size=CELLS)
    problem, _ = problem_of({f"e{i}": COLUMNS[:, 1 + i : 2 + i] for i in range(len(amounts))}, target)
    chosen = problem.dictionary.candidates
    which = problem.columns(chosen)
    folded = Gram.of(problem.dictionary.columns[:, which], target, np.ones(CELLS), np.arange(CELLS) % FOLDS, FOLDS)
    white = White(np.full(CELLS, SCATTER**2), np.ones(CELLS))
    use = np.ones(CELLS, dtype=bool)
    return [judge(problem, chosen, i, use, white, folded, noise) for i in range(len(chosen))]


@pytest.mark.parametrize(("times", "held"), [(0.95, False), (1.05, True)])
def test_an_effect_is_no_smaller_than_six_hundredths_of_the_noise(times, held):
    """The same effect, as sure in both cases, beside a noise of points that makes it too small or not."""
    (found,) = judged((0.001,), 0.001 / (0.06 * times))
    assert (found.accepted, found.faint) == (held, not held)


@pytest.mark.parametrize(("times", "held"), [(0.95, False), (1.05, True)])
def test_an_effect_is_no_smaller_than_a_hundredth_of_the_model(times, held):
    found = judged((0.1, 0.001 * times), 1e-6)
    assert [one.accepted for one in found] == [True, held]
    assert not any(one.faint for one in found)  # a second order of the other is no effect of its own, however small


@pytest.mark.parametrize(("error", "told"), [(0.1, True), (0.5, False), (None, False)])
def test_where_folds_are_blocks_of_every_tooth_the_teeth_tell_what_is_chance(error, told):
    """Six folds that show 0.4 and 1.6 of an effect in turn: alone they are too few; thirty teeth that differ by a tenth of it are not."""
    fold = np.arange(CELLS) % 6
    target = np.where(fold % 2, 0.016, 0.004) * COLUMNS[:, 1] + SCATTER * np.random.default_rng(2).normal(size=CELLS)
    problem, _ = problem_of({"found": COLUMNS[:, 1:2], "other": COLUMNS[:, 2:3]}, target)
    chosen = problem.dictionary.candidates[:1]
    folded = Gram.of(problem.dictionary.columns[:, problem.columns(chosen)], target, np.ones(CELLS), fold, 6)
    scatter = np.full(CELLS, 0.006**2)
    by_teeth = None if error is None else (error, 30.0)
    found = judge(problem, chosen, 0, np.ones(CELLS, dtype=bool), White(scatter, np.ones(CELLS)), folded, 0.001, by_teeth)
    assert abs(found.shown - 1.0) < 0.1
    assert found.accepted == told

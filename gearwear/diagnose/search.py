"""Which effects together explain a scan: forward to the floor, then exchange and elimination under a corrected criterion.

Several effects at once each look insignificant against what the others leave, so nothing is judged on the way; the judging
(`judge`) comes after, with the covariance estimated again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.dictionary import Candidate, Dictionary
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules


@dataclass(frozen=True, slots=True)
class Problem:
    """A dictionary with its statistics under one set of weights.

    Parameters
    ----------
    dictionary : Dictionary
    gram : Gram
    unit : float
        Expected gain of a column that explains nothing (the design effect of correlation; 1 for independent cells).
    context : Context
    always : frozenset of str
        Names of candidates that no move may drop: what is known to be there.
    """

    dictionary: Dictionary
    gram: Gram
    unit: float
    context: Context
    always: frozenset[str] = frozenset()

    def columns(self, chosen: tuple[Candidate, ...]) -> Ints:
        """Pose columns and those of the chosen candidates."""
        return np.concatenate([self.dictionary.pose, *(c.columns for c in chosen)]).astype(np.int64)

    def cost(self, chosen: tuple[Candidate, ...]) -> float:
        """Corrected sum of squares and penalties; infinite where an amplitude is physically impossible."""
        which = self.columns(chosen)
        amplitudes, _ = self.gram.solve(which)
        if not self.possible(chosen, amplitudes):
            return math.inf
        square = float(self.gram.square.sum() - amplitudes @ self.gram.moment.sum(axis=0)[which])
        return square / self.unit + sum(self.penalty(c) for c in chosen)

    def penalty(self, candidate: Candidate) -> float:
        """`penalty`; what is known to be there costs nothing."""
        return 0.0 if candidate.name in self.always else penalty(candidate)

    def keeps(self, chosen: tuple[Candidate, ...]) -> bool:
        """Whether what is known to be there is in."""
        return self.always <= {c.name for c in chosen}

    def with_known(self, chosen: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        """`chosen` with what is known to be there."""
        names = {c.name for c in chosen}
        return (*chosen, *(c for c in self.dictionary.candidates if c.name in self.always - names))

    def within_tolerance(self, chosen: tuple[Candidate, ...]) -> bool:
        """Whether every level that the drawing leaves open lies within its tolerance."""
        amplitudes, _ = self.gram.solve(self.columns(chosen))
        at = len(self.dictionary.pose)
        for candidate in chosen:
            size = len(candidate.columns)
            limit = candidate.effect.tolerance(self.context)
            if limit is not None and np.abs(amplitudes[at : at + size]).max() > limit:
                return False
            at += size
        return True

    def possible(self, chosen: tuple[Candidate, ...], amplitudes: Floats) -> bool:
        """Whether every effect's sign and size are allowed."""
        at = len(self.dictionary.pose)
        for candidate in chosen:
            size = len(candidate.columns)
            if not candidate.effect.allowed(amplitudes[at : at + size], candidate.shape, self.context):
                return False
            at += size
        return True


def penalty(candidate: Candidate) -> float:
    """What a candidate must be worth; shape values count as parameters."""
    return free_penalty(len(candidate.columns)) + rules().parameter_penalty * rules().shape_price * len(candidate.shape)


def penalties(candidates: Sequence[Candidate]) -> Floats:
    """`penalty` of each, (n,)."""
    kinds = [(len(c.columns), len(c.shape)) for c in candidates]
    prices = {kind: penalty(c) for kind, c in dict(zip(kinds, candidates, strict=True)).items()}
    return np.array([prices[kind] for kind in kinds])


def free_penalty(columns: int) -> float:
    """What an effect of so many amplitudes must be worth."""
    return rules().effect_penalty + rules().parameter_penalty * columns


def forward(problem: Problem, chosen: tuple[Candidate, ...] = ()) -> tuple[Candidate, ...]:
    """Add the candidate that lowers the cost most until none does.

    Effects with a freedom for every tooth come last: early on they soak up whatever goes round the gear.
    """
    for by_tooth in (False, True):
        while len(chosen) < rules().most_effects:
            best = _best_addition(problem, chosen, by_tooth)
            if best is None:
                break
            chosen = (*chosen, best)
    return chosen


def _best_addition(problem: Problem, chosen: tuple[Candidate, ...], by_tooth: bool) -> Candidate | None:
    """The addition that lowers the cost most, with or without those of a freedom for every tooth; None where none does."""
    names = {c.name for c in chosen}
    open_ = [c for c in problem.dictionary.candidates if c.name not in names and (by_tooth or not c.effect.tooth_specific)]
    gains = problem.gram.gains(problem.columns(chosen), [c.columns for c in open_])
    worth = gains / problem.unit - penalties(open_)
    for index in map(int, np.argsort(-worth)):
        if worth[index] <= 0.0:
            break
        if math.isfinite(problem.cost((*chosen, open_[index]))):
            return open_[index]
    return None


def exchange(problem: Problem, chosen: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
    """Drop, swap and add until no single move, and no swap of one for two or two for one, lowers the cost."""
    cost = problem.cost(chosen)
    while True:
        best, least = chosen, cost
        for option in _moves(problem, chosen):
            value = problem.cost(option)
            if value < least - 1e-6:
                best, least = option, value
        if best is chosen:
            return chosen
        chosen, cost = best, least


def _moves(problem: Problem, chosen: tuple[Candidate, ...]) -> list[tuple[Candidate, ...]]:
    """Neighbours of a set of effects; swaps are tried for the few candidates that gain most in each place."""
    moves: list[tuple[Candidate, ...]] = []
    every = range(len(chosen))
    for i in every:
        rest = chosen[:i] + chosen[i + 1 :]
        moves.append(rest)
        near = promising(problem, rest, rules().tried)
        moves += [(*rest, c) for c in near]
        for first in near:
            moves += [(*rest, first, c) for c in promising(problem, (*rest, first), rules().tried)]
        for j in range(i + 1, len(chosen)):
            pair = chosen[:i] + chosen[i + 1 : j] + chosen[j + 1 :]
            moves += [(*pair, c) for c in promising(problem, pair, rules().tried)]
    moves += [(*chosen, c) for c in promising(problem, chosen, rules().tried)]
    return [move for move in moves if len(move) <= rules().most_effects + 1 and problem.keeps(move)]


def promising(problem: Problem, base: tuple[Candidate, ...], count: int) -> list[Candidate]:
    """Candidates of greatest net gain over `base`, the best shape of each effect only."""
    names = {c.name for c in base}
    open_ = [c for c in problem.dictionary.candidates if c.name not in names]
    gains = problem.gram.gains(problem.columns(base), [c.columns for c in open_]) / problem.unit
    hopeful = np.flatnonzero(gains > free_penalty(0))  # most gain less than the least that any costs
    net = gains[hopeful] - penalties([open_[index] for index in hopeful])
    found: dict[str, Candidate] = {}
    for place in np.argsort(net)[::-1]:
        if net[place] <= 0.0 or len(found) == count:
            break
        candidate = open_[hopeful[place]]
        found.setdefault(candidate.name, candidate)
    return list(found.values())

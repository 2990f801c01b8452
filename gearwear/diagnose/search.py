"""Which effects together explain a scan: forward to the floor, then exchange and elimination under a corrected criterion.

Several effects at once each look insignificant against what the others leave, so nothing is judged on the way; the judging
(`judge`) comes after, with the covariance estimated again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.diagnose.beside import MANY, NOTHING, Beside
from gearwear.diagnose.dictionary import Candidate, Dictionary
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules


@dataclass(frozen=True)
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

    @cached_property
    def beside_pose(self) -> Beside:
        """What the candidates hold beside the pose, which is in every fit."""
        return self.gram.beside(self.dictionary.pose, [c.columns for c in self.dictionary.candidates])

    @cached_property
    def _beside_many(self) -> dict[tuple[int, ...], Beside]:
        """The same beside candidates of many columns besides, which are solved for once; by their columns."""
        return {(): self.beside_pose}

    @cached_property
    def prices(self) -> Floats:
        """What all candidates must be worth, (n,)."""
        return np.array([penalty(c, self.seen) for c in self.dictionary.candidates])

    @cached_property
    def seen(self) -> Bools:
        """Columns that the cells speak of: an amount for flanks that nobody could use is no freedom."""
        return np.asarray(np.einsum("tii->i", self.gram.information) > 0.0)

    @cached_property
    def _of_name(self) -> dict[str, int]:
        """Numbers of the effects, in the order of their first candidates."""
        return {name: i for i, name in enumerate(dict.fromkeys(c.name for c in self.dictionary.candidates))}

    @cached_property
    def _effects(self) -> Ints:
        """Which effect each candidate is a shape of, (n,)."""
        return np.array([self._of_name[c.name] for c in self.dictionary.candidates], dtype=np.int64)

    @cached_property
    def by_name(self) -> tuple[Ints, Ints]:
        """All candidates, those of one effect behind one another, and where each effect begins; and behind the last."""
        ends = np.cumsum(np.bincount(self._effects, minlength=len(self._of_name)), dtype=np.int64)
        return np.argsort(self._effects, kind="stable"), np.concatenate([[0], ends])

    @cached_property
    def _columns_of(self) -> dict[int, tuple[int, ...]]:
        """Columns of the candidates that were asked for, by the first of them."""
        return {}

    def _columns(self, candidate: Candidate) -> tuple[int, ...]:
        if candidate.first not in self._columns_of:
            self._columns_of[candidate.first] = tuple(candidate.columns.tolist())
        return self._columns_of[candidate.first]

    def gains(self, base: tuple[Candidate, ...]) -> Floats:
        """Fall of the sum of squares with each candidate added to `base`, (n,); 0 for other shapes of its effects."""
        gains: Floats = self.tried([base])[1][0]
        return gains

    def tried(self, bases: Sequence[tuple[Candidate, ...]]) -> tuple[Floats, Floats]:
        """Of each of some models the sum of squares that it and the pose leave, (k,), and the fall of it with each candidate added, (k, n); 0 for
        other shapes of its effects."""
        squares, gains = np.zeros(len(bases)), np.zeros((len(bases), len(self.dictionary.candidates)))
        alike, few, named = (
            dict[tuple[int, ...], list[int]](),
            list[tuple[int, ...]](),
            np.zeros((len(bases), len(self._of_name)), np.bool_),
        )
        for i, base in enumerate(bases):
            own, many = tuple[int, ...](), tuple[int, ...]()
            for candidate in base:
                columns = self._columns(candidate)
                own, many = (own, many + columns) if len(columns) >= MANY else (own + columns, many)
            few.append(own)
            alike.setdefault(many, []).append(i)
            named[i, [self._of_name[candidate.name] for candidate in base]] = True
        for columns, at in alike.items():
            if columns not in self._beside_many:
                self._beside_many[columns] = self.beside_pose.beside(np.array(columns))
            most = max(len(few[i]) for i in at)
            together = np.array([few[i] + (NOTHING,) * (most - len(few[i])) for i in at], dtype=np.int64)
            squares[at], gains[at] = self._beside_many[columns].tried(together)
        gains[named[:, self._effects]] = 0.0
        return squares, gains

    def fitted(self, chosen: tuple[Candidate, ...]) -> tuple[Floats, float]:
        """Amplitudes of the chosen candidates, and the sum of squares that they and the pose leave."""
        return self.beside_pose.fit(_own_columns(chosen))

    def cost(self, chosen: tuple[Candidate, ...]) -> float:
        """Corrected sum of squares and penalties; infinite where an amplitude is physically impossible."""
        amplitudes, square = self.fitted(chosen)
        if not self.possible(chosen, amplitudes):
            return math.inf
        return square / self.unit + sum(self.penalty(c) for c in chosen)

    def penalty(self, candidate: Candidate) -> float:
        """`penalty`; what is known to be there costs nothing."""
        return 0.0 if candidate.name in self.always else penalty(candidate, self.seen)

    def keeps(self, chosen: tuple[Candidate, ...]) -> bool:
        """Whether what is known to be there is in."""
        return self.always <= {c.name for c in chosen}

    def with_known(self, chosen: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        """`chosen` with what is known to be there."""
        names = {c.name for c in chosen}
        return (*chosen, *(c for c in self.dictionary.candidates if c.name in self.always - names))

    def with_offsets(self, chosen: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        """`chosen` with every surface's own offset: no surface is torn because it lies off the drawn one throughout."""
        names = {candidate.name for candidate in chosen}
        return (*chosen, *(offset for offset in self.dictionary.offsets if offset.name not in names))

    def within_tolerance(self, chosen: tuple[Candidate, ...]) -> bool:
        """Whether every level that the drawing leaves open lies within its tolerance."""
        amplitudes, at = self.fitted(chosen)[0], 0
        for candidate in chosen:
            size = len(candidate.columns)
            limit = candidate.effect.tolerance(self.context)
            if limit is not None and np.abs(amplitudes[at : at + size]).max() > limit:
                return False
            at += size
        return True

    def possible(self, chosen: tuple[Candidate, ...], amplitudes: Floats) -> bool:
        """Whether every effect's sign and size are allowed; `amplitudes` are those of the chosen, in turn."""
        return all(self._allowed(chosen, amplitudes))

    def _allowed(self, chosen: tuple[Candidate, ...], amplitudes: Floats) -> Iterator[bool]:
        """Of each effect whether its sign and size are."""
        at = 0
        for candidate in chosen:
            size = len(candidate.columns)
            yield candidate.effect.allowed(amplitudes[at : at + size], candidate.shape, self.context)
            at += size

    def possible_part(self, chosen: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        """`chosen` without effects whose sign or size is not allowed beside the others; what is known to be there stays."""
        while True:
            allowed = self._allowed(chosen, self.fitted(chosen)[0])
            left = tuple(c for c, is_allowed in zip(chosen, allowed, strict=True) if is_allowed or c.name in self.always)
            if len(left) == len(chosen):
                return left
            chosen = left


def penalty(candidate: Candidate, seen: Bools | None = None) -> float:
    """What a candidate must be worth: each of its columns, or those that are `seen`; shape values count as parameters."""
    columns = len(candidate.columns) if seen is None else int(np.count_nonzero(seen[candidate.columns]))
    return free_penalty(columns) + rules().parameter_penalty * rules().shape_price * len(candidate.shape)


def _own_columns(chosen: tuple[Candidate, ...]) -> Ints:
    """Columns of some candidates."""
    return np.concatenate([c.columns for c in chosen]) if chosen else np.zeros(0, np.int64)


def free_penalty(columns: int) -> float:
    """What an effect of so many amplitudes must be worth."""
    return rules().effect_penalty + rules().parameter_penalty * columns


def forward(problem: Problem, chosen: tuple[Candidate, ...] = ()) -> tuple[Candidate, ...]:
    """Add the candidate that lowers the cost most until none does.

    Effects with a freedom for every tooth come last: early on they soak up whatever goes round the gear.
    """
    for by_tooth in (False, True):
        while (best := _best_addition(problem, chosen, by_tooth)) is not None:
            chosen = (*chosen, best)
    return chosen


def _best_addition(problem: Problem, chosen: tuple[Candidate, ...], by_tooth: bool) -> Candidate | None:
    """The addition that lowers the cost most, with or without those of a freedom for every tooth; None where none does."""
    worth = problem.gains(chosen) / problem.unit - problem.prices
    for index in map(int, np.argsort(-worth)):
        if worth[index] <= 0.0:
            break
        candidate = problem.dictionary.candidates[index]
        if (by_tooth or not candidate.effect.tooth_specific) and math.isfinite(problem.cost((*chosen, candidate))):
            return candidate
    return None


def exchange(problem: Problem, chosen: tuple[Candidate, ...], around: Around | None = None) -> tuple[Candidate, ...]:
    """Drop, swap and add until no single move, and no swap of one for two or two for one, lowers the cost; `around` is what searches of this problem
    from other starts found out, to which it adds. Of a model from which no move leads to one that is possible, as on cells that have become fewer, the
    effects go that are not."""
    around = around or Around(problem, {}, {}, {})  # neighbours share most of their own
    cost = around.cost(chosen)
    while True:
        best, least = chosen, cost
        for option, about in _moves(problem, chosen, around):
            # What a move comes to is known from what it gains; whether its amplitudes are possible is asked where it would be taken.
            if about < least and (value := around.cost(option)) < least - 1e-6:
                best, least = option, value
        if best is chosen:
            best = chosen if math.isfinite(cost) else problem.possible_part(chosen)
            if len(best) == len(chosen):
                return chosen
            least = around.cost(best)
        chosen, cost = best, least


def model_key(chosen: tuple[Candidate, ...]) -> frozenset[int]:
    """Tells sets of candidates apart, by the first column of each."""
    return frozenset([c.first for c in chosen])


Move = tuple[tuple[Candidate, ...], float]
"""A model, and what it costs if its amplitudes are possible."""


@dataclass(frozen=True, slots=True)
class Around:
    """Models and moves that add a candidate to them, as far as they were asked for.

    Parameters
    ----------
    problem : Problem
    known : dict
        By `model_key` of the model: its own cost, and the few candidates that gain most beside it, each with what it comes to.
    costs : dict
        The same of a model whose amplitudes were asked for: infinite where they are impossible.
    prices : dict
        `Problem.penalty` of candidates, by their first column.
    """

    problem: Problem
    known: dict[frozenset[int], tuple[float, list[tuple[Candidate, float]]]]
    costs: dict[frozenset[int], float]
    prices: dict[int, float]

    def cost(self, model: tuple[Candidate, ...]) -> float:
        """`Problem.cost`."""
        key = model_key(model)
        if key not in self.costs:
            self.costs[key] = self.problem.cost(model)
        return self.costs[key]

    def price(self, candidate: Candidate) -> float:
        """`Problem.penalty`."""
        if candidate.first not in self.prices:
            self.prices[candidate.first] = self.problem.penalty(candidate)
        return self.prices[candidate.first]

    def look(self, bases: Sequence[tuple[Candidate, ...]]) -> None:
        """Find out about models, all that are new together."""
        new = {key: base for base in bases if (key := model_key(base)) not in self.known}
        if not new:
            return
        problem = self.problem
        squares, gains = problem.tried(list(new.values()))
        promising = _most_promising(problem, gains, rules().tried)
        for (key, base), square, gain, near in zip(new.items(), squares.tolist(), gains, promising, strict=True):
            own = square / problem.unit + sum([self.price(c) for c in base])
            added = [(c, own - float(gain[i]) / problem.unit + self.price(c)) for i, c in near]
            self.known[key] = own, added

    def itself(self, base: tuple[Candidate, ...]) -> Move:
        return base, self.known[model_key(base)][0]

    def added(self, base: tuple[Candidate, ...]) -> list[Move]:
        return [((*base, c), cost) for c, cost in self.known[model_key(base)][1]]


def _moves(problem: Problem, chosen: tuple[Candidate, ...], around: Around) -> list[Move]:
    """Neighbours of a set of effects; swaps are tried for the few candidates that gain most in each place."""
    every = range(len(chosen))
    without = [chosen[:i] + chosen[i + 1 :] for i in every]
    pairs = [[chosen[:i] + chosen[i + 1 : j] + chosen[j + 1 :] for j in range(i + 1, len(chosen))] for i in every]
    around.look([chosen, *without, *(pair for row in pairs for pair in row)])
    around.look([one for rest in without for one, _ in around.added(rest)])
    moves: list[Move] = []
    for i in every:
        moves.append(around.itself(without[i]))
        near = around.added(without[i])
        moves += near
        for first, _ in near:
            moves += around.added(first)
        for pair in pairs[i]:
            moves += around.added(pair)
    moves += around.added(chosen)
    return [move for move in moves if problem.keeps(move[0])] if problem.always else moves


def promising(problem: Problem, base: tuple[Candidate, ...], count: int) -> list[Candidate]:
    """Candidates of greatest net gain over `base`, the best shape of each effect only."""
    return [candidate for _, candidate in _most_promising(problem, problem.gains(base)[None], count)[0]]


def _most_promising(problem: Problem, gains: Floats, count: int) -> list[list[tuple[int, Candidate]]]:
    """The same from what each candidate gains beside each of some models, (k, n), and which they are."""
    order, ends = problem.by_name
    if not len(order):
        return [[] for _ in gains]
    net = (gains / problem.unit - problem.prices)[:, order]
    best = np.maximum.reduceat(net, ends[:-1], axis=1)
    ranked = np.argsort(best, axis=1)[:, ::-1][:, :count]
    places, bounds, found = order.tolist(), ends.tolist(), []
    for own, worth, most in zip(net, ranked.tolist(), np.take_along_axis(best, ranked, axis=1).tolist(), strict=True):
        near = list[tuple[int, Candidate]]()
        for which, value in zip(worth, most, strict=True):
            if value <= 0.0:
                break
            start = bounds[which]
            place = places[start + int(own[start : bounds[which + 1]].argmax())]
            near.append((place, problem.dictionary.candidates[place]))
        found.append(near)
    return found

"""Continuous shape values: from the best point of a grid to the best there is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial
from typing import cast

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.by_tooth import ALIKE, ByTooth
from gearwear.diagnose.columns import CellColumns, cuts_among
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate, Dictionary, cell_basis, columns_on
from gearwear.diagnose.effects.base import Context, Effect, Shape
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem, model_key, promising
from gearwear.placing.cells import Cells
from gearwear.processors import each

Shaped = tuple[tuple[Effect, Shape], ...]
"""Effects of some shapes."""
BestOf = Callable[[Callable[[Shape], float], Shape, int, float, float], Shape]
"""Finds the best value of one axis of a shape within a range."""
Gain = Callable[[Effect, Shape], float]
"""What an effect of some shape gains beside others."""
REMEMBERED, FRAMES = 2_500_000, 4
"""Values of bases, about, and sets of effects with what they span, that are remembered: some tens of megabytes."""
REFINED = 16
"""Models whose shapes are refined after an exchange, of often a hundred; on scans of several generators the best were never more than the eleventh."""
PLACES = 9
"""Places in its range at which a shape value is tried first: a seam has its best at every tooth."""


@dataclass(frozen=True, slots=True)
class Trials:
    """Models on the cells in use. What is asked for last is remembered: one trial after the other begins at the same shapes, beside the same effects.

    Parameters
    ----------
    problem : Problem
    columns : callable
        Of a model with the pose, (n, p), or blocks of them side by side.
    gain : callable
        Of a model: how far the weighted sum of squares falls when an effect of some shape is added to it and the pose.
    target, weight : (n,) float
    """

    problem: Problem
    columns: Callable[[Shaped], Floats | tuple[CellColumns, ...]]
    gain: Callable[[Shaped], Gain]
    target: Floats
    weight: Floats

    @classmethod
    def of(cls, problem: Problem, cells: Cells, target: Floats, use: Bools, covariance: CellCovariance) -> Trials:
        rows = np.flatnonzero(use)
        points, target, weight = cells.points.take(rows), target[rows], covariance.weight[rows]
        pose = problem.dictionary.take(problem.dictionary.pose, rows)

        def evaluated(effect: Effect, shape: Shape) -> Floats:
            return cell_basis(effect, points, problem.context, shape, cells.grid)

        basis = cast(Callable[[Effect, Shape], Floats], lru_cache(maxsize=REMEMBERED // max(len(rows), 1))(evaluated))

        cuts = cuts_among(problem.dictionary.first.cuts, rows)
        root = np.sqrt(weight)[:, None]
        # What the pose, which is in every fit, leaves of a column is worked out once.
        posed, weighted_aim = orthonormal(root * pose), root * target[:, None]
        aim = _beside(posed, weighted_aim)

        def in_stds(effect: Effect, shape: Shape, free: bool) -> Floats:
            own = root * basis(effect, shape)
            return _beside(posed, own) if free else own

        weighted = cast(Callable[[Effect, Shape, bool], Floats], lru_cache(maxsize=REMEMBERED // max(len(rows), 1))(in_stds))

        @lru_cache(maxsize=FRAMES)
        def by_tooth(specific: Shaped) -> ByTooth | None:
            return ByTooth.of(np.hstack([weighted(effect, shape, False) for effect, shape in specific])) if specific else None

        def stretches(effect: Effect, shape: Shape) -> CellColumns:
            return CellColumns.of(basis(effect, shape), cuts)

        of_each_tooth = cast(Callable[[Effect, Shape], CellColumns], lru_cache(maxsize=FRAMES)(stretches))

        def columns(model: Shaped) -> Floats | tuple[CellColumns, ...]:
            if not any(effect.tooth_specific for effect, _ in model):
                return np.hstack([pose, *(basis(effect, shape) for effect, shape in model)])
            own = ((of_each_tooth if effect.tooth_specific else stretches)(effect, shape) for effect, shape in model)
            return CellColumns.of(pose, cuts), *own

        @lru_cache(maxsize=FRAMES)
        def gain(model: Shaped) -> Gain:
            specific = by_tooth(tuple(one for one in model if one[0].tooth_specific))
            if specific is None:
                shared = np.hstack([pose[:, :0], *(weighted(*one, True) for one in model)])
                beside = _gain_beside(shared, aim)
            else:
                own = [weighted(*one, False) for one in model if not one[0].tooth_specific]
                beside = _gain_beside(np.hstack([posed, *own]), weighted_aim, specific)
            return cast(Gain, cache(lambda effect, shape: beside(weighted(effect, shape, specific is None))))

        return cls(problem, columns, gain, target, weight)

    def refined(self, chosen: tuple[Candidate, ...], best_of: BestOf | None = None) -> tuple[Candidate, ...]:
        """The same effects, each in turn at its best shape; their columns are still those of the shapes they had."""
        best_of = best_of or _golden
        for i, candidate in enumerate(chosen):
            ranges = candidate.effect.bracket(candidate.shape, self.problem.context)
            if not ranges:
                continue
            gain = partial(self.gain(_shaped(chosen[:i] + chosen[i + 1 :])), candidate.effect)
            best = self._at_best(candidate, gain, best_of)
            others = candidate.effect.other_forms(candidate.shape, self.problem.context)
            if others:
                other = self._at_best(replace(candidate, shape=max(others, key=gain)), gain, best_of)
                costs = [self.problem.penalty(one) - gain(one.shape) / self.problem.unit for one in (best, other)]
                best = other if costs[1] < costs[0] else best
            if best.shape != candidate.shape:
                chosen = (*chosen[:i], best, *chosen[i + 1 :])
        return chosen

    def _at_best(self, candidate: Candidate, gain: Callable[[Shape], float], best_of: BestOf) -> Candidate:
        """The candidate with the continuous shape values of greatest gain between their neighbours on the grid."""
        shape = candidate.shape
        for axis, (low, high) in enumerate(candidate.effect.bracket(shape, self.problem.context)):
            if high > low:
                shape = best_of(gain, shape, axis, low, high)
        return replace(candidate, shape=shape) if gain(shape) > gain(candidate.shape) else candidate

    def cost(self, model: tuple[Candidate, ...]) -> float:
        """As `Problem.cost`, whatever the shapes."""
        columns = self.columns(_shaped(model))
        gram = Gram.of(columns, self.target, self.weight, np.zeros(len(self.target), np.int64), 1)
        every = np.arange(gram.information.shape[1])
        if not self.problem.possible(model, gram.solve(every)[0][len(self.problem.dictionary.pose) :]):
            return math.inf
        return gram.residual_square(every) / self.problem.unit + sum(self.problem.penalty(c) for c in model)


def _shaped(model: tuple[Candidate, ...]) -> Shaped:
    return tuple((c.effect, c.shape) for c in model)


def refine_shapes(
    problem: Problem, chosen: tuple[Candidate, ...], cells: Cells, target: Floats, use: Bools, covariance: CellCovariance
) -> tuple[Dictionary, tuple[Candidate, ...]]:
    """Refine every continuous shape value of the chosen effects, one effect after the other.

    A golden-section search between the neighbours on the effect's grid; the other effects and the pose are refitted at every
    trial (variable projection, Golub & Pereyra 1973).

    Returns
    -------
    dictionary : Dictionary
        With the refined candidates added.
    chosen : tuple of Candidate
        With the refined candidates in place.
    """
    refined = Trials.of(problem, cells, target, use, covariance).refined(chosen)
    return _with_columns(problem, chosen, refined, cells)


def _with_columns(
    problem: Problem, chosen: tuple[Candidate, ...], refined: tuple[Candidate, ...], cells: Cells
) -> tuple[Dictionary, tuple[Candidate, ...]]:
    """The dictionary with columns for the shapes that were refined, and the refined candidates with these."""
    dictionary, model = problem.dictionary, list[Candidate]()
    for old, new in zip(chosen, refined, strict=True):
        if new.shape != old.shape:
            seen, points = cells.seen, cells.points.take(cells.seen)
            basis = columns_on(seen, points, new.effect, new.shape, problem.context, cells.grid)
            dictionary, new = dictionary.with_candidate(new.effect, new.shape, basis)
        model.append(new)
    return dictionary, tuple(model)


def _gain_beside(base: Floats, aim: Floats, by_tooth: ByTooth | None = None) -> Callable[[Floats], float]:
    """Function: fall of the sum of squares of `aim` (n, 1) when columns are added to `base` and what is `by_tooth`, which are taken out of everything once;
    all in standard deviations."""
    if by_tooth is not None:
        base, aim = by_tooth.beside(base), by_tooth.beside(aim)
    frame = orthonormal(base)
    aim = _beside(frame, aim)

    def gain(own: Floats) -> float:
        spanned, moment = frame.T @ own, (own.T @ aim)[:, 0]  # nothing that the base spans is left in `aim`
        left = own.T @ own - spanned.T @ spanned
        if by_tooth is not None:
            along = by_tooth.along(own)
            left -= along.T @ along
        if len(moment) == 1:
            return float(moment[0] ** 2 / left[0, 0]) if left[0, 0] != 0.0 else 0.0
        return float(moment @ np.linalg.lstsq(left, moment, rcond=1e-9)[0])

    return gain


def _beside(frame: Floats, columns: Floats) -> Floats:
    """What columns square to each other and of length 1 leave of others."""
    return np.asarray(columns - frame @ (frame.T @ columns), dtype=np.float64)


def orthonormal(columns: Floats) -> Floats:
    """Columns (m, p) square to each other and of length 1 that span the same, (m, p).

    By Cholesky's factor of their products, twice: as exact as by reflections as long as the columns are not nearly the same (Yamamoto and
    others 2015), and several times as fast on few long ones. Where they are, by reflections.
    """
    size = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    if not len(size) or not (size > 0.0).all():
        return np.linalg.qr(columns)[0]
    frame = columns / size
    try:
        first = np.linalg.cholesky(frame.T @ frame)
        if np.diag(first).min() < ALIKE:
            return np.linalg.qr(columns)[0]
        frame = frame @ np.linalg.inv(first).T
        return np.asarray(frame @ np.linalg.inv(np.linalg.cholesky(frame.T @ frame)).T, dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.linalg.qr(columns)[0]


def polish(
    problem: Problem, chosen: tuple[Candidate, ...], cells: Cells, target: Floats, use: Bools, covariance: CellCovariance
) -> tuple[Dictionary, tuple[Candidate, ...]]:
    """Exchange effects with the shapes of the others refined anew after each exchange.

    Two reliefs with shapes of their own imitate a relief and a crowning: no exchange with shapes held fast leads from one to the other.
    """
    if not chosen:
        return problem.dictionary, chosen
    on_cells = Trials.of(problem, cells, target, use, covariance)

    def shaped(*model: Candidate) -> bool:
        return any(c.effect.bracket(c.shape, problem.context) for c in model)

    trials = []
    for i, own in enumerate(chosen):
        rest = chosen[:i] + chosen[i + 1 :]
        trials += [(*rest, c) for c in promising(problem, rest, rules().tried) if c.name != own.name and shaped(*rest, c)]
        for second in rest[i:]:
            if shaped(own, second):  # one seam in its place for two that stand in for it
                others = tuple(c for c in rest if c is not second)
                near = promising(problem, others, len(problem.dictionary.candidates))
                near = near[: rules().tried] + [c for c in near[rules().tried :] if c.name in {own.name, second.name}]
                trials += [(*others, c) for c in near if shaped(c)]
    trials = _most_likely(problem, [trial for trial in trials if problem.keeps(trial)])
    best, least = chosen, on_cells.cost(chosen)

    def cost(trial: tuple[Candidate, ...]) -> float:
        """Of the trial at its best; nearly there already tells whether it can be the cheaper one."""
        nearly = on_cells.cost(on_cells.refined(trial, _nearly))
        return nearly if nearly > least + rules().close else on_cells.cost(on_cells.refined(trial))

    costs = each([partial(cost, trial) for trial in trials])
    for trial, value in zip(trials, costs, strict=True):
        if value < least - 1e-6:
            best, least = trial, value
    return (problem.dictionary, chosen) if best is chosen else _with_columns(problem, best, on_cells.refined(best), cells)


def _most_likely(problem: Problem, trials: list[tuple[Candidate, ...]]) -> list[tuple[Candidate, ...]]:
    """The `REFINED` cheapest of some models with the shapes that they have, in the order that they came in; each once."""
    models = dict[frozenset[int], tuple[Candidate, ...]]()
    for trial in trials:
        models.setdefault(model_key(trial), trial)
    each_once = list(models.values())
    if len(each_once) <= REFINED:
        return each_once
    cheapest = np.argsort([problem.cost(trial) for trial in each_once], kind="stable")[:REFINED]
    return [each_once[i] for i in np.sort(cheapest)]


def _nearly(gain: Callable[[Shape], float], shape: Shape, axis: int, low: float, high: float) -> Shape:
    """Near the best value of one shape axis in [low, high]: where a parabola through the best of some places and its neighbours is highest."""
    places, best, gains = _best_place(gain, shape, axis, low, high)
    if not 0 < best < PLACES - 1:
        return _at(shape, axis, float(places[best]))
    before, here, after = gains[best - 1 : best + 2]
    bend = 2.0 * here - before - after
    shift = 0.5 * (after - before) / bend if bend > 0.0 else 0.0
    top = _at(shape, axis, float(places[best] + shift * (places[1] - places[0])))
    return top if gain(top) > here else _at(shape, axis, float(places[best]))


def _golden(gain: Callable[[Shape], float], shape: Shape, axis: int, low: float, high: float, steps: int = 12) -> Shape:
    """Best value of one shape axis in [low, high]: some places first, then golden section."""
    golden = 0.6180339887498949
    places, best, _ = _best_place(gain, shape, axis, low, high)
    low, high = float(places[max(best - 1, 0)]), float(places[min(best + 1, PLACES - 1)])
    a, b = high - golden * (high - low), low + golden * (high - low)
    fa, fb = gain(_at(shape, axis, a)), gain(_at(shape, axis, b))
    for _ in range(steps):
        if fa > fb:
            high, b, fb = b, a, fa
            a = high - golden * (high - low)
            fa = gain(_at(shape, axis, a))
        else:
            low, a, fa = a, b, fb
            b = low + golden * (high - low)
            fb = gain(_at(shape, axis, b))
    return _at(shape, axis, a if fa > fb else b)


def _at(shape: Shape, axis: int, value: float) -> Shape:
    """The shape with another value on one axis."""
    return (*shape[:axis], value, *shape[axis + 1 :])


def _best_place(
    gain: Callable[[Shape], float], shape: Shape, axis: int, low: float, high: float
) -> tuple[Floats, int, list[float]]:
    """Places in a range, which of them is the best, and what each gains."""
    places = np.linspace(low, high, PLACES)
    gains = [gain(_at(shape, axis, float(place))) for place in places]
    return places, int(np.argmax(gains)), gains


def shape_columns(candidate: Candidate, amplitudes: Floats, cells: Cells, context: Context) -> Floats:
    """Change of the deviation per unit of each continuous shape value, (m, q), by central differences: what a fit of the shape
    would have as columns, for its covariance."""
    effect, ranges = candidate.effect, candidate.effect.bracket(candidate.shape, context)
    points = cells.points.take(cells.seen)
    columns = np.zeros((len(cells.seen), len(ranges)))
    for axis, (low, high) in enumerate(ranges):
        step = 0.02 * (high - low)
        if step <= 0.0:
            continue
        moved = [(*candidate.shape[:axis], candidate.shape[axis] + d, *candidate.shape[axis + 1 :]) for d in (-step, step)]
        below, above = (cell_basis(effect, points, context, shape, cells.grid) @ amplitudes for shape in moved)
        columns[cells.seen, axis] = (above - below) / (2.0 * step)
    return columns

"""Continuous shape values: from the best point of a grid to the best there is."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, lru_cache, partial
from typing import cast

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate, Dictionary, cell_basis
from gearwear.diagnose.effects.base import Context, Effect, Shape
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem, promising
from gearwear.placing.cells import Cells
from gearwear.processors import each

ALIKE = 1e-5
"""Part of a column that others leave, below which squares of the columns lose too many digits; numerical."""
REMEMBERED = 128
"""Bases that are remembered: some tens of megabytes."""


Bases = Callable[[Effect, Shape], Floats]
"""The basis (n, p) of an effect of some shape on the cells in use."""


def bases_on(cells: Cells, use: Bools, context: Context) -> Bases:
    """Bases on the cells in use; the last ones are remembered: one trial after the other begins at the same shapes."""
    points = cells.points.take(np.flatnonzero(use))

    @lru_cache(maxsize=REMEMBERED)
    def basis(effect: Effect, shape: Shape) -> Floats:
        return cell_basis(effect, points, context, shape, cells.grid)

    return cast(Bases, basis)


def refine_shapes(
    problem: Problem,
    chosen: tuple[Candidate, ...],
    cells: Cells,
    target: Floats,
    use: Bools,
    covariance: CellCovariance,
    bases: Bases | None = None,
) -> tuple[Dictionary, tuple[Candidate, ...]]:
    """Refine every continuous shape value of the chosen effects, one effect after the other.

    A golden-section search between the neighbours on the effect's grid; the other effects and the pose are refitted at every
    trial (variable projection, Golub & Pereyra 1973). `bases` are those of `bases_on`, where the caller has them.

    Returns
    -------
    dictionary : Dictionary
        With the refined candidates added.
    chosen : tuple of Candidate
        With the refined candidates in place.
    """
    dictionary = problem.dictionary
    rows = np.flatnonzero(use)
    bases = bases_on(cells, use, problem.context) if bases is None else bases
    weight = covariance.weight[rows]
    for i, candidate in enumerate(chosen):
        ranges = candidate.effect.bracket(candidate.shape, problem.context)
        if not ranges:
            continue
        effect, rest = candidate.effect, chosen[:i] + chosen[i + 1 :]
        base = dictionary.take(np.concatenate([dictionary.pose, *(c.columns for c in rest)]), rows)
        gain = _gain_beside(base, target[rows], weight)

        @cache
        def left(shape: Shape, effect: Effect = effect, gain: Callable[[Floats], float] = gain) -> float:
            return -gain(bases(effect, shape))

        shape = candidate.shape
        for axis, (low, high) in enumerate(ranges):
            if high > low:
                shape = _golden(left, shape, axis, low, high)
        if shape != candidate.shape and left(shape) < left(candidate.shape):
            basis = np.zeros((len(target), len(candidate.columns)))
            basis[cells.seen] = cell_basis(effect, cells.points.take(cells.seen), problem.context, shape, cells.grid)
            dictionary, refined = dictionary.with_candidate(effect, shape, basis)
            chosen = (*chosen[:i], refined, *chosen[i + 1 :])
    return dictionary, chosen


def _gain_beside(base: Floats, target: Floats, weight: Floats) -> Callable[[Floats], float]:
    """Function: fall of the weighted sum of squares when columns are added to `base`, which is taken out of everything once."""
    root = np.sqrt(weight)[:, None]
    frame = orthonormal(base * root)
    aim = target[:, None] * root
    aim = aim - frame @ (frame.T @ aim)

    def gain(columns: Floats) -> float:
        own = columns * root
        spanned, moment = frame.T @ own, (own.T @ aim)[:, 0]  # nothing that the base spans is left in `aim`
        return float(moment @ np.linalg.lstsq(own.T @ own - spanned.T @ spanned, moment, rcond=1e-9)[0])

    return gain


def orthonormal(columns: Floats) -> Floats:
    """Columns (m, p) square to each other and of length 1 that span the same, (m, p).

    By Cholesky's factor of their products, twice: as exact as by reflections as long as the columns are not nearly the same (Yamamoto and
    others 2015), and several times as fast on few long ones. Where they are, by reflections.
    """
    size = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    if not (size > 0.0).all():
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
    weight = np.where(use, covariance.weight, 0.0)

    def cost(book: Dictionary, model: tuple[Candidate, ...]) -> float:
        columns = book.take(np.concatenate([book.pose, *(c.columns for c in model)]))
        gram = Gram.of(columns, target, weight, np.zeros(len(target), np.int64), 1)
        every = np.arange(columns.shape[1])
        if not problem.possible(model, gram.solve(every)[0][len(book.pose) :]):
            return math.inf
        return gram.residual_square(every) / problem.unit + sum(problem.penalty(c) for c in model)

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
    bases = bases_on(cells, use, problem.context)

    def refined(trial: tuple[Candidate, ...]) -> tuple[Dictionary, tuple[Candidate, ...]]:
        return refine_shapes(problem, trial, cells, target, use, covariance, bases)

    trials = [trial for trial in trials if problem.keeps(trial)]
    costs = each([partial(lambda trial: cost(*refined(trial)), trial) for trial in trials])
    best, least = None, cost(problem.dictionary, chosen)
    for trial, value in zip(trials, costs, strict=True):
        if value < least - 1e-6:
            best, least = trial, value
    return (problem.dictionary, chosen) if best is None else refined(best)


def _golden(function: Callable[[Shape], float], shape: Shape, axis: int, low: float, high: float, steps: int = 12) -> Shape:
    """Best value of one shape axis in [low, high]: nine places first (a seam has a minimum at every tooth), then golden section."""
    golden = 0.6180339887498949

    def at(value: float) -> Shape:
        return (*shape[:axis], value, *shape[axis + 1 :])

    places = np.linspace(low, high, 9)
    best = int(np.argmin([function(at(float(place))) for place in places]))
    low, high = float(places[max(best - 1, 0)]), float(places[min(best + 1, 8)])
    a, b = high - golden * (high - low), low + golden * (high - low)
    fa, fb = function(at(a)), function(at(b))
    for _ in range(steps):
        if fa < fb:
            high, b, fb = b, a, fa
            a = high - golden * (high - low)
            fa = function(at(a))
        else:
            low, a, fa = a, b, fb
            b = low + golden * (high - low)
            fb = function(at(b))
    return at(a if fa < fb else b)


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

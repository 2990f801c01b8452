"""Continuous shape values: from the best point of a grid to the best there is."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Candidate, Dictionary
from gearwear.diagnose.effects.base import Shape
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.search import Problem
from gearwear.measure.cells import Cells


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
    dictionary = problem.dictionary
    rows = np.flatnonzero(use)
    points = cells.points.take(rows)
    weight = covariance.weight[rows]
    for i, candidate in enumerate(chosen):
        bracket = getattr(candidate.effect, "bracket", None)
        if bracket is None:
            continue
        effect, rest = candidate.effect, chosen[:i] + chosen[i + 1 :]
        base = dictionary.columns[np.ix_(rows, np.concatenate([dictionary.pose, *(c.columns for c in rest)]).astype(np.int64))]

        def left(shape: Shape, effect=effect, base=base) -> float:  # type: ignore[no-untyped-def]
            columns = np.hstack([base, effect.basis(points, problem.context, shape)])
            gram = Gram.of(columns, target[rows], weight, np.zeros(len(rows), np.int64), 1)
            return gram.residual_square(np.arange(columns.shape[1]))

        shape = candidate.shape
        for axis, (low, high) in enumerate(bracket(shape, problem.context)):
            if high > low:
                shape = _golden(left, shape, axis, low, high)
        if shape != candidate.shape and left(shape) < left(candidate.shape):
            basis = np.zeros((len(target), len(candidate.columns)))
            basis[cells.seen] = effect.basis(cells.points.take(cells.seen), problem.context, shape)
            dictionary, refined = dictionary.with_candidate(effect, shape, basis)
            chosen = (*chosen[:i], refined, *chosen[i + 1 :])
    return dictionary, chosen


def _golden(function, shape: Shape, axis: int, low: float, high: float, steps: int = 14) -> Shape:  # type: ignore[no-untyped-def]
    """Best value of one shape axis in [low, high]; 14 steps narrow the bracket a thousandfold."""
    golden = 0.6180339887498949

    def at(value: float) -> Shape:
        return (*shape[:axis], value, *shape[axis + 1 :])

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

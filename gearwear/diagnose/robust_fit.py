"""A fit that cells it cannot explain do not bend: reweighted until its sum of squares stands still."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.beside import RIDGE
from gearwear.diagnose.columns import CellColumns
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules
from gearwear.robust import scale_about, tukey_weight

PASSES = 6
"""Reweighted fits, wide and again narrow, at most; numerical."""
FEW = 1.0 / 3.0
"""Part of the values of columns that are not zero, below which their sums are taken stretch by stretch; numerical."""
SETTLED = 0.01
"""Part of `close` by which the sum of squares may still change from one reweighted fit to the next; numerical."""


@dataclass(frozen=True, slots=True)
class Robust:
    """A fit that cells it cannot explain do not bend.

    Parameters
    ----------
    weight : (n,) float
        1 / mm², of the last pass.
    amplitudes : (p,) float
    square : float
        Sum over the cells of the squared residual in its standard deviations, at most `close` for each.
    """

    weight: Floats
    amplitudes: Floats
    square: float


@dataclass(frozen=True, slots=True)
class Shares:
    """Columns of which no two are anything but zero in the same cell: a share of one loss for every flank.

    Parameters
    ----------
    loss : (n,) float
        The columns' sum.
    rows : (k,) int
        Cells where it is not 0, those of one column behind those of another.
    firsts : (q,) int
        Where in `rows` each column begins.
    column : (k,) int
        Of each of `rows`.
    """

    loss: Floats
    rows: Ints
    firsts: Ints
    column: Ints

    @classmethod
    def of(cls, loss: Floats, which: Ints) -> Shares:
        """Of a loss (n,) and the flank of each cell, (n,); a column for every flank that has lost anything."""
        rows = np.flatnonzero(loss)
        rows = rows[np.argsort(which[rows], kind="stable")]
        _, firsts, column = np.unique(which[rows], return_index=True, return_inverse=True)
        return cls(loss, rows, firsts, column)

    @property
    def count(self) -> int:
        return len(self.firsts)

    def amplitudes(self, columns: Floats, target: Floats, weight: Floats, gram: Gram) -> Floats:
        """Those of the fit on columns (n, p), whose sums are in `gram`, and on the shares; the shares are solved for each by itself (an arrow: Schur's complement)."""
        loss, rows = self.loss[self.rows], self.rows
        weighted = (weight[rows] * loss)[:, None]
        both = np.add.reduceat(weighted * np.column_stack([columns[rows], target[rows], loss]), self.firsts, axis=0)
        own = both[:, -1] * (1.0 + RIDGE)
        own[own == 0.0] = 1.0  # a column nobody sees gets no amplitude
        across, moment = both[:, :-2], both[:, -2]
        information = gram.information[0]
        size = np.sqrt(np.diag(information))
        size[size == 0.0] = 1.0
        spanned = across / own[:, None]
        left = (information - across.T @ spanned) / np.outer(size, size) + RIDGE * np.eye(len(size))
        shared = np.linalg.solve(left, (gram.moment[0] - spanned.T @ moment) / size) / size
        return np.concatenate([shared, (moment - across @ shared) / own])

    def times(self, amplitudes: Floats) -> Floats:
        """(n,) the loss with a share (q,) on each flank."""
        result = np.zeros(len(self.loss))
        result[self.rows] = self.loss[self.rows] * amplitudes[self.column]
        return result


def robust_fit(
    target: Floats, known: Floats, columns: Floats, shares: Shares | None = None, losses: int = 0, settled: float = SETTLED, first: Floats | None = None,
    cuts: Ints | None = None,
) -> Robust:  # fmt: skip
    """The robust fit of columns (n, p) to a target (n,), until its sum of squares changes by less than a part of `close`.

    Parameters
    ----------
    target, known : (n,) float
        And its weight, 1 / mm², where a cell is believed.
    columns : (n, p) float
        The last of them may be losses.
    shares : Shares or None
        More columns, behind the others.
    losses : int
        How many of the columns have no amplitude below 0.
    settled : float
    first : (n,) float or None
        Weights that a poorer fit ended with, to begin with: a deep place of one flank would draw a share of its own at first.
    cuts : (k,) int or None
        First cells of stretches of which each has few of the columns.
    """
    root = np.sqrt(known)
    sums = _sums(columns, target, cuts)
    free, bounded = np.split(np.arange(columns.shape[1]), [columns.shape[1] - losses])
    weight = known if first is None else first
    for wide in (True, False) if first is None else (False,):  # what lies far off at first may be the whole of a side
        before = np.inf
        for _ in range(PASSES):
            gram = sums(weight)
            if shares is not None:
                amplitudes = shares.amplitudes(columns, target, weight, gram)
                fitted = columns @ amplitudes[: columns.shape[1]] + shares.times(amplitudes[columns.shape[1] :])
            else:
                amplitudes = gram.solve_non_negative(free, bounded) if losses else gram.amplitudes(free)
                fitted = columns @ amplitudes
            residual = (target - fitted) * root
            spread = max(scale_about(residual), 1.0) if wide else 1.0
            weight = known * tukey_weight(residual, spread)
            square = float(np.minimum(residual**2, rules().close).sum())
            if abs(square - before) < settled * rules().close:
                break
            before = square
    return Robust(weight, amplitudes, square)


def _sums(columns: Floats, target: Floats, cuts: Ints | None) -> Callable[[Floats], Gram]:
    """The sums of columns (n, p) as a function of the weights (n,)."""
    few = cuts is not None and np.count_nonzero(columns) <= FEW * columns.size
    return Gram.by_weight(CellColumns.of(columns, cuts) if cuts is not None and few else columns, target)

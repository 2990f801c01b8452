"""Sufficient statistics of a weighted linear fit, kept fold by fold, and the fits made from them.

With the columns of all candidates at hand once, every fit, every gain and every held-out error is a small dense solve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.beside import NOTHING, RIDGE, Beside, blocks_of
from gearwear.diagnose.columns import CellColumns

BATCH = 4096
"""Rows of dense columns that are weighted at a time: no copy of all is made, and what is in work stays near the processor."""


@dataclass(frozen=True, slots=True)
class Gram:
    """XᵀWX, XᵀWd, dᵀWd and ΣW, per fold.

    Parameters
    ----------
    information : (folds, p, p) float
    moment : (folds, p) float
    square, weight : (folds,) float
    """

    information: Floats
    moment: Floats
    square: Floats
    weight: Floats

    @classmethod
    def of(cls, columns: Floats | tuple[CellColumns, ...], target: Floats, weight: Floats, fold: Ints, folds: int) -> Gram:
        """Collect the statistics of columns, or of blocks of them side by side; rows with zero weight are left out."""
        p = sum(block.count for block in columns) if isinstance(columns, tuple) else columns.shape[1]
        information, moment = np.zeros((folds, p, p)), np.zeros((folds, p))
        square, total = np.zeros(folds), np.zeros(folds)
        known = weight > 0.0
        for f in range(folds):
            root = np.sqrt(np.where(known & (fold == f), weight, 0.0))
            rows = np.flatnonzero(root)
            aim = np.where(root > 0.0, target, 0.0) * root
            square[f], total[f] = float(aim @ aim), float(weight[rows].sum())
            flat = information[f].reshape(-1)  # a view: one index takes half the time of two
            for at, which, part in _weighted(columns, root, rows):
                flat[(which[:, None] * p + which).reshape(-1)] += (part.T @ part).reshape(-1)
                moment[f][which] += part.T @ aim[at]
        return cls(information, moment, square, total)

    def widened(self, columns: tuple[CellColumns, ...], target: Floats, weight: Floats) -> Gram:
        """The statistics, all rows together, with those of columns that have come behind: blocks of all of them, and what these statistics are of."""
        before, p = self.information.shape[1], sum(block.count for block in columns)
        information, moment = np.zeros((p, p)), np.zeros(p)
        information[:before, :before], moment[:before] = self.information[0], self.moment[0]
        root = np.sqrt(weight)
        aim = target * root
        for at, which, part in _weighted(columns, root, np.flatnonzero(root)):
            own, new = part[:, which >= before], which[which >= before]
            information[which[:, None], new] += part.T @ own
            moment[new] += own.T @ aim[at]
        information[before:, :before] = information[:before, before:].T
        return Gram(information[None], moment[None], self.square, self.weight)

    @classmethod
    def whole(cls, columns: Floats, target: Floats, weight: Floats) -> Gram:
        """The same of columns (m, p) that are not zero on many rows, all together."""
        return cls.by_weight(columns, target)(weight)

    @classmethod
    def by_weight(cls, columns: Floats | CellColumns, target: Floats) -> Callable[[Floats], Gram]:
        """The same as a function of the weights (m,), for many of them: where each sum goes is worked out once, and room for weighted columns kept."""
        if isinstance(columns, CellColumns):
            p, stretches = columns.count, [(one.rows, one.which, one.values) for one in columns.stretches if len(one.which)]
        else:
            p, stretches = columns.shape[1], [(slice(None), np.arange(columns.shape[1]), columns)]
        pieces = [
            (rows, which, (which[:, None] * p + which).reshape(-1), values, np.empty_like(values))
            for rows, which, values in stretches
        ]

        def sums(weight: Floats) -> Gram:
            root = np.sqrt(weight)
            aim, information, moment = target * root, np.zeros(p * p), np.zeros(p)
            for rows, which, at, values, part in pieces:
                np.multiply(values, root[rows, None], out=part)
                information[at] += (part.T @ part).reshape(-1)
                moment[which] += part.T @ aim[rows]
            return cls(information.reshape(1, p, p), moment[None], np.array([aim @ aim]), np.array([weight.sum()]))

        return sums

    def solve(self, which: Ints, without: int | None = None) -> tuple[Floats, Floats]:
        """Amplitudes and inverse information of the fit on columns `which`, on all folds or all but one."""
        scaled, scale, moment = self._scaled(which, without)
        inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
        return inverse @ moment, inverse

    def amplitudes(self, which: Ints) -> Floats:
        """Those of `solve`, where nothing else is asked."""
        scaled, scale, moment = self._scaled(which, None)
        return np.asarray(np.linalg.solve(scaled, moment / scale) / scale, dtype=np.float64)

    def _scaled(self, which: Ints, without: int | None) -> tuple[Floats, Floats, Floats]:
        """The information of columns `which` at length 1, with the ridge; these lengths, and the moment."""
        a, b = self._sums(without)
        block = a[np.ix_(which, which)]
        scale = np.sqrt(np.diag(block))
        scale[scale == 0.0] = 1.0  # a column nobody sees gets no amplitude
        return block / np.outer(scale, scale) + RIDGE * np.eye(len(which)), scale, b[which]

    def solve_non_negative(self, free: Ints, bounded: Ints) -> Floats:
        """Amplitudes of the fit on columns `free` and `bounded`, of which the latter are not below 0; in that order.

        Non-negative least squares (Lawson and Hanson 1974) on what the free columns leave of the bounded ones.
        """
        from scipy.optimize import nnls

        a, b = self._sums(None)
        seen = np.diag(a)[bounded] > 0.0  # what nobody sees gets no amplitude
        amounts, bounded = np.zeros(len(bounded)), bounded[seen]
        if not len(bounded):  # `nnls` ends the process where there is nothing to fit
            return np.concatenate([self.amplitudes(free), amounts])
        scaled, size, moment = self._scaled(free, None)
        both = np.linalg.solve(scaled, np.column_stack([a[np.ix_(free, bounded)], moment]) / size[:, None]) / size[:, None]
        drawn, alone = both[:, :-1], both[:, -1]
        left = a[np.ix_(bounded, bounded)] - a[np.ix_(bounded, free)] @ drawn
        scale = np.sqrt(np.diag(a)[bounded])
        value, vector = np.linalg.eigh(left / np.outer(scale, scale) + RIDGE * np.eye(len(bounded)))
        root = np.sqrt(np.maximum(value, RIDGE))
        aim = vector.T @ ((b[bounded] - a[np.ix_(bounded, free)] @ alone) / scale)
        amounts[seen] = nnls(root[:, None] * vector.T, aim / root, maxiter=100 * len(bounded))[0] / scale
        return np.concatenate([alone - drawn @ amounts[seen], amounts])

    def residual_square(self, which: Ints) -> float:
        """Weighted sum of squares that the fit on columns `which` leaves."""
        if len(which) == 0:
            return float(self.square.sum())
        amplitudes, _ = self.solve(which)
        return float(self.square.sum() - amplitudes @ self._sums(None)[1][which])

    def gains(self, base: Ints, blocks: list[Ints]) -> Floats:
        """Fall of the weighted sum of squares when each block of columns is added to `base`."""
        gains: Floats = self.beside(base, blocks).tried(np.zeros((1, 0), np.int64))[1][0]
        return gains

    def beside(self, base: Ints, candidates: Sequence[Ints] = ()) -> Beside:
        """What all columns hold beside the fit on columns `base`, and candidates of which each is some columns."""
        a, b = self._sums(None)
        amplitudes, inverse = self.solve(base)
        square = float(self.square.sum() - amplitudes @ b[base])
        seen = np.flatnonzero(np.diag(a) > 0.0)
        place = np.full(len(b) + 1, NOTHING)
        place[seen] = np.arange(len(seen))
        across = a[seen[:, None], base]
        left = a[seen[:, None], seen] - across @ inverse @ across.T
        return Beside(
            place, left, b[seen] - across @ amplitudes, square, np.diag(a)[seen], len(candidates), blocks_of(place, candidates)
        )

    def held_out(self, which: Ints) -> Floats:
        """(folds,) weighted sum of squares of each fold under the fit on the others."""
        result = np.zeros(len(self.square))
        for f in range(len(self.square)):
            amplitudes, _ = self.solve(which, without=f)
            own = self.information[f][np.ix_(which, which)]
            result[f] = self.square[f] - 2.0 * amplitudes @ self.moment[f][which] + amplitudes @ own @ amplitudes
        return result

    def _sums(self, without: int | None) -> tuple[Floats, Floats]:
        if len(self.square) == 1 and without is None:
            return self.information[0], self.moment[0]
        a, b = self.information.sum(axis=0), self.moment.sum(axis=0)
        if without is None:
            return a, b
        return a - self.information[without], b - self.moment[without]


def _weighted(columns: Floats | tuple[CellColumns, ...], root: Floats, rows: Ints) -> Iterator[tuple[Ints | slice, Ints, Floats]]:
    """Some rows at a time, the columns that are not zero on them, and these times `root`; `rows` are those where that is not 0."""
    if not isinstance(columns, tuple):
        for start in range(0, len(rows), BATCH):
            # Of all rows without a copy.
            at = slice(start, start + BATCH) if len(rows) == len(root) else rows[start : start + BATCH]
            yield at, np.arange(columns.shape[1]), columns[at] * root[at, None]
        return
    starts = np.cumsum([0, *(block.count for block in columns)]).tolist()
    ends = np.searchsorted(rows, [*columns[0].cuts, len(root)]).tolist()
    for (first, last), pieces in zip(pairwise(ends), zip(*(block.stretches for block in columns), strict=True), strict=True):
        if first == last:
            continue
        at, which = rows[first:last], [piece.which + start for piece, start in zip(pieces, starts, strict=False)]
        own, part, filled = root[at, None], np.empty((len(at), sum(map(len, which)))), 0
        here = at - pieces[0].rows.start if len(at) < len(pieces[0].values) else slice(None)
        for piece in pieces:
            filled += len(piece.which)
            np.multiply(piece.values[here], own, out=part[:, filled - len(piece.which) : filled])
        yield at, np.concatenate(which), part

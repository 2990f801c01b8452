"""Sufficient statistics of a weighted linear fit, kept fold by fold, and the fits made from them.

With the columns of all candidates at hand once, every fit, every gain and every held-out error is a small dense solve.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.columns import CellColumns

RIDGE = 1e-9
"""Relative to the column's own sum: keeps exactly collinear columns solvable; they gain nothing by it."""


BATCH = 4096
"""Rows of dense columns that are weighted at a time: no copy of all is made, and what is in work stays near the processor."""
SPANNED = 1e-6
"""Share of a column's own square below which nothing of it is left beside others."""


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
        alone, inverse = self.solve(free)
        seen = np.diag(a)[bounded] > 0.0  # what nobody sees gets no amplitude
        amounts, bounded = np.zeros(len(bounded)), bounded[seen]
        if not len(bounded):  # `nnls` ends the process where there is nothing to fit
            return np.concatenate([alone, amounts])
        spanned = inverse @ a[np.ix_(free, bounded)]
        left = a[np.ix_(bounded, bounded)] - a[np.ix_(bounded, free)] @ spanned
        scale = np.sqrt(np.diag(a)[bounded])
        value, vector = np.linalg.eigh(left / np.outer(scale, scale) + RIDGE * np.eye(len(bounded)))
        root = np.sqrt(np.maximum(value, RIDGE))
        aim = vector.T @ ((b[bounded] - a[np.ix_(bounded, free)] @ alone) / scale)
        amounts[seen] = nnls(root[:, None] * vector.T, aim / root, maxiter=100 * len(bounded))[0] / scale
        return np.concatenate([alone - spanned @ amounts[seen], amounts])

    def residual_square(self, which: Ints) -> float:
        """Weighted sum of squares that the fit on columns `which` leaves."""
        if len(which) == 0:
            return float(self.square.sum())
        amplitudes, _ = self.solve(which)
        return float(self.square.sum() - amplitudes @ self._sums(None)[1][which])

    def gains(self, base: Ints, blocks: list[Ints]) -> Floats:
        """Fall of the weighted sum of squares when each block of columns is added to `base`."""
        beside = self.beside(base)
        return beside.gains(np.arange(0), beside.blocks(blocks), len(blocks))

    def beside(self, base: Ints) -> Beside:
        """What all columns hold beside the fit on columns `base`."""
        a, b = self._sums(None)
        amplitudes, inverse = self.solve(base)
        spanned = a[:, base] @ inverse
        square = float(self.square.sum() - amplitudes @ b[base])
        return Beside(a - spanned @ a[base], b - a[:, base] @ amplitudes, square, np.diag(a).copy())

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
            at = rows[start : start + BATCH]
            yield at, np.arange(columns.shape[1]), columns[at] * root[at, None]
        return
    starts = np.cumsum([0, *(block.count for block in columns)]).tolist()
    ends = np.searchsorted(rows, [*columns[0].cuts, len(root)])
    for used, pieces in zip(np.diff(ends), zip(*(block.stretches for block in columns), strict=True), strict=True):
        if used == 0:
            continue
        at, which = pieces[0].rows, [piece.which + start for piece, start in zip(pieces, starts, strict=False)]
        own, part, filled = root[at, None], np.empty((len(pieces[0].values), sum(map(len, which)))), 0
        for piece in pieces:
            filled += len(piece.which)
            np.multiply(piece.values, own, out=part[:, filled - len(piece.which) : filled])
        yield at, np.concatenate(which), part


@dataclass(frozen=True, slots=True)
class Block:
    """Candidates of one number of columns, which are tried one by one and solved together.

    Parameters
    ----------
    at : (n,) int
        Which candidates.
    which : (n, size) int
        The columns of each that anybody sees: what nobody sees neither helps nor hinders.
    information : (n, size, size) float
        Of these columns.
    """

    at: Ints
    which: Ints
    information: Floats


@dataclass(frozen=True, slots=True)
class Beside:
    """The sums of columns without what others span of them: a fit on them is the fit on both (Frisch and Waugh 1933, Lovell 1963).

    So what is in every fit is solved for once, and a search goes on with the few columns that it tries.

    Parameters
    ----------
    information : (p, p) float
    moment : (p,) float
    square : float
        Weighted sum of squares that the others leave.
    own : (p,) float
        Weighted squares of the whole columns; by these the ridge is measured.
    """

    information: Floats
    moment: Floats
    square: float
    own: Floats

    def solve(self, which: Ints) -> tuple[Floats, Floats]:
        """Amplitudes and inverse information of the fit on columns `which` beside the others."""
        scaled, root = self._scaled(which)
        inverse = np.linalg.inv(scaled) / (root[:, None] * root)
        return inverse @ self.moment[which], inverse

    def fit(self, which: Ints) -> tuple[Floats, float]:
        """Amplitudes of the fit on columns `which`, and the weighted sum of squares that it leaves."""
        if len(which) == 0:
            return np.zeros(0), self.square
        scaled, root = self._scaled(which)
        amplitudes = np.linalg.solve(scaled, self.moment[which] / root) / root
        return amplitudes, float(self.square - amplitudes @ self.moment[which])

    def _scaled(self, which: Ints) -> tuple[Floats, Floats]:
        """The information of columns `which` in the lengths of the whole columns, with the ridge; and these lengths."""
        root = np.sqrt(self.own[which])
        root[root == 0.0] = 1.0  # a column nobody sees gets no amplitude
        scaled = self.information[which[:, None], which] / (root[:, None] * root)
        scaled.flat[:: len(which) + 1] += RIDGE
        return scaled, root

    def blocks(self, candidates: list[Ints]) -> tuple[Block, ...]:
        """Candidates, each some columns, in groups of one size."""
        seen = [columns[self.own[columns] > 0.0] for columns in candidates]
        sizes = np.array([len(columns) for columns in seen])
        groups = []
        for size in np.unique(sizes[sizes > 0]):
            at = np.flatnonzero(sizes == size)
            which = np.array([seen[i] for i in at])
            groups.append(Block(at, which, self.information[which[:, :, None], which[:, None, :]]))
        return tuple(groups)

    def gains(self, base: Ints, blocks: tuple[Block, ...], count: int) -> Floats:
        """Fall of the weighted sum of squares when each of `count` candidates is added to `base`, (count,)."""
        rest, across = self.moment, self.information[:, base]
        if len(base):
            amplitudes, inverse = self.solve(base)
            rest = rest - across @ amplitudes
            spanned = across @ inverse
        result = np.zeros(count)
        for block in blocks:
            which, left = block.which, block.information
            if len(base):
                left = left - spanned[which] @ across[which].swapaxes(1, 2)
            diagonal = np.einsum("nii->ni", left)
            # A column that the base already spans has nothing left: no gain from rounding.
            good = (diagonal >= SPANNED * self.own[which]).all(axis=1)
            if which.shape[1] == 1:
                at = which[good, 0]
                result[block.at[good]] = rest[at] ** 2 / (diagonal[good, 0] * (1.0 + RIDGE))
            elif good.any():
                ridge = RIDGE * diagonal[good][:, :, None] * np.eye(which.shape[1])
                aim = rest[which[good]]
                result[block.at[good]] = np.einsum("ni,ni->n", aim, np.linalg.solve(left[good] + ridge, aim[..., None])[..., 0])
        return result

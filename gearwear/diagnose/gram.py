"""Sufficient statistics of a weighted linear fit, kept fold by fold, and the fits made from them.

With the columns of all candidates at hand once, every fit, every gain and every held-out error is a small dense solve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints

RIDGE = 1e-9
"""Relative to the column's own sum: keeps exactly collinear columns solvable; they gain nothing by it."""


BATCH = 4096
"""Rows that are weighted at a time: no copy of all columns is made, and what is in work stays near the processor."""
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
    def of(cls, columns: Floats | tuple[Floats, ...], target: Floats, weight: Floats, fold: Ints, folds: int) -> Gram:
        """Collect the statistics of columns, or of blocks of them side by side; rows with zero weight are left out."""
        blocks = columns if isinstance(columns, tuple) else (columns,)
        p = sum(block.shape[1] for block in blocks)
        information, moment = np.zeros((folds, p, p)), np.zeros((folds, p))
        square, total = np.zeros(folds), np.zeros(folds)
        for f in range(folds):
            rows = np.flatnonzero((weight > 0.0) & (fold == f))
            for start in range(0, len(rows), BATCH):
                at = rows[start : start + BATCH]
                root = np.sqrt(weight[at])
                d = target[at] * root
                part = np.hstack([block[at] for block in blocks]) if len(blocks) > 1 else blocks[0][at]
                part *= root[:, None]
                information[f] += part.T @ part
                moment[f] += part.T @ d
                square[f] += float(d @ d)
                total[f] += float(weight[at].sum())
        return cls(information, moment, square, total)

    def solve(self, which: Ints, without: int | None = None) -> tuple[Floats, Floats]:
        """Amplitudes and inverse information of the fit on columns `which`, on all folds or all but one."""
        a, b = self._sums(without)
        block = a[np.ix_(which, which)]
        scale = np.sqrt(np.diag(block))
        scale[scale == 0.0] = 1.0  # a column nobody sees gets no amplitude
        scaled = block / np.outer(scale, scale) + RIDGE * np.eye(len(which))
        inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
        return inverse @ b[which], inverse

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
        """Fall of the weighted sum of squares when each block of columns is added to `base`; blocks of one size are solved together."""
        a, b = self._sums(None)
        amplitudes, inverse = self.solve(base)
        rest = b - a[:, base] @ amplitudes
        spanned = a[:, base] @ inverse
        own = np.diag(a)
        result = np.zeros(len(blocks))
        # What nobody sees neither helps nor hinders.
        seen = blocks if (own > 0.0).all() else [block[own[block] > 0.0] for block in blocks]
        sizes = np.array([len(block) for block in seen])
        for size in np.unique(sizes[sizes > 0]):
            at = np.flatnonzero(sizes == size)
            which = np.array([seen[i] for i in at])
            left = a[which[:, :, None], which[:, None, :]] - np.einsum(
                "nib,nbj->nij", spanned[which], a[base][:, which].swapaxes(0, 1)
            )
            diagonal = np.einsum("nii->ni", left)
            # A column that the base already spans has nothing left: no gain from rounding.
            good = (diagonal >= SPANNED * own[which]).all(axis=1)
            if not good.any():
                continue
            ridge = 1e-9 * diagonal[good][:, :, None] * np.eye(size)
            aim = rest[which[good]]
            result[at[good]] = np.einsum("ni,ni->n", aim, np.linalg.solve(left[good] + ridge, aim[..., None])[..., 0])
        return result

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

"""What the cells weigh in sums over worn regions, tooth side by tooth side.

A region lies on one tooth, and many regions in one array over all cells would be zeros for the most part: with every tooth of a large gear worn, more
memory than the scan. Only the surface that the flanks of a side have in common is made of all of them, and there the weights are a product.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats, Ints

OnSide = tuple[tuple[int, int], Ints, Floats]
"""Tooth and side; which of the sums, (n,), take anything from its cells; and what, (n, rows, columns)."""


@dataclass(frozen=True, slots=True)
class SideWeights:
    """Weights of cells in sums of which each has a tooth side of its own.

    Parameters
    ----------
    where : (k, 2) int
        Tooth and side of each sum, no two alike.
    own : (k, rows, columns) float
        What each takes from the cells of that.
    passed : dict of (k, rows, columns) float
        By side, what each takes from the means over all flanks of it, besides.
    share : dict of (teeth, rows, columns) float
        By side, the share of each flank in these means.
    """

    where: Ints
    own: Floats
    passed: Mapping[int, Floats]
    share: Mapping[int, Floats]

    def __len__(self) -> int:
        return len(self.where)

    def by_side(self) -> Iterator[OnSide]:
        """One tooth side after another."""
        for tooth, half in self.where[~np.isin(self.where[:, 1], list(self.passed))].tolist():
            at = np.flatnonzero((self.where == (tooth, half)).all(axis=1))
            yield (tooth, half), at, self.own[at]
        for half, passed in self.passed.items():
            which = np.flatnonzero(self.where[:, 1] == half)
            for tooth, share in enumerate(self.share[half]):
                values = passed[which] * share
                itself = self.where[which, 0] == tooth
                values[itself] += self.own[which[itself]]
                yield (tooth, half), which, values


def by_side(weights: Floats | SideWeights) -> Iterator[OnSide]:
    """Weights tooth side by tooth side; also of an array over all of them, (k, teeth, 2, rows, columns)."""
    if isinstance(weights, SideWeights):
        yield from weights.by_side()
        return
    used: Bools = np.any(weights, axis=(3, 4))
    for tooth, half in np.argwhere(np.any(used, axis=0)).tolist():
        which = np.flatnonzero(used[:, tooth, half])
        yield (tooth, half), which, weights[which, tooth, half]

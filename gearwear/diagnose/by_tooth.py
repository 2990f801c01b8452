"""Effects of which every tooth has an amount, taken out of everything else: each column lies on a tooth, and costs what a tooth does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from gearwear.arrays import Floats

ALIKE = 1e-5
"""Part of a column that others leave, below which squares of the columns lose too many digits; numerical."""


@dataclass(frozen=True, slots=True)
class ByTooth:
    """What columns that are not zero on few cells span.

    Parameters
    ----------
    columns : (n, k) sparse
        Each cell in its standard deviations.
    across : (k, n) sparse
        The same, turned once.
    inverse : (k, k) float
        Of Cholesky's factor of their products.
    """

    columns: csr_array
    across: csr_array
    inverse: Floats

    @classmethod
    def of(cls, columns: Floats) -> ByTooth | None:
        """Of columns (n, k); None where they are nearly the same, or one is nothing."""
        kept = csr_array(columns)
        across = kept.T.tocsr()
        products = (across @ kept).toarray()
        size = np.sqrt(np.diag(products))
        if not (size > 0.0).all():
            return None
        try:
            root = np.linalg.cholesky(products / np.outer(size, size))
        except np.linalg.LinAlgError:
            return None
        return cls(kept, across, np.linalg.inv(root) / size) if np.diag(root).min() > ALIKE else None

    def along(self, values: Floats) -> Floats:
        """Coordinates of values (n, q) in what the columns span, square to each other and of length 1, (k, q)."""
        return np.asarray(self.inverse @ (self.across @ values), dtype=np.float64)

    def beside(self, values: Floats) -> Floats:
        """What the columns leave of values (n, q); twice, for the digits that the first time loses."""
        for _ in range(2):
            values = values - self.columns @ (self.inverse.T @ self.along(values))
        return values

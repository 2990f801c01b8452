"""Columns over cells, kept stretch by stretch without those that are zero throughout: most effects act on some surfaces, on a sector or on a tooth.

So what a sum over all columns takes goes with what is not zero: a freedom for every tooth costs what one tooth does.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP
from gearwear.placing.cells import CellGrid

LEAST_ROWS = 384
"""Cells from which on a stretch is long enough: what it takes to begin one is little beside its sums."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Some consecutive cells.

    Parameters
    ----------
    rows : slice
        The cells.
    which : (k,) int
        The columns that are not zero on all of them.
    values : (n, k) float
        These columns there.
    """

    rows: slice
    which: Ints
    values: Floats


@dataclass(frozen=True, slots=True)
class CellColumns:
    """Columns (m, p) over cells.

    Parameters
    ----------
    rows, count : int
        m and p.
    stretches : tuple of Stretch
        In order, all cells together.
    """

    rows: int
    count: int
    stretches: tuple[Stretch, ...]

    @classmethod
    def of(cls, values: Floats, cuts: Ints) -> CellColumns:
        """Columns (m, p) from their values; a stretch begins at each of `cuts`, and the last ends at m."""
        stretches = []
        for start, stop in zip(cuts, [*cuts[1:], len(values)], strict=True):
            rows = slice(int(start), int(stop))
            which = np.flatnonzero(values[rows].any(axis=0))
            stretches.append(Stretch(rows, which, np.ascontiguousarray(values[rows][:, which])))
        return cls(len(values), values.shape[1], tuple(stretches))

    @classmethod
    def side_by_side(cls, parts: Sequence[CellColumns]) -> CellColumns:
        """Columns behind one another, all with the same stretches."""
        starts = np.cumsum([0, *(part.count for part in parts)])
        joined = []
        for pieces in zip(*(part.stretches for part in parts), strict=True):
            which = np.concatenate([piece.which + start for piece, start in zip(pieces, starts[:-1], strict=True)])
            joined.append(Stretch(pieces[0].rows, which, np.hstack([piece.values for piece in pieces])))
        return cls(parts[0].rows, int(starts[-1]), tuple(joined))

    @classmethod
    def gathered(cls, blocks: Iterable[Floats], cuts: Ints, together: int = 64) -> CellColumns:
        """Blocks of columns (m, q) behind one another; no more than about `together` of them are ever held with their zeros."""
        parts, waiting = list[CellColumns](), list[Floats]()
        for block in blocks:
            waiting.append(block)
            if sum(one.shape[1] for one in waiting) >= together:
                parts.append(cls.of(np.hstack(waiting), cuts))
                waiting = []
        if waiting or not parts:
            parts.append(cls.of(np.hstack(waiting) if waiting else np.zeros((int(cuts[-1]), 0)), cuts))
        return cls.side_by_side(parts)

    @property
    def cuts(self) -> Ints:
        """First cell of each stretch."""
        return np.array([stretch.rows.start for stretch in self.stretches], dtype=np.int64)

    def put(self, place: Ints, out: Floats) -> None:
        """Write columns into those of `out` (m, q), which is zero there: column i into `place[i]`, where that is not negative."""
        for stretch in self.stretches:
            to = place[stretch.which]
            wanted = to >= 0
            if wanted.any():
                out[stretch.rows][:, to[wanted]] = stretch.values[:, wanted]

    def times(self, amplitudes: Floats) -> Floats:
        """(m,) sum of the columns with amplitudes (p,)."""
        result = np.zeros(self.rows)
        for stretch in self.stretches:
            result[stretch.rows] = stretch.values @ amplitudes[stretch.which]
        return result


def cuts_among(cuts: Ints, rows: Ints) -> Ints:
    """First of some cells `rows` (n,) of each stretch that has any of them."""
    return np.unique(np.searchsorted(rows, cuts[cuts <= rows[-1]])) if len(rows) else np.zeros(0, dtype=np.int64)


def cuts_of(grid: CellGrid) -> Ints:
    """First cells of the stretches of a grid: some whole tooth sides, or teeth, of one surface."""
    across = {
        FLANK: grid.rows * grid.flank,
        FILLET: grid.rows * grid.fillet,
        TIP: grid.rows * grid.tip,
        ROOT: grid.rows * grid.root,
    }
    units = across | {END_LOW: 2 * grid.ring, END_HIGH: 2 * grid.ring, BORE: grid.rows}
    cuts = [
        np.arange(start, start + size, units[surface] * max(1, -(-LEAST_ROWS // units[surface])))
        for surface, (start, size) in grid.blocks.items()
    ]
    return np.concatenate(cuts)

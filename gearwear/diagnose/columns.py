"""Columns over cells, kept stretch by stretch without those that are zero throughout: most effects act on some surfaces, on a sector or on a tooth.

So what a sum over all columns takes goes with what is not zero: a freedom for every tooth costs what one tooth does.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
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

    @classmethod
    def of(cls, rows: slice, values: Floats) -> Stretch:
        """Of the values (n, p) of all columns there."""
        which = np.flatnonzero(values.any(axis=0))
        return cls(rows, which, np.ascontiguousarray(values[:, which]))


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
        return cls.of_pieces(values[rows] for rows in between(cuts, len(values)))

    @classmethod
    def of_pieces(cls, pieces: Iterable[Floats]) -> CellColumns:
        """Columns from their values (n, p) on each stretch in turn."""
        stretches, start, count = list[Stretch](), 0, 0
        for piece in pieces:
            stretches.append(Stretch.of(slice(start, start + len(piece)), piece))
            start, count = start + len(piece), piece.shape[1]
        return cls(start, count, tuple(stretches))

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
    def gathered(cls, blocks: Iterable[Floats | CellColumns], cuts: Ints, together: int = 64) -> CellColumns:
        """Blocks of columns (m, q) behind one another; no more than about `together` of them are ever held with their zeros."""
        parts, waiting = list[CellColumns](), list[Floats]()

        def put_away() -> None:
            if waiting:
                parts.append(cls.of(np.hstack(waiting), cuts))
                waiting.clear()

        for block in blocks:
            if isinstance(block, CellColumns):
                put_away()
                parts.append(block)
            else:
                waiting.append(block)
            if sum(one.shape[1] for one in waiting) >= together:
                put_away()
        put_away()
        return cls.side_by_side(parts or [cls.of(np.zeros((int(cuts[-1]), 0)), cuts)])

    @property
    def cuts(self) -> Ints:
        """First cell of each stretch."""
        return np.array([stretch.rows.start for stretch in self.stretches], dtype=np.int64)

    def seen(self, cells: Bools) -> Bools:
        """(p,) which columns are not zero on all of some cells (m,)."""
        result = np.zeros(self.count, dtype=np.bool_)
        for stretch in self.stretches:
            result[stretch.which] |= stretch.values[cells[stretch.rows]].any(axis=0)
        return result

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


def between(cuts: Ints, rows: int) -> list[slice]:
    """The stretches of so many cells that begin at each of `cuts`."""
    return [slice(start, stop) for start, stop in pairwise([*cuts.tolist(), rows])]


def cuts_among(cuts: Ints, rows: Ints) -> Ints:
    """First of some cells `rows` (n,) of each stretch that has any of them."""
    return np.unique(np.searchsorted(rows, cuts[cuts <= rows[-1]])) if len(rows) else np.zeros(0, dtype=np.int64)


def cuts_of(grid: CellGrid, share: float = 1.0) -> Ints:
    """First cells of the stretches of a grid: some whole tooth sides, or teeth, of one surface; so many that `share` of their cells is a long enough stretch."""
    least = math.ceil(LEAST_ROWS / share)
    across = {
        FLANK: grid.rows * grid.flank,
        FILLET: grid.rows * grid.fillet,
        TIP: grid.rows * grid.tip,
        ROOT: grid.rows * grid.root,
    }
    units = across | {END_LOW: 2 * grid.ring, END_HIGH: 2 * grid.ring, BORE: grid.rows}
    cuts = [
        np.arange(start, start + size, units[surface] * max(1, -(-least // units[surface])))
        for surface, (start, size) in grid.blocks.items()
    ]
    return np.concatenate(cuts)

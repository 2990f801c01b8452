"""A fit on fewer cells: neighbours along z put together, and of very many teeth every second or third, for a question that needs no more.

Which sides are worn throughout is told by a profile that all flanks of a side share, and by how much of it each has: means over many teeth, smooth along
z. Columns and deviations are averaged alike, so that a fit loses nothing but what goes up and down within a cell; and what fifty teeth do not show of all
is no wear of a whole side. Half as many tell as well where there is no doubt.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.surface import TIP, SurfacePoints
from gearwear.diagnose.columns import CellColumns, cuts_of
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import Dictionary
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.effects.each_tooth import EachTooth
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import CellGrid, cells_of

ENOUGH_CELLS = 10_000
"""Cells beyond which rows are put together, and then teeth left out."""
LOOK_CELLS, FEWEST_TEETH = 5_000, 24
"""The same at a first look, which is asked again where it leaves a doubt, and the teeth that it leaves in any case; numerical."""
TOGETHER = 64
"""Columns that are averaged at a time; numerical."""


def few_rows(grid: CellGrid) -> CellGrid:
    """The grid with so many rows put together, always as many, that few cells are left; itself where they are few.

    With 6 rows, what one place of a flank has lost spoils so much of it that of a gear worn on both sides one was not told as worn.
    """
    few = grid
    for together in range(2, grid.rows // rules().rows_of_sides + 1):
        if few.count <= ENOUGH_CELLS:
            break
        few = replace(grid, rows=grid.rows // together)
    return few


def few_teeth(grid: CellGrid, points: SurfacePoints, look: bool = False) -> Bools:
    """Points on every n-th tooth, and off the teeth, where a grid with few rows has n times as many cells as are needed, or as a first look needs."""
    every = min(round(grid.count / LOOK_CELLS), grid.gear.teeth // FEWEST_TEETH) if look else 0
    every = max(1, every, round(grid.count / ENOUGH_CELLS))
    kept: Bools = (points.tooth % every == 0) | (points.surface > TIP)
    return kept


def leaves_teeth_out(fit: Fit, look: bool = False) -> bool:
    """Whether `on_few_cells` leaves teeth out."""
    return not few_teeth(few_rows(fit.cells.grid), fit.cells.points, look).all()


def on_few_cells(fit: Fit, sound: Bools, noise: float, context: Context, look: bool = False) -> tuple[Fit, Bools]:
    """A fit on few cells, and which of these (m,) have anything in them.

    Where teeth are left out, what each tooth has of its own is an amount of each that is left, mean 0 over these: columns of the others are 0.

    Parameters
    ----------
    fit : Fit
    sound : (m,) bool
        Cells that a fit may use: the others come into none.
    noise : float
        Scatter of points, mm.
    context : Context
    look : bool
        Whether it is a first look.
    """
    grid = few_rows(fit.cells.grid)
    kept = few_teeth(grid, fit.cells.points, look)
    if grid is fit.cells.grid and kept.all():
        return fit, sound
    rows = np.flatnonzero(sound & kept)
    into = np.full(len(sound), -1, dtype=np.int64)
    into[rows] = grid.index(fit.cells.points.take(rows))
    cells = cells_of(fit.cells.sums.gathered(into, grid.count), grid)
    share = fit.cells.count[rows] / cells.count[into[rows]]
    mean = csr_matrix((share, (into[rows], rows)), shape=(grid.count, len(sound)))
    dictionary, known = fit.dictionary, fit.covariance
    on_teeth = fit.cells.points.surface <= TIP
    less, none = _of_teeth_kept(dictionary, context, np.unique(fit.cells.points.tooth[kept & on_teeth]))
    taken_off = {int(column): mean @ dictionary.take(column[None])[:, 0] for column in np.unique(less[less >= 0])}

    def averaged() -> Iterator[Floats]:
        for start in range(0, dictionary.count, TOGETHER):
            which = np.arange(start, min(start + TOGETHER, dictionary.count))
            columns = mean @ dictionary.take(which)
            for column, values in taken_off.items():
                from_these = np.flatnonzero(less[which] == column)
                if len(from_these):
                    columns[:, from_these] -= values[:, None]
            if none[which].any():
                columns[:, none[which]] = 0.0
            yield columns

    # Of the teeth that are left out nothing is seen: stretches are as much longer.
    columns = CellColumns.gathered(averaged(), cuts_of(grid, float(kept.mean())), TOGETHER)
    together = fit.cells.grid.rows // grid.rows
    apart = np.abs(np.subtract.outer(np.arange(together), np.arange(together)))
    covariance = CellCovariance(
        grid,
        noise**2 / np.maximum(cells.count, 1.0),
        known.texture * float((known.row_step**apart).mean()),
        known.row_step**together,
        known.column_step,
    )
    few = replace(dictionary, first=columns, more=())
    return Fit(cells, mean @ fit.target, few, cells.seen, covariance), cells.seen


def _of_teeth_kept(dictionary: Dictionary, context: Context, kept: Ints) -> tuple[Ints, Bools]:
    """Of what each tooth has of its own, where some are `kept`: which column is taken off each, (p,), -1 for none, so that the last that is kept has minus the
    sum of the others' in place of one that is not; and which columns are left out, (p,)."""
    less, none = np.full(dictionary.count, -1), np.zeros(dictionary.count, dtype=np.bool_)
    for candidate in dictionary.candidates:
        if not isinstance(candidate.effect, EachTooth):
            continue
        *others, last = candidate.effect.teeth(context)
        there = np.isin(others, kept)
        if not (there.all() and last in kept):
            own, none[candidate.columns] = candidate.columns[there], ~there
            if last not in kept and len(own):
                less[own[:-1]], none[own[-1]] = own[-1], True
    return less, none

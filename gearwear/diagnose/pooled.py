"""The cells that the loop works on: as many as a fit of effects needs, however large the gear and however dense the scan.

An effect is smooth, or goes up and down a few times across the face; its size is a mean over all teeth. So rows along z are pooled beyond what
shows the shortest waves of the catalogue, then rings of the end faces, and columns along the profile only where cells would be very many. Wear,
volumes and maps keep the cells that the scan has: what the loop found is carried back to them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.covariance import estimate_covariance
from gearwear.diagnose.found import Loop
from gearwear.diagnose.masks import sound_cells
from gearwear.diagnose.pattern import Pattern
from gearwear.diagnose.untold import with_untold
from gearwear.placing.cells import CellGrid, Cells

ENOUGH_CELLS = 16_000
"""Cells beyond which rows, and rings of the end faces, are pooled: the work of the loop goes with its cells, and what it finds hardly does."""
MOST_CELLS = 40_000
"""Cells beyond which columns along the profile are pooled too, where reliefs begin."""
FEWEST_ROWS = 16
"""Rows that are left."""
FEWEST_RINGS = 8
"""Rings of the end faces that are left: what is looked for there is a plane, or as smooth."""
ROUGH_CELLS, ROUGH_ROWS = 12_000, 8
"""Cells and rows that tell whether a scan lies far off its design, and how: it is located again then, and the loop closed on `loop_grid`. As many rows as
which sides are worn throughout is told by (`rows_of_sides`): where that is beyond doubt it is not asked again."""
WIDER = 1.1
"""Factor by which the columns are made wider at a time."""


def loop_grid(grid: CellGrid) -> CellGrid:
    """The grid for the loop: that of the scan where it has no more than `ENOUGH_CELLS`, or few rows and rings."""
    pooled = _within(grid, ENOUGH_CELLS, MOST_CELLS, FEWEST_ROWS)
    return grid if pooled.count == grid.count else pooled


def rough_grid(grid: CellGrid) -> CellGrid | None:
    """The grid for a first look; None where the loop works on the cells of the scan, and a first look saves nothing."""
    return None if grid.count <= MOST_CELLS else _within(grid, ROUGH_CELLS, ROUGH_CELLS, ROUGH_ROWS)


def _within(grid: CellGrid, enough: int, most: int, fewest_rows: int) -> CellGrid:
    """A grid of about `enough` cells by fewer rows, then by fewer rings on the end faces; and of at most about `most` by wider columns."""
    least = min(grid.rows, fewest_rows)
    wide, size = grid, grid.size
    while _rows_within(wide, enough) < least and wide.ring > FEWEST_RINGS:
        wide = replace(wide, ring=max(FEWEST_RINGS, int(wide.ring / WIDER)))
    rings = wide.ring
    while _rows_within(wide, most) < least and min(wide.flank, wide.fillet) > 3:
        size *= WIDER
        columns = CellGrid.for_scan(grid.gear, 1, size=size, planar=grid.rows == 1)
        wide = replace(columns, rows=grid.rows, ring=min(columns.ring, rings))
    return replace(wide, rows=min(max(least, _rows_within(wide, enough)), grid.rows))


def _rows_within(grid: CellGrid, most: int) -> int:
    """Rows with which a grid has so many cells."""
    ends = 4 * grid.gear.teeth * grid.ring
    return int((most - ends) / ((grid.count - ends) / grid.rows))


def left_out(loop: Loop, pooled: Cells, cells: Cells) -> Bools:
    """Cells of a finer grid, (m,), that lie in those a loop on fewer cells, `pooled`, left out because they look worn.

    None are where it found a side worn throughout: which that is the finer cells decide for themselves.
    """
    result = np.zeros(len(cells.seen), dtype=np.bool_)
    if not loop.worn_sides:
        seen = cells.seen
        out = sound_cells(pooled, loop.worn_sides) & ~loop.use
        result[seen] = out[pooled.grid.index(cells.points.take(seen))]
    return result


def carried(loop: Loop, pooled: Cells, cells: Cells, noise: float) -> Loop:
    """What was found on the loop's cells, on those of the scan.

    Parameters
    ----------
    loop : Loop
        On `pooled`.
    pooled, cells : Cells
        The same points in the cells of the loop and in those of the scan.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    Loop
        Effects, their sizes and errors as they are; masks, residuals and fields on `cells`, each with that of the cell it lies in; and the
        covariance of the means of `cells`, from what the loop leaves there.
    """
    seen = cells.seen
    at = pooled.grid.index(cells.points.take(seen))

    def on_cells(values: Floats) -> Floats:
        result = np.zeros((len(seen), *values.shape[1:]))
        result[seen] = values[at]
        return result

    measured, mean = (np.where(one.seen, np.nan_to_num(one.points.deviation), 0.0) for one in (cells, pooled))
    before, after = (
        np.where(seen, measured - on_cells(mean - residual), 0.0) for residual in (loop.residual_before, loop.residual_after)
    )
    use = sound_cells(cells, loop.context.worn, faces=loop.context.faces) & (on_cells(loop.use.astype(np.float64)) > 0.0)
    whole = replace(
        loop,
        use=use,
        residual_before=before,
        residual_after=after,
        patterns=tuple(
            replace(pattern, field=on_cells(pattern.field))
            if pattern.in_space is None
            else Pattern.of_wave(cells, pattern.in_space)
            for pattern in loop.patterns
        ),
        hidden=None if loop.hidden is None else on_cells(loop.hidden),
        together=None if loop.together is None else on_cells(loop.together),
        others=tuple(carried(other, pooled, cells, noise) for other in loop.others),
        untold=None,
    )
    return with_untold(replace(whole, covariance=estimate_covariance(cells, whole.left, use, noise)), cells)

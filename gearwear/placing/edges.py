"""Edges of flanks that are rounded or broken off alike on all teeth: seen, but no part of the flank."""

from __future__ import annotations

import warnings

import numpy as np

from gearwear.arrays import Bools
from gearwear.placing.cells import Cells

DEEPEST_SHARE = 0.25
"""Of the face width, from each end: what reaches further is no edge."""
LEAST_DROP_MODULES, LEAST_DROP_NOISES = 0.01, 4.0
"""By how much an edge lies lower than the middle of the face, in modules and in the scatter of points, whichever is more."""
FEWEST_ROWS = 8
"""Rows of cells from which an edge can be told from the flank."""


def rounded_ends(cells: Cells, noise: float) -> Bools:
    """Cells next to the ends of the face where typical flanks of both sides fall off alike, (m,): rounded, deburred or chamfered ends.

    Wear at one end is on the side that carries; a tool that breaks edges takes both.

    Parameters
    ----------
    cells : Cells
    noise : float
        Scatter of points, mm.
    """
    grid = cells.grid
    flank = grid.flank_shape(cells.points.deviation)
    rounded = np.zeros(grid.sides(cells.count).shape, dtype=bool)
    if grid.rows < FEWEST_ROWS:
        return grid.on_cells(rounded)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # places nobody saw
        typical = np.nanmedian(flank, axis=0)
        quarter = max(int(DEEPEST_SHARE * grid.rows), 1)
        fall = typical - np.nanmedian(typical[:, quarter : grid.rows - quarter], axis=1, keepdims=True)
        limit = max(LEAST_DROP_MODULES * grid.gear.transverse_module, LEAST_DROP_NOISES * noise)
    low = np.all(~(fall > -limit), axis=0)  # or not seen
    # What is low all the way reaches further, and is no edge.
    from_low = np.logical_and.accumulate(low[:quarter], axis=0) & ~low[:quarter].all(axis=0)
    from_high = (np.logical_and.accumulate(low[::-1][:quarter], axis=0) & ~low[::-1][:quarter].all(axis=0))[::-1]
    for rows, edge in ((slice(0, quarter), from_low), (slice(grid.rows - quarter, grid.rows), from_high)):
        # Unseen places alone, as where a scan stops, are no edge.
        there = edge & (np.nan_to_num(fall[:, rows]) < -limit).any(axis=(0, 1))
        rounded[:, :, rows, grid.fillet :] = there
    return grid.on_cells(rounded)

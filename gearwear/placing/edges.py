"""Edges of flanks that are rounded or broken off alike on all teeth: seen, but no part of the flank."""

from __future__ import annotations

import warnings

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.placing.cells import Cells

DEEPEST_SHARE = 0.25
"""Of the face width, from each end: what reaches further is no edge."""
LEAST_DROP_MODULES, LEAST_DROP_NOISES = 0.01, 4.0
"""By how much an edge lies lower than the middle of the face, in modules and in the scatter of points, whichever is more."""
FEWEST_ROWS = 8
"""Rows of cells from which an edge can be told from the flank."""


def rounded_ends(cells: Cells, noise: float) -> Bools:
    """Cells next to the ends of the face, or of each half, where typical flanks of both sides fall off alike, (m,): rounded, deburred or
    chamfered ends.

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
    limit = least_drop(grid.gear.transverse_module, noise)
    for rows, _ in grid.zones:
        if rows.stop - rows.start < FEWEST_ROWS:
            continue
        fall = typical_fall(flank[:, :, rows])
        seen_low = (fall < -limit).any(axis=0)
        low: Bools = np.all(~(fall > -limit), axis=0)  # or not seen
        for edge in at_either_end(low):
            # Unseen places alone, as where a scan stops, are no edge.
            rounded[:, :, rows, grid.fillet :] |= edge & (edge & seen_low).any(axis=0)
    return grid.on_cells(rounded)


def typical_fall(flanks: Floats) -> Floats:
    """How much typical flanks of (teeth, 2, rows, ...) lie lower, or higher, than the face goes on from its middle half, (2, rows, ...); nan where not seen.

    It goes on level or along the straight line through the middle half, whichever is lower: teeth that taper, as moulded ones do, have no edge at their
    thin end, and nothing is low for a slope of the middle alone.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # places nobody saw
        typical = np.nanmedian(flanks, axis=0)
        rows = typical.shape[1]
        quarter = _quarter(rows)
        height = np.broadcast_to(np.arange(rows, dtype=np.float64).reshape(-1, *[1] * (typical.ndim - 2)), typical.shape)
        seen, middle = np.where(np.isnan(typical), np.nan, height), slice(quarter, rows - quarter)
        fall = typical - np.nanmedian(typical[:, middle], axis=1, keepdims=True)
        half = (rows - 2 * quarter) // 2
        halves = [slice(quarter, quarter + half), slice(rows - quarter - half, rows - quarter)]
        rise, run = (
            np.subtract(*(np.nanmedian(values[:, part], axis=1, keepdims=True) for part in halves)) for values in (typical, seen)
        )
        return np.asarray(np.fmax(fall, fall - rise / run * (height - np.nanmedian(seen[:, middle], axis=1, keepdims=True))))


def least_drop(module: float, noise: float) -> float:
    """By how much an edge lies lower than the middle of the face, mm, from the module and the scatter of points, mm."""
    return max(LEAST_DROP_MODULES * module, LEAST_DROP_NOISES * noise)


def at_either_end(low: Bools) -> tuple[Bools, Bools]:
    """The rows (rows, ...) that are low without a break from the first on, and from the last; what is so beyond a quarter is no edge."""
    return _from_first(low), _from_first(low[::-1])[::-1]


def _from_first(low: Bools) -> Bools:
    quarter = _quarter(len(low))
    run: Bools = np.asarray(np.logical_and.accumulate(low, axis=0))
    run = run & ~run[max(quarter - 1, 1)]  # of few rows the first alone may be an edge
    run[quarter:] = False
    return run


def _quarter(rows: int) -> int:
    return max(int(DEEPEST_SHARE * rows), 1)

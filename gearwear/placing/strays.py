"""Which points of a cell are strays: held against a centre and a reach that the points themselves say, or those of a pass before."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Bools, Floats, Ints

if TYPE_CHECKING:
    from gearwear.placing.cells import CellGrid, Cells

LEAST_CENTRE_POINTS = 3
"""Points from which on a cell's centre says how steep the surface is: strays of one of two cannot be told."""
STEEPNESS_FACTOR_AT_FORM = 4.0
"""Sliding goes as 1 / roll length: within the cells at the form circle wear may be so many times what means of cells show of it."""


@dataclass(frozen=True, slots=True)
class StrayLimits:
    """How far from where a point of each of m cells may lie.

    Parameters
    ----------
    centre : (m,) float
        mm.
    limit : (m,) float
        mm; infinite where nothing is known of the cell.
    lone : (m,) bool
        Cells of one or two points that are strays.
    """

    centre: Floats
    limit: Floats
    lone: Bools

    @classmethod
    def of(cls, deviation: Floats, cell: Ints, grid: CellGrid, clip: float) -> StrayLimits:
        """What points say of themselves.

        Parameters
        ----------
        deviation : (n,) float
            mm.
        cell : (n,) int
            Of each point; −1: none.
        grid : CellGrid
        clip : float
            How far a point may lie from the centre of a level cell, mm.

        Notes
        -----
        The centre is the mean; the median in cells where a point lies further from the mean than `clip`. The limit is `clip`, and how far the
        cells round it lie apart (the edge of deep wear is steep). A cell of so few points that a stray among them cannot be told is held
        against the cells round it.
        """
        good = cell >= 0
        index = np.where(good, cell, 0)
        number = np.bincount(cell[good], minlength=grid.count)
        centre = np.bincount(cell[good], deviation[good], minlength=grid.count) / np.maximum(number, 1)
        lone = _lone(np.where(number > 0, centre, np.nan), number, grid, clip)
        good &= ~lone[index]
        doubtful = np.zeros(grid.count, dtype=bool)
        doubtful[cell[good & ~(np.abs(deviation - centre[index]) <= clip)]] = True
        at = np.flatnonzero(good & doubtful[index])
        if not len(at):
            return cls(centre, np.where(number > 0, clip, np.inf), lone)
        at = at[np.lexsort((deviation[at], cell[at]))]
        ordered, cells = deviation[at], cell[at]
        first = np.flatnonzero(np.diff(cells, prepend=-1))
        many = number[cells[first]]
        centre[cells[first]] = 0.5 * (ordered[first + (many - 1) // 2] + ordered[first + many // 2])
        reach = clip + apart(np.where(number >= LEAST_CENTRE_POINTS, centre, np.nan), grid)
        return cls(centre, np.where(number > 0, reach, np.inf), lone)

    @classmethod
    def round(cls, cells: Cells, clip: float) -> StrayLimits:
        """What the cells of a pass before say; parameters as `of`. An empty cell between others has their mean as its centre: what lay in it
        were strays."""
        mean, number, grid = cells.points.deviation, cells.count.astype(np.int64), cells.grid
        centre = np.where(number > 0, mean, _mean_round(mean, grid))
        limit = np.where(np.isfinite(centre), clip + apart(np.where(number >= LEAST_CENTRE_POINTS, mean, np.nan), grid), np.inf)
        return cls(np.nan_to_num(centre), limit, _lone(mean, number, grid, clip))

    def hold(self, deviation: Floats, cell: Ints) -> Bools:
        """(n,) points of cells that are no strays; parameters as `of`."""
        good = cell >= 0
        index = np.where(good, cell, 0)
        return np.asarray(good & ~self.lone[index] & (np.abs(deviation - self.centre[index]) <= self.limit[index]))


def near_centre(deviation: Floats, cell: Ints, grid: CellGrid, clip: float) -> Bools:
    """(n,) points within reach of their cell's centre, by what they say themselves; parameters as `StrayLimits.of`."""
    return StrayLimits.of(deviation, cell, grid, clip).hold(deviation, cell)


def _lone(centre: Floats, number: Ints, grid: CellGrid, clip: float) -> Bools:
    """(m,) cells of one or two points on a tooth side that lie off the 24 round them by more than `clip`, and at most one of these goes half as far.

    Wear deepens over more than a cell; a stray does so alone.
    """
    sides, count = grid.sides(centre), grid.sides(number.astype(np.float64))
    rows, columns = sides.shape[2:]
    wide = np.pad(sides.reshape(-1, rows, columns), ((0, 0), (2, 2), (2, 2)), constant_values=np.nan)
    shifts = [(i, j) for i in range(5) for j in range(5) if (i, j) != (2, 2)]
    at = np.argwhere(((count > 0) & (count < LEAST_CENTRE_POINTS)).reshape(-1, rows, columns))
    result = np.zeros(sides.size, dtype=bool)
    if not len(at):
        return grid.on_cells(result.reshape(sides.shape))
    around = np.stack([wide[at[:, 0], at[:, 1] + i, at[:, 2] + j] for i, j in shifts], axis=1)
    centres = sides.reshape(-1, rows, columns)[tuple(at.T)]
    known = np.isfinite(around)
    order = np.sort(around, axis=1)  # NaN last
    middle = order[np.arange(len(at)), np.maximum(known.sum(axis=1) - 1, 0) // 2]
    off = centres - middle
    with np.errstate(invalid="ignore"):
        support = ((around - middle[:, None]) * np.sign(off)[:, None] > 0.5 * np.abs(off)[:, None]).sum(axis=1)
        stray = (np.abs(off) > clip) & (support < 2) & (known.sum(axis=1) >= LEAST_CENTRE_POINTS)
    result[np.ravel_multi_index(tuple(at[stray].T), (len(wide), rows, columns))] = True
    return grid.on_cells(result.reshape(sides.shape))


def apart(centre: Floats, grid: CellGrid) -> Floats:
    """(m,) how far the cells round each cell of a tooth side lie apart, without the cell itself; 0 elsewhere.

    In the first and last column the wear may go on outside: there twice the step to the next column counts as well.
    """
    sides = grid.sides(centre)
    around = _round(sides)
    steep = np.nan_to_num(np.fmax.reduce(around) - np.fmin.reduce(around))
    for edge, inner in ((0, 1), (-1, -2)):
        steep[..., edge] = np.fmax(steep[..., edge], 2.0 * np.abs(sides[..., edge] - sides[..., inner]))
    steep[..., grid.fillet - 1 : grid.fillet + 1] *= STEEPNESS_FACTOR_AT_FORM
    return grid.on_cells(steep)


def _mean_round(centre: Floats, grid: CellGrid) -> Floats:
    """(m,) mean of the cells round each cell of a tooth side that were seen; nan where none was, and elsewhere."""
    around = _round(grid.sides(centre))
    number = np.isfinite(around).sum(axis=0)
    number, total = grid.on_cells(number), grid.on_cells(np.nansum(around, axis=0))
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)


def _round(sides: Floats) -> Floats:
    """(8, teeth, 2, rows, columns) the neighbours of each cell; nan where there is none."""
    rows, columns = sides.shape[2:]
    wide = np.pad(sides, ((0, 0), (0, 0), (1, 1), (1, 1)), constant_values=np.nan)
    return np.stack([wide[..., i : i + rows, j : j + columns] for i in range(3) for j in range(3) if (i, j) != (1, 1)])

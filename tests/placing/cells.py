"""Cells of a gear on which every deviation is put in by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid, Cells, bin_points


def every_cell(gear: Gear, size: float, times: int = 4) -> Cells:
    """So many points in the middle of every cell of all flanks, on the design."""
    grid = CellGrid.for_scan(gear, 1, size)
    edges, heights = grid.roll_edges, grid.z_edges
    middle = np.sqrt(0.5 * (edges[1:] ** 2 + edges[:-1] ** 2))
    parts = np.meshgrid(
        np.arange(gear.teeth), [1, -1], 0.5 * (heights[1:] + heights[:-1]), middle, np.arange(times), indexing="ij"
    )
    tooth, side, z, roll, _ = (part.ravel() for part in parts)
    points = flank_points(gear, tooth.astype(int), side.astype(int), roll, z)
    return bin_points(points.with_deviation(np.zeros(tooth.size)), grid)


def flanks_of(cells: Cells) -> np.ndarray:
    """(teeth, 2, rows, columns) zeros, to put deviations in."""
    grid = cells.grid
    return np.zeros((grid.gear.teeth, 2, grid.rows, grid.flank))


def with_flanks(cells: Cells, flank: np.ndarray) -> Cells:
    """The same cells with these deviations of flanks, 0 elsewhere: the points stay in the middle of their cells, so their feet move up."""
    grid = cells.grid
    deviation = grid.on_cells(np.concatenate([np.zeros((*flank.shape[:3], grid.fillet)), flank], axis=-1))
    points = cells.points
    return replace(cells, points=replace(points, deviation=deviation, roll=points.roll - deviation))

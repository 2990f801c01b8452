"""Located points in the cells of a grid: where each of them lies is found once, for all that ask for it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Ints
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.placing.cells import CellGrid, Cells, cells_of
from gearwear.placing.pits import find_far_points
from gearwear.placing.strays import near_centre
from gearwear.placing.sums import CellSums


@dataclass(frozen=True, slots=True)
class InCells:
    """Points and the cells that they lie in.

    Parameters
    ----------
    points : SurfacePoints
        The located scan, n points.
    grid : CellGrid
        The division.
    cell : (n,) int
        Cell of each point; −1: on no surface.
    near : (n,) bool
        Points within reach of their cell's centre: the others are strays, or of small pits.
    """

    points: SurfacePoints
    grid: CellGrid
    cell: Ints
    near: Bools

    @classmethod
    def of(cls, points: SurfacePoints, grid: CellGrid, clip: float) -> InCells:
        """By how far from its cell's centre a point may lie, `clip` (mm)."""
        cell = grid.index(points)
        return cls(points, grid, cell, near_centre(points.deviation, cell, grid, clip))

    def means(self) -> tuple[Cells, Bools]:
        """Means over the cells, and the points (n,) that belong to them: without strays; the points of small pits are none."""
        far, in_pits = find_far_points(self.points, self.cell, self.grid)
        belongs = self.near | in_pits
        sums = CellSums.of(self.points, np.where(belongs, self.cell, -1), self.grid.count)
        return replace(cells_of(sums, self.grid), far=far), belongs

    def flanks(self, among: Bools | None = None) -> SurfacePoints:
        """Points of flanks without strays, and without those of pits; those `among` (n,) alone."""
        kept = self.near & (self.points.surface == FLANK)
        return self.points.take(kept if among is None else kept & among)

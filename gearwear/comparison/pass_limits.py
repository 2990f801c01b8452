"""By what a pass over the points of a streamed scan tells strays and pits: of a sample held in memory, or of the pass before."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearwear.design.surface import OTHER, SurfacePoints
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.pits import FarReach, Pits, hanging_together
from gearwear.placing.strays import StrayLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class PassLimits:
    """By what a pass tells strays and pits.

    Parameters
    ----------
    grid : CellGrid
        Cells of the limits: coarser than those of the pass where a sample is too thin for these.
    limits : StrayLimits
        How far a point may lie off.
    reach : FarReach
        From where on one is counted as far off.
    pits : Pits or None
        Points that are no strays however far off; None: not known yet.
    """

    grid: CellGrid
    limits: StrayLimits
    reach: FarReach
    pits: Pits | None

    @classmethod
    def of_sample(cls, located: SurfacePoints, grid: CellGrid, clip: float) -> PassLimits:
        """What a located sample says; `clip` is how far a point may lie from the centre of a level cell, mm."""
        cell = grid.index(located)
        reach = FarReach.of(located, cell, grid)
        pits = hanging_together(reach.tally(located, cell), reach)
        coarse = grid_of_sample(located, grid)
        limits = StrayLimits.of(located.deviation, coarse.index(located), coarse, clip)
        return cls(grid=coarse, limits=limits, reach=reach, pits=pits)

    @classmethod
    def of_cells(cls, pits: Pits, cells: Cells, clip: float, noise: float) -> PassLimits:
        """What a pass before says by its pits, and its cells moved to where those of the next will lie."""
        reach = FarReach.round(cells, noise)
        return cls(grid=cells.grid, limits=StrayLimits.round(cells, clip), reach=reach, pits=replace(pits, centre=reach.centre))


def grid_of_sample(located: SurfacePoints, grid: CellGrid) -> CellGrid:
    """The grid for a located sample: that of the whole scan where its cells hold points enough, else a coarser one."""
    coarser = CellGrid.for_located(located, grid.gear, int((located.surface != OTHER).sum()))
    return coarser if coarser.size > grid.size else grid

"""`CellGrid.index` by a compiled loop: what it needs of a grid, as numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.surface import SurfacePoints
from gearwear.design.twist import segments

if TYPE_CHECKING:
    from gearwear.placing.cells import CellGrid
    from gearwear.placing.kernel import Division


def cells_at(grid: CellGrid, points: SurfacePoints) -> Ints:
    """Cell of each point, (n,) int64; −1 where the surface is OTHER."""
    from gearwear.placing.kernel import index

    cell = np.empty(len(points), dtype=np.int64)
    index(division_of(grid), *columns_of(points), cell)
    return cell


def columns_of(points: SurfacePoints) -> tuple[Ints, Ints, Ints, Floats, Floats, Floats, Floats]:
    """Surface, tooth, side, roll, position, normal and deviation, of one kind of array each: for another one numba would compile anew."""
    p = points
    codes = (
        np.ascontiguousarray(p.surface, np.int8),
        np.ascontiguousarray(p.tooth, np.int32),
        np.ascontiguousarray(p.side, np.int8),
    )
    roll, position, normal, deviation = (np.ascontiguousarray(values) for values in (p.roll, p.position, p.normal, p.deviation))
    return *codes, roll, position, normal, deviation


def division_of(grid: CellGrid) -> Division:
    """The numbers of a grid and its gear."""
    from gearwear.placing.kernel import Division

    gear, (low, high) = grid.gear, (segments(grid.gear)[0], segments(grid.gear)[-1])
    inner, outer = grid.rings(gear)
    blocks = grid.blocks
    return Division(
        orientation=float(gear.orientation),
        cos_helix=gear.base_helix_cosine,
        face_width=float(gear.face_width),
        pitch_angle=gear.pitch_angle,
        low_twist=float(low.twist),
        low_middle=float(low.middle),
        high_twist=float(high.twist),
        high_middle=float(high.middle),
        tip_half_angle=float(gear.tip_half_angle),
        root_half_angle=float(gear.root_half_angle),
        rows=grid.rows,
        row_edges=grid.z_edges if grid.groove_rows else np.zeros(0),
        flank=grid.flank,
        least_square=gear.form_roll**2,
        greatest_square=gear.tip_roll**2,
        fillet=grid.fillet,
        fillet_radius=grid.fillet_radius,
        tip=grid.tip,
        root=grid.root,
        ring=grid.ring,
        inner=float(inner),
        outer=float(outer),
        start=np.array([blocks[code][0] for code in sorted(blocks)], dtype=np.int64),
    )

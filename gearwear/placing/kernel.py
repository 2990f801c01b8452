"""`CellGrid.index` and `CellSums.add`, compiled: the same cells, and the same sums point by point.

Imported where they are called: it needs numba.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gearwear.compiled import formula, kernel

Array = Any
FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE, OTHER = range(8)


class Division(NamedTuple):
    """What the loop needs of a grid and its gear: mm, rad; the names are theirs.

    `start` holds the first cell of each surface by its code; `row_edges` the heights between rows, of a double helical gear, else nothing.
    """

    orientation: float
    cos_helix: float
    face_width: float
    pitch_angle: float
    low_twist: float
    low_middle: float
    high_twist: float
    high_middle: float
    tip_half_angle: float
    root_half_angle: float
    rows: int
    row_edges: Array
    flank: int
    least_square: float
    greatest_square: float
    fillet: int
    fillet_radius: Array
    tip: int
    root: int
    ring: int
    inner: float
    outer: float
    start: Array


@formula
def bin_of(value, low, high, count):
    """As `cells._bin`."""
    return min(max(int((value - low) * (count / (high - low))), 0), count - 1)


@formula
def row_of(g, z):
    """Row of a height: straight between the edges, as `CellGrid.place_of`."""
    if len(g.row_edges) == 0:
        place = z * (g.rows / g.face_width)
    else:
        at = min(max(np.searchsorted(g.row_edges, z, side="right") - 1, 0), g.rows - 1)
        place = at + (z - g.row_edges[at]) / (g.row_edges[at + 1] - g.row_edges[at])
    return min(max(int(place), 0), g.rows - 1)


@formula
def section_angle(g, x, y, z):
    """As `twist.section_angle`."""
    upper = z > 0.5 * g.face_width
    return math.atan2(y, x) - (g.high_twist * (z - g.high_middle) if upper else g.low_twist * (z - g.low_middle))


@kernel
def index(g, surface, teeth, side, roll, position, normal, deviation, cell):
    """Cell of each point into `cell`, −1 where its surface is OTHER; before it the fields of `SurfacePoints`."""
    pitch = g.pitch_angle
    for i in range(len(cell)):
        code = surface[i]
        if code == OTHER:
            cell[i] = -1
            continue
        tooth, x, y, z = np.int64(teeth[i]), position[i, 0], position[i, 1], position[i, 2] + normal[i, 2] * deviation[i]
        half, row = 0 if side[i] > 0 else 1, row_of(g, z)
        if code == FLANK:
            own = roll[i] + g.orientation * g.cos_helix * deviation[i]
            here = ((tooth * 2 + half) * g.rows + row) * g.flank + bin_of(own * own, g.least_square, g.greatest_square, g.flank)
        elif code == FILLET:
            radius = g.orientation * math.sqrt(x * x + y * y)
            column = 0  # edges run from the root to the flank
            while column < g.fillet - 1 and g.orientation * g.fillet_radius[column + 1] < radius:
                column += 1
            here = ((tooth * 2 + half) * g.rows + row) * g.fillet + column
        elif code == BORE:
            here = tooth * g.rows + row
        else:
            angle = section_angle(g, x, y, z) - tooth * pitch
            if code == TIP:
                within = (angle + 0.5 * pitch) % pitch - 0.5 * pitch
                here = (tooth * g.rows + row) * g.tip + bin_of(within, -g.tip_half_angle, g.tip_half_angle, g.tip)
            elif code == ROOT:
                within = (angle - 0.5 * pitch + 0.5 * pitch) % pitch - 0.5 * pitch
                here = (tooth * g.rows + row) * g.root + bin_of(within, -g.root_half_angle, g.root_half_angle, g.root)
            else:
                angle = (angle + math.pi) % (2.0 * math.pi) - math.pi
                ring = bin_of(math.sqrt(x * x + y * y), g.inner, g.outer, g.ring)
                here = (tooth * 2 + (1 if angle > 0.0 else 0)) * g.ring + ring
        cell[i] = g.start[code] + here


@kernel
def add(cell, roll, position, normal, deviation, number, feet, normals, lever, rolls, deviations, squares, highest):
    """Add points to the sums of their cells, in place; −1: to none.

    The squares about the mean grow by (n d − T)² / (n (n − 1)), with n and the sum T of the deviations d after the point (Youngs and Cramer
    1971): like `CellSums.add`, without a sum of large squares.
    """
    for i in range(len(cell)):
        k = cell[i]
        if k < 0:
            continue
        d, px, py, pz = deviation[i], position[i, 0], position[i, 1], position[i, 2]
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        n, total = number[k] + 1.0, deviations[k] + d
        number[k], deviations[k] = n, total
        if n > 1.0:
            off = n * d - total
            squares[k] += off * off / (n * (n - 1.0))
        rolls[k] += roll[i]
        highest[k] = max(highest[k], d)
        feet[k, 0] += px
        feet[k, 1] += py
        feet[k, 2] += pz
        normals[k, 0] += nx
        normals[k, 1] += ny
        normals[k, 2] += nz
        lever[k, 0] += py * nz - pz * ny
        lever[k, 1] += pz * nx - px * nz
        lever[k, 2] += px * ny - py * nx

"""What is done with located points, compiled: `CellGrid.index`, `CellSums.add`, and a whole pass over a streamed scan.

Imported where it is called: it needs numba, whose cache looks at this file alone. Who changes `design.kernel` saves this one too.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gearwear.compiled import formula, kernel, step
from gearwear.design.kernel import (
    BLOCK,
    BORE,
    BY,
    CODE,
    DEVIATION,
    DISTANCE,
    END_LOW,
    FILLET,
    FLANK,
    FOOT,
    IN,
    LEVER,
    NUMBER,
    NX,
    NY,
    NZ,
    OFF,
    OTHER,
    RADIUS,
    REACH,
    ROOT,
    TIP,
    R,
    X,
    Y,
    Z,
    empty_block,
    normals_of,
    place,
    read,
)  # fmt: skip
from gearwear.design.kernel_formulas import atan2

Array = Any
CELL, LIMIT, COLUMN, ROWS = range(25 * BLOCK, 29 * BLOCK, BLOCK)
"""Columns of a block: the cell of a point, that of its limits, which of the cells along a fillet, from root to flank, and row."""
COUNT, DEVIATIONS, SQUARES, HIGHEST, ROLLS, FEET, NORMALS, LEVERS, INNER, ROW = 0, 1, 2, 3, 4, 5, 8, 11, 14, 16
"""Where in its row of `ROW` numbers a cell keeps what `CellSums` does, and the number of `FarTally`: two lines of the cache."""


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


class Sieve(NamedTuple):
    """By what a pass tells strays and pits, mm, a row for each cell.

    `limits` are centre and limit of `StrayLimits`, this below 0 in a cell whose points are strays; `far` centre, reach and inner of `FarReach`,
    and the centre of `Pits`, `deepest` theirs, empty where they are not known. `highest` is up to where flanks go (times ι), `middle` and `half`
    say which lengths of roll sections are made of.
    """

    highest: float
    own_grid: bool
    limits: Array
    far: Array
    depth: float
    deepest: Array
    middle: float
    half: float


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
    return atan2(y, x) - (g.high_twist * (z - g.high_middle) if upper else g.low_twist * (z - g.low_middle))


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
                within = angle - pitch * math.floor(angle / pitch + 0.5)
                here = (tooth * g.rows + row) * g.tip + bin_of(within, -g.tip_half_angle, g.tip_half_angle, g.tip)
            elif code == ROOT:
                within = angle - pitch * math.floor(angle / pitch) - 0.5 * pitch
                here = (tooth * g.rows + row) * g.root + bin_of(within, -g.root_half_angle, g.root_half_angle, g.root)
            else:
                angle -= 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
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


@step
def columns_on_fillets(g, b, which, count):
    """Which of the cells along its fillet the foot of each of the points on fillets lies in, by its radius, into `COLUMN`."""
    for k in range(count):
        inward, beside = b[R + k] - b[DISTANCE + k] * b[IN + k], b[DISTANCE + k] * b[BY + k]
        b[FOOT + k], b[LEVER + k] = g.orientation * (inward * inward + beside * beside), 0.0
    for edge in g.fillet_radius[1 : g.fillet]:
        square = g.orientation * edge * edge
        for k in range(count):
            b[LEVER + k] += 1.0 if square < b[FOOT + k] else 0.0
    for k in range(count):
        b[COLUMN + which[k]] = b[LEVER + k]


@step
def in_rows(g, b):
    """Row of each height, as `CellGrid.place_of`; into `ROWS`."""
    if len(g.row_edges) > 0:
        for i in range(BLOCK):
            b[ROWS + i] = row_of(g, b[Z + i])
        return
    per_height, most = g.rows / g.face_width, g.rows - 1.0
    for i in range(BLOCK):
        b[ROWS + i] = np.floor(min(max(b[Z + i] * per_height, 0.0), most))


@step
def in_cells(c, g, b):
    """`index` for a block, from the points' own polar coordinates; into `CELL`.

    The own length of roll, height and angle of a point need no foot; that of the foot is the same on tip, root and ends.
    """
    rows, half_pitch = float(g.rows), 0.5 * g.pitch_angle
    per_turn, count = 1.0 / c.teeth, float(c.teeth)
    flank, tip = g.flank / (g.greatest_square - g.least_square), g.tip / (2.0 * g.tip_half_angle)
    root, ring = g.root / (2.0 * g.root_half_angle), g.ring / (g.outer - g.inner)
    most_flank, most_fillet, most_tip, most_root, most_ring = (
        g.flank - 1.0,
        g.fillet - 1.0,
        g.tip - 1.0,
        g.root - 1.0,
        g.ring - 1.0,
    )
    start_flank, start_fillet, start_root, start_tip = float(g.start[0]), float(g.start[1]), float(g.start[2]), float(g.start[3])
    start_low, start_high, start_bore = float(g.start[4]), float(g.start[5]), float(g.start[6])
    for i in range(BLOCK):
        code, off, reach = b[CODE + i], b[OFF + i], b[REACH + i]
        tooth = b[NUMBER + i] - count * np.floor((b[NUMBER + i] + 0.5) * per_turn)
        at_flank, at_fillet, at_tip, at_root, at_bore = code == FLANK, code == FILLET, code == TIP, code == ROOT, code == BORE
        sided, at_end = at_flank | at_fillet, not (at_flank | at_fillet | at_tip | at_root | at_bore)
        in_space = off - half_pitch if off > 0.0 else off + half_pitch
        place = (reach * reach - g.least_square) * flank if at_flank else b[COLUMN + i]
        place = (off + g.tip_half_angle) * tip if at_tip else ((in_space + g.root_half_angle) * root if at_root else place)
        place = (b[RADIUS + i] - g.inner) * ring if at_end else (0.0 if at_bore else place)
        most = (
            most_flank
            if at_flank
            else (most_fillet if at_fillet else (most_tip if at_tip else (most_root if at_root else most_ring)))
        )
        most = 0.0 if at_bore else most
        row = b[ROWS + i]
        first = start_flank if at_flank else (start_fillet if at_fillet else (start_tip if at_tip else start_root))
        first = (start_low if code == END_LOW else start_high) if at_end else (start_bore if at_bore else first)
        half = (1.0 if math.copysign(1.0, off) < 0.0 else 0.0) if sided else (1.0 if at_end & (off > 0.0) else 0.0)
        here = tooth * (2.0 if sided | at_end else 1.0) + half
        here = here if at_end else here * rows + row
        cell = first + here * (most + 1.0) + np.floor(min(max(place, 0.0), most))
        b[CELL + i] = -1.0 if code == OTHER else cell


@kernel
def collect(
    points,
    rotation,
    translation,
    c,
    g,
    limits,
    s,
    rows,
    far_off,
    far_cell,
    far_by,
    teeth_,
    sides_,
    rolls_,
    positions_,
    normals_,
    deviations_,
):
    """A chunk of a pass: move points, locate them, and add them to the rows of their cells; `passes.go_through`, a block at a time.

    Into `far_off` come the numbers of points far below and far above, into `far_cell` and `far_by` those far below, into the last arrays those of
    flanks that sections are made of. Gives the numbers of the points on no surface, of those far below, and of those for sections.
    """
    b, which = empty_block()
    other, far, cut = 0, 0, 0
    for start in range(0, len(points), BLOCK):
        n = min(BLOCK, len(points) - start)
        read(points[start : start + BLOCK] if n == BLOCK else filled_up(points[start:]), b)
        move(rotation, translation, b)
        in_own_cells(c, g, limits, s, b, which)
        for i in range(n):
            k, d = int(b[CELL + i]), b[DEVIATION + i]
            if k < 0:
                other += 1
                continue
            at = k if s.own_grid else int(b[LIMIT + i])
            near = abs(d - s.limits[at, 0]) <= s.limits[at, 1]
            kept = near
            roll = math.nan
            if b[CODE + i] == FLANK:
                roll = b[REACH + i] - c.orientation * c.cos_helix * d
                off, reach, inner = d - s.far[k, 0], s.far[k, 1], s.far[k, 2]
                rows[k, INNER] += inner
                if off < -reach and off > -s.depth:
                    far_cell[far], far_by[far] = k, off
                    far += 1
                    far_off[k, 0] += inner
                elif off > reach and off < s.depth:
                    far_off[k, 1] += inner
                if len(s.deepest) > 0:
                    deepest = s.deepest[(k - g.start[FLANK]) // (g.rows * g.flank)]
                    kept = near or (deepest > 0.0 and abs(d - s.far[k, 3]) <= deepest)
            if not kept:
                continue
            nx, ny, nz = b[NX + i], b[NY + i], b[NZ + i]
            px, py, pz = b[X + i] - d * nx, b[Y + i] - d * ny, b[Z + i] - d * nz
            if near and abs(b[REACH + i] - s.middle) <= s.half and b[CODE + i] == FLANK:
                tooth = b[NUMBER + i] - c.teeth * np.floor((b[NUMBER + i] + 0.5) / c.teeth)
                teeth_[cut], sides_[cut], rolls_[cut], deviations_[cut] = int(tooth), 1 if b[OFF + i] > 0.0 else -1, roll, d
                positions_[cut, 0], positions_[cut, 1], positions_[cut, 2] = px, py, pz
                normals_[cut, 0], normals_[cut, 1], normals_[cut, 2] = nx, ny, nz
                cut += 1
            add_to(rows[k], d, roll, px, py, pz, nx, ny, nz)
    return other, far, cut


@step
def in_own_cells(c, g, limits, s, b, which):
    """Locate a block of moved points, and put them in the cells of the pass and, where those are others, of its limits."""
    fillets = place(c, b, which)
    normals_of(c, b)
    below_tips(c, s, b)
    for turn in range(1 if s.own_grid else 0, 2):  # the limits' cells, and then those of the pass
        grid = limits if turn == 0 else g
        columns_on_fillets(grid, b, which, fillets)
        in_rows(grid, b)
        in_cells(c, grid, b)
        if turn == 0:
            b[LIMIT : LIMIT + BLOCK] = b[CELL : CELL + BLOCK]


@formula
def add_to(row, d, roll, px, py, pz, nx, ny, nz):
    """A point with its foot and normal to what its cell holds: as `CellSums.add`, the squares about the running mean."""
    count, total, highest = row[COUNT] + 1.0, row[DEVIATIONS] + d, row[HIGHEST]
    if count > 1.0:
        off = count * d - total
        row[SQUARES] += off * off / (count * (count - 1.0))
        highest = max(highest, d)
    else:
        highest = d
    row[COUNT], row[DEVIATIONS], row[HIGHEST] = count, total, highest
    row[ROLLS] += roll
    row[FEET] += px
    row[FEET + 1] += py
    row[FEET + 2] += pz
    row[NORMALS] += nx
    row[NORMALS + 1] += ny
    row[NORMALS + 2] += nz
    row[LEVERS] += py * nz - pz * ny
    row[LEVERS + 1] += pz * nx - px * nz
    row[LEVERS + 2] += px * ny - py * nx


@step
def filled_up(points):
    """A block of what is less: the rest of it lies on the axis."""
    block = np.zeros((BLOCK, 3))
    block[: len(points)] = points
    return block


@step
def move(rotation, translation, b):
    """A block of points, in place."""
    xx, xy, xz, x0 = rotation[0, 0], rotation[0, 1], rotation[0, 2], translation[0]
    yx, yy, yz, y0 = rotation[1, 0], rotation[1, 1], rotation[1, 2], translation[1]
    zx, zy, zz, z0 = rotation[2, 0], rotation[2, 1], rotation[2, 2], translation[2]
    for i in range(BLOCK):
        x, y, z = b[X + i], b[Y + i], b[Z + i]
        b[X + i], b[Y + i], b[Z + i] = x * xx + y * xy + z * xz + x0, x * yx + y * yy + z * yz + y0, x * zx + y * zy + z * zz + z0


@step
def below_tips(c, s, b):
    """Take points of flanks higher than tips go off them: `low_tips.below_tips`."""
    for i in range(BLOCK):
        high = c.orientation * max(b[RADIUS + i], c.base_radius) > s.highest
        b[CODE + i] = OTHER if (b[CODE + i] == FLANK) & high else b[CODE + i]

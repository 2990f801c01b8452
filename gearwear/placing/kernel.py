"""What is done with located points, compiled: `CellGrid.index`, `CellSums.add`, and a whole pass over a streamed scan.

Imported where it is called: it needs numba, whose cache looks at this file alone. Who changes `design.kernel` saves this one too.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gearwear.compiled import formula, kernel
from gearwear.design.kernel import BLOCK, BORE, FILLET, FLANK, OTHER, ROOT, TIP, atan2, fill

Array = Any


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


class Collected(NamedTuple):
    """What a pass adds to, in place: the sums of `CellSums`, and the number, below and above of `FarTally`, a row for each cell."""

    number: Array
    feet: Array
    normals: Array
    lever: Array
    rolls: Array
    deviations: Array
    squares: Array
    highest: Array
    far: Array


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


@kernel
def collect(
    points,
    rotation,
    translation,
    c,
    g,
    limits,
    s,
    into,
    far_cell,
    far_off,
    teeth_,
    sides_,
    rolls_,
    positions_,
    normals_,
    deviations_,
):
    """A chunk of a pass: move points, locate them, and add them to the sums; `passes.go_through`, point by point.

    Into `far_cell` and `far_off` come the points far below, into the last arrays those of flanks that sections are made of. Gives the numbers of
    the points on no surface, of those far below, and of those for sections.
    """
    moved, normals, positions = np.empty((BLOCK, 3)), np.empty((BLOCK, 3)), np.empty((BLOCK, 3))
    surfaces, teeth, sides = np.empty(BLOCK, np.int8), np.empty(BLOCK, np.int32), np.empty(BLOCK, np.int8)
    rolls, deviations = np.empty(BLOCK), np.empty(BLOCK)
    cells, limit_cells = np.empty(BLOCK, np.int64), np.empty(BLOCK, np.int64)
    other, far, cut = 0, 0, 0
    for first in range(0, len(points), BLOCK):
        n = min(BLOCK, len(points) - first)
        block = points[first : first + n]
        for i in range(n):
            x, y, z = block[i, 0], block[i, 1], block[i, 2]
            moved[i, 0] = x * rotation[0, 0] + y * rotation[0, 1] + z * rotation[0, 2] + translation[0]
            moved[i, 1] = x * rotation[1, 0] + y * rotation[1, 1] + z * rotation[1, 2] + translation[1]
            moved[i, 2] = x * rotation[2, 0] + y * rotation[2, 1] + z * rotation[2, 2] + translation[2]
        surface, tooth, side, roll, position = surfaces[:n], teeth[:n], sides[:n], rolls[:n], positions[:n]
        normal, deviation, cell, limit_cell = normals[:n], deviations[:n], cells[:n], limit_cells[:n]
        fill(moved[:n], c, surface, tooth, side, roll, position, normal, deviation)
        for i in range(n):
            own = roll[i] + c.orientation * c.cos_helix * deviation[i]
            high = c.orientation * math.sqrt(own * own + c.base_radius * c.base_radius) > s.highest  # `registration.below_tips`
            surface[i] = OTHER if (surface[i] == FLANK) & high else surface[i]
        index(g, surface, tooth, side, roll, position, normal, deviation, cell)
        if s.own_grid:
            limit_cell = cell
        else:
            index(limits, surface, tooth, side, roll, position, normal, deviation, limit_cell)
        for i in range(n):
            k, d = cell[i], deviation[i]
            if k < 0:
                other += surface[i] == OTHER
                continue
            at = limit_cell[i]
            near = abs(d - s.limits[at, 0]) <= s.limits[at, 1]
            kept = near
            if surface[i] == FLANK:
                off, reach, inner = d - s.far[k, 0], s.far[k, 1], s.far[k, 2]
                if off < -reach and off > -s.depth:
                    far_cell[far], far_off[far] = k, off
                    far += 1
                    into.far[k, 1] += inner
                elif off > reach and off < s.depth:
                    into.far[k, 2] += inner
                into.far[k, 0] += inner
                if len(s.deepest) > 0:
                    deepest = s.deepest[(k - g.start[FLANK]) // (g.rows * g.flank)]
                    kept = near or (deepest > 0.0 and abs(d - s.far[k, 3]) <= deepest)
                if near and abs(roll[i] + c.orientation * c.cos_helix * d - s.middle) <= s.half:
                    teeth_[cut], sides_[cut], rolls_[cut], deviations_[cut] = tooth[i], side[i], roll[i], d
                    for axis in range(3):
                        positions_[cut, axis], normals_[cut, axis] = position[i, axis], normal[i, axis]
                    cut += 1
            if not kept:
                cell[i] = -1
        add(cell, roll, position, normal, deviation, into.number, into.feet, into.normals, into.lever, into.rolls, into.deviations,
            into.squares, into.highest)  # fmt: skip
    return other, far, cut

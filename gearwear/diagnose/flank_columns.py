"""Columns for what flanks were made like and what they may have lost: profiles, and the shapes of wear."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial.legendre import legvander

from gearwear.arrays import Floats, Ints
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.columns import CellColumns, Stretch, between
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells

SMOOTH = 4
"""Degree up to which a profile may be a polynomial; beyond, it bends."""


def made_profiles(cells: Cells) -> tuple[Floats, Floats]:
    """What a profile may be made of, (m, k), and the price of each, (k,): smooth forms, and bends at the edges of the columns of cells, whose
    place is a shape value as that of a relief is; nothing off the flanks."""
    points, edges = cells.points, cells.grid.roll_edges
    flank = cells.seen & (points.surface == FLANK)

    def from_form(roll: Floats) -> Floats:
        """0 at the form circle, 1 at the tip."""
        return np.asarray((roll - edges[0]) / (edges[-1] - edges[0]), dtype=np.float64)

    way = from_form(np.where(flank, np.nan_to_num(points.roll), edges[0]))
    bends = np.maximum(way[:, None] - from_form(edges[1:-1]), 0.0)
    smooth = legvander(2.0 * way - 1.0, SMOOTH)
    price = rules().parameter_penalty * np.repeat([1.0, 1.0 + rules().shape_price], [smooth.shape[1], bends.shape[1]])
    return np.where(flank[:, None], np.hstack([smooth, bends]), 0.0), price


def any_profile(cells: Cells) -> Floats:
    """Any profile of the flanks, (m, flank + 1): straight between the edges of the columns of cells."""
    points, edges = cells.points, cells.grid.roll_edges
    flank = cells.seen & (points.surface == FLANK)
    roll = np.where(flank, np.nan_to_num(points.roll), edges[0])
    return np.where(flank[:, None], _hats(roll, edges), 0.0)


def on_each_side(cells: Cells, columns: Floats) -> Floats:
    """Columns (m, k) of the left flanks beside those of the right, (m, 2 k)."""
    return np.hstack([np.where((cells.points.side == int(side))[:, None], columns, 0.0) for side in Side])


def wear_columns(cells: Cells, context: Context, worn: frozenset[Side]) -> tuple[Floats, Ints]:
    """Losses that wear may have on the flanks of some sides, (m, k), and the side of each column, (k,).

    With the sliding, and in proportion to the way from the pitch point, below and above it by amounts of their own: as the load is shared.
    """
    return on_worn(cells, law_shapes(np.nan_to_num(cells.points.roll), context), worn)


def law_shapes(roll: Floats, context: Context) -> Floats:
    """The sliding, and the way from the pitch point below and above it, at lengths of roll (m,): (m, 3)."""
    pitch = context.pitch_roll
    return np.column_stack([np.abs(context.sliding(roll)), np.maximum(pitch - roll, 0.0), np.maximum(roll - pitch, 0.0)])


def laws_of_wear(cells: Cells, context: Context, worn: frozenset[Side]) -> list[tuple[Floats, Ints]]:
    """Losses by the laws of wear on some sides, as `wear_columns`: by sliding; and evenly, or on both sides alike, or on one as the other by sliding."""
    law, sides = wear_columns(cells, context, worn)
    even, on = on_worn(cells, np.ones((len(law), 1)), worn)
    laws = [(law, sides)]
    if len(worn) == 1:
        return [*laws, (even, on)]  # all over alike: a thinner tooth, but for where fillets stand
    left, right = (law[:, sides == int(side)] for side in Side)  # both may have lost the same
    laws.append((left + right, np.zeros(left.shape[1], np.int64)))
    # Or one has lost evenly what the other has lost by sliding: of both evenly it would be a thinner tooth.
    for side in Side:
        slides, other = sides == int(side), on != int(side)
        laws.append((np.hstack([law[:, slides], even[:, other]]), np.concatenate([sides[slides], on[other]])))
    return laws


def any_wear_columns(cells: Cells, context: Context, worn: frozenset[Side]) -> list[tuple[Floats, Ints]]:
    """Any loss that is least at the pitch point, where nothing slides, as `wear_columns`: straight between the edges of the columns of cells.

    Nothing there; the same beside an even loss; and beside one that leans across the face. And smooth: in proportion to the way from the pitch
    point and to its square, below and above it.
    """
    points, nodes = cells.points, cells.grid.roll_edges.copy()
    still = int(np.argmin(np.abs(nodes - context.pitch_roll)))
    nodes[still] = context.pitch_roll
    roll, width = np.nan_to_num(points.roll), cells.grid.gear.face_width
    more = np.delete(_hats(roll, nodes), still, axis=1)
    up = np.clip(points.position[:, 2] / width, 0.0, 1.0)
    law = law_shapes(roll, context)
    leaning = np.column_stack([up, 1.0 - up, up * law[:, 0], (1.0 - up) * law[:, 0]])
    smooth = np.hstack([law, law[:, 1:] ** 2])
    return [
        on_worn(cells, np.hstack(shapes), worn) for shapes in ([more], [more, np.ones((len(more), 1))], [more, leaning], [smooth])
    ]


def on_worn(cells: Cells, shapes: Floats, worn: frozenset[Side]) -> tuple[Floats, Ints]:
    """Losses of some shapes (m, n) on the flanks of some sides, (m, k), and the side of each column."""
    points, columns, sides = cells.points, list[Floats](), list[int]()
    for side in sorted(worn):
        own = cells.seen & (points.surface == FLANK) & (points.side == int(side))
        columns.append(np.where(own[:, None], -shapes, 0.0))
        sides += [int(side)] * shapes.shape[1]
    return np.hstack(columns), np.array(sides, dtype=np.int64)


def loss_by_tooth(cells: Cells, loss: Floats, cuts: Ints) -> CellColumns:
    """The common loss with a share of its own on every flank, (m, k), by stretches that begin at `cuts`."""
    points = cells.points
    flank = points.tooth.astype(np.int64) * 2 + (points.side > 0)
    worn = np.flatnonzero(np.bincount(flank[loss != 0.0], minlength=2 * cells.grid.gear.teeth))
    place = np.full(2 * cells.grid.gear.teeth, -1)
    place[worn] = np.arange(len(worn))
    stretches = []
    for rows in between(cuts, len(loss)):
        which, lost = np.where(loss[rows] != 0.0, place[flank[rows]], -1), loss[rows, None]
        here = np.unique(which[which >= 0])
        stretches.append(Stretch(rows, here, np.where(which[:, None] == here, lost, 0.0)))
    return CellColumns(len(loss), len(worn), tuple(stretches))


def _hats(roll: Floats, nodes: Floats) -> Floats:
    """Functions that are straight between nodes, 1 at one of them and 0 at the others, at lengths of roll (m,): (m, n)."""
    way = math.copysign(1.0, nodes[-1] - nodes[0])  # nodes run from the form circle to the tip
    return np.column_stack([np.interp(way * roll, way * nodes, row) for row in np.eye(len(nodes))])

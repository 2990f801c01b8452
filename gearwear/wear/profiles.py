"""The worn gear as tooth profiles: nodes at cell centres and at the edges, nominal wherever no wear was found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.involute import involute_at_roll
from gearwear.design.profiles import ToothProfiles
from gearwear.design.twist import Segment, normal_lean
from gearwear.placing.cells import CellGrid

LEDGE_MODULES = 0.002
"""Modules below its end in which the worn involute ends in a step: a slope over half a fillet column would be 4 % more volume."""
STEPS_PER_COLUMN = 1
"""Steps of the profile to a column of cells, for solids. For contact one is too few: from edge to edge of a column a straight step would put
3 µm on 15 where sliding wear bends near the form circle."""
STRIP_NODES = 8
"""Nodes of an undercut gear between base circle and form circle."""
MAX_END_RATIO = 3.0
"""Times the mean of the outermost column that the end of the flank may be worn."""
MAX_TURN = 0.02
"""Rad that helical teeth may turn between two heights: the chord of a tip circle of 40 mm is then 2 µm off."""
ROUNDING = 1e-9
"""Rad by which rounding may put a root outside the continued flank at the form circle."""
LEAST_ALIKE = 4
"""Worn flanks of a side from which on what they have in common says more than one of them."""
LEAST_LEVER = 0.35
"""Least |n · e_θ| of a fillet column that is moved: nearer the root a turn would not move the surface along its normal."""


def node_radii(grid: CellGrid, parts: int = STEPS_PER_COLUMN) -> Floats:
    """Radii of the profile nodes, mm, from root to tip: root, fillet, where the worn involute may end, form circle, `parts` to a flank column, tip.

    The worn involute may end at the form circle; on an undercut gear at the base circle, with `STRIP_NODES` nodes from there to the form circle.
    """
    gear = grid.gear
    below = np.concatenate([[gear.root_radius], grid.fillet_middles, _strip(gear)])
    flank = np.hypot(grid.rolls(parts)[1:-1], gear.base_radius)
    return np.concatenate([np.unique(below)[:: gear.orientation], [gear.form_radius], flank, [gear.flank_end_radius]])


def _strip(gear: Gear) -> Floats:
    """Radii, mm, from just below the end of the worn involute up to below the form circle."""
    ledge = LEDGE_MODULES * gear.transverse_module
    if not gear.undercut:
        return np.array([gear.form_radius - gear.orientation * ledge])
    lowest = max(
        gear.base_radius, gear.root_radius + ledge
    )  # a protuberance cuts flanks whose base circle lies below the root too
    inside = np.linspace(lowest, gear.form_radius, STRIP_NODES + 1)[:-1]
    return np.concatenate([[max(lowest - ledge, 0.5 * (gear.root_radius + lowest))], inside])


def node_heights(grid: CellGrid) -> Floats:
    """Heights of the profile nodes, mm: 0, row centres, face width; between them more where helical teeth turn far from one to the next. On a
    double helical gear those of both halves, and none in the groove."""
    return np.concatenate([_nodes_between(grid, _row_heights(grid, *zone)) for zone in grid.zones])


def _nodes_between(grid: CellGrid, rows: Floats) -> Floats:
    parts = np.ceil(np.abs(grid.gear.twist) * np.diff(rows) / MAX_TURN).astype(np.int64)
    if parts.max() <= 1:
        return rows
    places = np.concatenate([*(i + np.arange(n) / n for i, n in enumerate(parts)), [len(parts)]])
    return np.asarray(np.interp(places, np.arange(len(rows)), rows), dtype=np.float64)


def _row_heights(grid: CellGrid, rows: slice, segment: Segment) -> Floats:
    return np.concatenate([[segment.low], grid.row_middles[rows], [segment.high]])


@dataclass(frozen=True, slots=True)
class ProfileNodes:
    """What all profiles on one grid share: where their nodes are, and what the design is there.

    Parameters
    ----------
    grid : CellGrid
    parts : int
        Steps of the profile to a column of cells.
    radius, heights : (n_r,), (n_z,) float
        `node_radii`, from root to tip, and `node_heights`; mm.
    half_angle : (2, n_z, n_r) float
        Of the design, rad.
    fillet_turn : (fillet,) float
        Turn (rad) of the fillet's cells for a depth of 1 mm.
    beyond_cells, beyond_nodes : (fillet, STRIP_NODES), (below,) float
        Turn (rad) at the form circle from which on a worn involute that goes on below it cuts the fillet: over its cells and at the nodes below
        the form circle; infinite where it does not go on.
    """

    grid: CellGrid
    parts: int
    radius: Floats
    heights: Floats
    half_angle: Floats
    fillet_turn: Floats
    beyond_cells: Floats
    beyond_nodes: Floats

    @classmethod
    def of(cls, grid: CellGrid, parts: int = STEPS_PER_COLUMN) -> ProfileNodes:
        """The nodes of a grid."""
        radius, heights = node_radii(grid, parts), node_heights(grid)
        cells = np.linspace(grid.fillet_radius[:-1], grid.fillet_radius[1:], STRIP_NODES, axis=-1)
        below = radius[: len(radius) - len(grid.rolls(parts))]
        beyond_cells, beyond_nodes = (_beyond(grid.gear, at) for at in (cells, below))
        return cls(
            grid, parts, radius, heights, grid.gear.half_angles(radius, heights), _fillet_turn(grid), beyond_cells, beyond_nodes
        )


def worn_profiles(nodes: ProfileNodes, depth: Floats, added: Floats | None = None, crest: Floats | None = None) -> ToothProfiles:
    """Profiles of the worn gear.

    Parameters
    ----------
    nodes : ProfileNodes
        Of the grid the wear was found on.
    depth : (teeth, 2, rows, fillet + flank) float
        Missing depth along the normal, mm; 0 where there is no wear.
    added : same shape, or None
        What the gear had too much (+) or too little before it wore, mm.
    crest : (2, rows, nodes) float or None
        `crest_left`: what worn flanks have more than their cells show, mm.

    Returns
    -------
    ToothProfiles
        Half angles at `node_radii` × `node_heights`; depth is continued to the edges of the face, to form circle and tip.

    Notes
    -----
    Below the form circle the fillet has its own depth. On an undercut gear the form circle is an edge that the mate's tip passes: the worn
    involute goes on below it, at the depth it has there, until it comes out of the fillet, or to the base circle. What that takes out of a
    fillet cell is not counted twice.
    """
    grid, radius, parts = nodes.grid, nodes.radius, nodes.parts
    flank, fillet = _flank_turn(grid, depth, parts), depth[..., : grid.fillet] * nodes.fillet_turn
    if crest is not None:
        flank = flank - np.minimum(crest / grid.gear.normal_lever, np.maximum(flank, 0.0))
    below = radius[: len(nodes.beyond_nodes)]
    cut = np.zeros((*fillet.shape[:3], len(below)))
    if grid.gear.undercut:
        fillet = np.maximum(fillet - np.maximum(flank[..., :1, None] - nodes.beyond_cells, 0.0).mean(axis=-1), 0.0)
        cut = np.maximum(flank[..., :1] - nodes.beyond_nodes, 0.0)
    turn = _over_face(grid, np.concatenate([np.maximum(_on_fillet(grid, fillet, below), cut), flank], axis=-1))
    if added is not None:  # by itself: where wear ends before the face does it leaves the gear as made, and not as drawn
        raised = _on_fillet(grid, added[..., : grid.fillet] * nodes.fillet_turn, below)
        turn = turn - _over_face(grid, np.concatenate([raised, _flank_turn(grid, added, parts)], axis=-1))
    half_angle = _kept_apart(nodes.half_angle - turn)
    rising = slice(None, None, grid.gear.orientation)
    return ToothProfiles(grid.gear, radius[rising], nodes.heights, np.ascontiguousarray(half_angle[..., rising]))


def crest_left(grid: CellGrid, depth: Floats, parts: int) -> Floats:
    """How much more metal worn flanks have where they slide least than a smooth curve through the means of their columns.

    Parameters
    ----------
    grid : CellGrid
    depth : (teeth, 2, rows, fillet + flank) float
        Missing depth along the normal, mm.
    parts : int
        Steps of the profile to a column of cells.

    Returns
    -------
    (2, rows, parts · flank + 1) float
        At the nodes of the flank, mm; 0 but within a column in which the lines from both sides of it meet, and on sides few flanks of which
        are worn.

    Notes
    -----
    Sliding wear falls to the pitch point and rises from it, and ends there in a corner. A column that holds it has a mean above it, and every
    flank carries there. The profile within this column is so much of the lines from both sides, and so much of the smooth curve, as has the
    mean that was measured: of a rounded flank nearly none, of sliding wear all. From the median of all flanks, as one is too rough.
    """
    result = np.zeros((2, grid.rows, parts * grid.flank + 1))
    roll, place = grid.rolls(parts), 0.5 * (grid.roll_edges[1:] + grid.roll_edges[:-1])
    weight = np.ones(parts + 1)
    weight[[0, -1]] = 0.5  # nodes lie evenly in L², as points do
    for half in range(2):
        worn = depth[:, half, :, grid.fillet :].any(axis=(1, 2))
        if worn.sum() < LEAST_ALIKE:
            continue
        typical = np.median(depth[worn, half], axis=0)
        curve, means = _flank_turn(grid, typical, parts) * grid.gear.normal_lever, typical[:, grid.fillet :]
        for column in range(2, grid.flank - 2):
            nodes = slice(parts * column, parts * (column + 1) + 1)
            lines = [
                means[:, near, None]
                + (roll[nodes] - place[near]) * ((means[:, far] - means[:, near]) / (place[far] - place[near]))[:, None]
                for near, far in ((column - 1, column - 2), (column + 1, column + 2))
            ]
            (first, last), (first_beyond, last_beyond) = (line.mean(axis=0)[[0, -1]] for line in lines)
            if not (first > max(last, first_beyond) and last_beyond > max(last, first_beyond)):
                continue
            more = curve[:, nodes] - np.maximum(np.maximum(*lines), 0.0)
            over = np.average(curve[:, nodes], axis=1, weights=weight) - means[:, column]
            share = np.clip(over.sum() / np.average(more, axis=1, weights=weight).sum(), 0.0, 1.0)
            result[half, :, nodes] = np.maximum(share * more, 0.0)
    return result


def _over_face(grid: CellGrid, turn: Floats) -> Floats:
    """Turns of all rows at the heights of the nodes."""
    parts = [_to_ends(grid, turn[:, :, rows], _row_heights(grid, rows, part)) for rows, part in grid.zones]
    return np.concatenate(parts, axis=2)


def _to_ends(grid: CellGrid, turn: Floats, rows: Floats) -> Floats:
    """Turns of the rows of a helix at its nodes: continued to both its ends, straight between the rows where nodes lie there.

    `rows` are the heights (mm) of its lower end, its rows and its upper end.
    """
    if turn.shape[2] > 1:
        low = _continued(turn[:, :, 0], turn[:, :, 1])
        high = _continued(turn[:, :, -1], turn[:, :, -2])
    else:
        low = high = turn[:, :, 0]
    turn = np.concatenate([low[:, :, None], turn, high[:, :, None]], axis=2)
    heights = _nodes_between(grid, rows)
    if len(heights) > len(rows):
        upper = np.clip(np.searchsorted(rows, heights), 1, len(rows) - 1)
        share = ((heights - rows[upper - 1]) / (rows[upper] - rows[upper - 1]))[:, None]
        turn = (1.0 - share) * turn[:, :, upper - 1] + share * turn[:, :, upper]
    return turn


def _flank_turn(grid: CellGrid, depth: Floats, parts: int) -> Floats:
    """Turn (rad) at the nodes from form circle to tip: shape-preserving cubics in L through the columns, parabolas to the ends.

    Points lie evenly in L²; the mean over a column of sliding wear, a straight line over 1 / L, is its value midway between the column's edges.
    """
    some = depth[..., grid.fillet :].any(axis=-1)
    turn = (
        depth[some][:, grid.fillet :] / grid.gear.normal_lever
    )  # what is worn nowhere turns nowhere: half of all rows, as a rule
    roll, edges = grid.rolls(parts), grid.roll_edges
    centres = 0.5 * (edges[1:] + edges[:-1])
    low = _parabola(turn[..., :3], centres[:3], float(roll[0]))
    high = _parabola(turn[..., :-4:-1], centres[:-4:-1], float(roll[-1]))
    values = np.concatenate([low[..., None], turn, high[..., None]], axis=-1)
    place = np.concatenate([roll[:1], centres, roll[-1:]])
    way = grid.gear.orientation
    turned = np.zeros((*some.shape, len(roll)))
    if some.any():
        turned[some] = PchipInterpolator(way * place, values, axis=-1)(way * roll)
    return turned


def _fillet_turn(grid: CellGrid) -> Floats:
    """Turn (rad) of the fillet's cells, 1 / (r |n · e_θ| cos γ) of their depth on the trochoid, n in the section and γ its lean in space."""
    gear, centres = grid.gear, grid.fillet_middles
    phi = gear.fillet_phi(centres)
    lever = np.abs(gear.root_curve.lever(phi)) / centres
    leaning = normal_lean(gear, gear.root_curve.lever(phi))[0]
    return np.where(lever > LEAST_LEVER, 1.0 / (centres * np.maximum(lever, LEAST_LEVER) * leaning), 0.0)


def _on_fillet(grid: CellGrid, turn: Floats, radius: Floats) -> Floats:
    """The fillet cells' turn at radii below the form circle: straight between their centres, as the last one above it, none at the root."""
    way = grid.gear.orientation
    place = np.interp(way * radius, way * grid.fillet_middles, np.arange(grid.fillet))
    low = np.minimum(place.astype(np.int64), grid.fillet - 2)
    result = turn[..., low] + (place - low) * (turn[..., low + 1] - turn[..., low])
    result[..., 0] = 0.0
    return np.asarray(result, dtype=np.float64)


def _beyond(gear: Gear, radius: Floats) -> Floats:
    """Turn (rad) at the form circle from which on the worn involute, where it goes on below it, cuts the fillet at radii (mm) from the base circle
    to the form circle; infinite elsewhere."""
    gap = gear.base_half_angle - involute_at_roll(gear.roll_length(radius), gear.base_radius) - gear.half_angle(radius)
    reached = (radius >= gear.base_radius) & (radius <= gear.form_radius) & (gap > -ROUNDING)
    return np.where(reached, gap, np.inf)


def _parabola(values: Floats, place: Floats, at: float) -> Floats:
    """Continuation `at` an end from the nearest three columns; never past zero, at most `MAX_END_RATIO` times the nearest, 0 where that is 0."""
    (y0, y1, y2), (x0, x1, x2) = np.moveaxis(values, -1, 0), place
    first, second = (y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)
    value = y0 + first * (at - x0) + (second - first) / (x2 - x0) * (at - x0) * (at - x1)
    return np.where(y0 > 0.0, np.clip(value, 0.0, MAX_END_RATIO * y0), np.where(y0 < 0.0, y0, 0.0))


def without_added_metal(depth: Floats, area: Floats) -> Floats:
    """The nearest depth that adds no metal and removes as much as the measured one, tooth side by tooth side.

    Parameters
    ----------
    depth : (teeth, 2, rows, columns) float
        Measured depth with its noise, mm; 0 where there is no wear.
    area : (columns,) float
        Area of a cell, mm².

    Returns
    -------
    (teeth, 2, rows, columns) float
        Not negative.

    Notes
    -----
    Cutting negative depths off would keep the noise that deepens and drop the noise that fills: 5 % of the volume where whole flanks are
    worn little. The nearest field, in least squares weighted by area, of the same integral and without negative values is
    ``max(depth − t, 0)`` with one threshold t for the side.
    """
    result = np.zeros_like(depth)
    weight = np.broadcast_to(area, depth.shape[2:]).ravel()
    for side in np.ndindex(*depth.shape[:2]):
        flank = depth[side].ravel()
        volume = float(flank @ weight)
        if volume <= 0.0:
            continue
        order = np.argsort(flank)[::-1]
        # With the k deepest cells kept, t = (Σ a d − V) / Σ a; the right k is the last whose shallowest cell is above it.
        threshold = (np.cumsum((flank * weight)[order]) - volume) / np.cumsum(weight[order])
        kept = int(np.flatnonzero(flank[order] > threshold)[-1])
        result[side] = np.maximum(depth[side] - threshold[kept], 0.0)
    return result


def _continued(near: Floats, next_: Floats) -> Floats:
    """On from two rows to the end half a row off, straight; never past zero, and flat where the nearest shows no wear."""
    value = near + 0.5 * (near - next_)
    return np.where(near > 0.0, np.clip(value, 0.0, 2.0 * near), np.where(near < 0.0, near, 0.0))


def _kept_apart(half_angle: Floats) -> Floats:
    """Both sides of a tooth with at least a micrometre-like land left between them, where wear from both sides meets."""
    least = 1e-5
    gap = half_angle.sum(axis=1) - least
    short = np.minimum(gap, 0.0)[:, None]
    return np.asarray(half_angle - 0.5 * short, dtype=np.float64)

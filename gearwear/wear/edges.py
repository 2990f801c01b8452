"""The edges of flanks: what is missing there alone is rounding, deburring or a nick, and no wear of the flank.

Where flanks end is seen from all of them together: ends may be rounded, or cut askew, and a scan may stop short of them. What ISO 1328-1 leaves
out of the helix evaluation at each end is the strip; the cells that it reaches into and one more belong to it, as wear is looked for on means over three.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.twist import segments
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.edges import least_drop, rounded_ends, typical_fall
from gearwear.placing.side_maps import SideMaps

STRIP_SHARE = 0.05
"""Of the face width, at each end, but not more than a module: left out of the helix evaluation (ISO 1328-1)."""
MOST = 0.25
"""Share of the face, from each end, that edges are at most, where cells are large; but a row of cells."""
COMMON = 0.5
"""Share of a side's flanks that must have been seen at a place for the flank to go on there."""

COLUMNS, CHANCE = 5, 3.0
"""Columns side by side over which flanks seen at a height are counted; standard deviations of such a count that are chance."""
LINES = 8
"""Places side by side of which one has no more lines of a scan than their mean has, less an eighth of a line."""
FEW = 0.01
"""Share of the points of the place with most that may be strays."""
UNSEEN = 0.1
"""Share of a flank, in that of the flank seen best, below which it was not seen. Twice that of a tooth (`breakage`): where points are few, cells are
merged, and a stray one of them counts for several."""


def end_strip(gear: Gear) -> float:
    """Width of the strip at each end of the face that is no part of a flank's evaluation, mm."""
    return min(STRIP_SHARE * gear.face_width, gear.transverse_module)


def within_ends(cells: Cells, noise: float, loop: Loop | None) -> Cells:
    """The cells without those on ends that are rounded off: not seen, as there is no flank.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        What it left unexplained was taken for as made: rounded ends too.
    """
    patterns = np.sum([pattern.field for pattern in loop.patterns], axis=0) if loop is not None and loop.patterns else 0.0
    rounded = rounded_ends(cells.with_deviation(cells.points.deviation + patterns), noise)
    return cells.without(rounded) if rounded.any() else cells


def end_zone(maps: SideMaps, cells: Cells) -> Bools:
    """Cells next to where the flanks end along z, (2, rows, columns); none on a planar section. `maps` are those of `cells`."""
    grid, seen = cells.grid, maps.seen
    sides = seen.any(axis=(2, 3)).sum(axis=0)[:, None, None]
    common: Bools = np.asarray(seen.sum(axis=0) >= np.maximum(COMMON * sides, 1.0), dtype=np.bool_)
    rows = common.shape[1]
    if rows == 1:
        return np.zeros_like(common)
    height = grid.row_height
    strip = math.ceil(end_strip(grid.gear) / height * (1.0 - 1e-9)) + 1
    strip = min(strip, max(int(MOST * rows / len(segments(grid.gear))), 1))
    reach = strip * height
    # By a point: that it takes more than one to count as seen makes what thins out fall off twice.
    touched = (grid.sides(cells.count) > 0.0).sum(axis=0)
    common = _thinning_out(common, touched, strip)
    if grid.groove_rows:
        return _zones_of_halves(grid, common, reach)
    middle = (np.arange(rows) + 0.5)[:, None] * height
    there: Bools = np.any(common, axis=1, keepdims=True)
    low = common.argmax(axis=1)[:, None, :] * height
    high = (rows - common[:, ::-1].argmax(axis=1))[:, None, :] * height
    return np.asarray(there & ((middle < low + reach) | (middle > high - reach)))


def _thinning_out(common: Bools, number: Ints, strip: int) -> Bools:
    """Where the flanks go on although few of them were seen there: an end is where what was seen falls off at once, to less than `COMMON` of what it is
    a strip of rows further in, and by more than chance; a scan that thins out along the face falls off slowly.

    Parameters
    ----------
    common : (2, rows, columns) bool
        Where enough flanks were seen.
    number : (2, rows, columns) int
        Flanks with a point there.
    strip : int
        Rows.
    """
    near = COLUMNS * ndimage.uniform_filter1d(number.astype(np.float64), COLUMNS, axis=2, mode="constant")
    likely = near + CHANCE * np.sqrt(near + 1.0)
    result = common.copy()
    for ahead, more, most in ((result, near, likely), (result[:, ::-1], near[:, ::-1], likely[:, ::-1])):
        for row in range(strip, ahead.shape[1]):
            ahead[:, row] |= ahead[:, row - 1] & (most[:, row] >= COMMON * more[:, row - strip])
    return result


def seen_places(count: Floats, fillet: int) -> Bools:
    """Places of the sides, (2, rows, columns), that the scan went over: those beyond which it saw nothing on any flank, or so little that they were seen
    in part only, are not among them, and nothing says how deep wear goes there.

    Parameters
    ----------
    count : (teeth, 2, rows, columns) float
        Points.
    fillet : int
        Columns of the fillet: with the first of the flank they are in or out.
    """
    flank = count[..., fillet:].sum(axis=0)
    rows = np.stack([_reached(side.sum(axis=1)) for side in flank])
    columns = np.stack([_reached(side.sum(axis=0)) for side in flank])
    columns = np.hstack([np.repeat(columns[:, :1], fillet, axis=1), columns])
    return np.asarray(rows[:, :, None] & columns[:, None, :])


def seen_sides(maps: SideMaps) -> Bools:
    """Flanks of which more than hardly any cells were seen, (teeth, 2): of the others nothing is said, also where their side is worn throughout."""
    seen = maps.seen[..., maps.fillet :].mean(axis=(2, 3))
    return np.asarray((seen > 0.0) & (seen >= UNSEEN * seen.max()))


def _reached(points: Floats) -> Bools:
    """(n,) which of a row of places with so many points lie between its ends: the outermost that do not have `COMMON` of the points of the least of the next
    `LINES`. A scan made of lines has one more of them in one place than in the next, and as many as the others in an outermost that is whole."""
    inside = np.ones(len(points), dtype=bool)
    for ahead, many in ((inside, points), (inside[::-1], points[::-1])):
        for at in range(len(many) - 1):
            if many[at] > FEW * many.max() and many[at] >= COMMON * many[at + 1 : at + 1 + LINES].min():
                break
            ahead[at] = False
    return inside


def _zones_of_halves(grid: CellGrid, common: Bools, reach: float) -> Bools:
    """As `end_zone`, at both ends of each half of a double helical gear."""
    edges = grid.z_edges
    zone: Bools = np.zeros_like(common)
    middle = grid.row_middles[:, None]
    for half in segments(grid.gear):
        in_half: Bools = np.asarray(common & ((middle > half.low) & (middle < half.high)), dtype=np.bool_)
        low = edges[np.argmax(in_half, axis=1)][:, None, :]
        high = edges[len(middle) - np.argmax(in_half[:, ::-1], axis=1)][:, None, :]
        zone |= (
            np.any(in_half, axis=1, keepdims=True)
            & (middle > half.low)
            & (middle < half.high)
            & ((middle < low + reach) | (middle > high - reach))
        )
    return zone


def at_ends_only(mask: Bools, zone: Bools) -> Bools:
    """Sides whose marked cells all lie in the zone, (teeth, 2)."""
    return np.asarray(mask.any(axis=(2, 3)) & ~(mask & ~zone).any(axis=(2, 3)))


def shared_edges(maps: SideMaps, zone: Bools, module: float, noise: float) -> Bools:
    """Cells at the ends where typical flanks of both sides lack metal alike, (2, rows, columns): no wear of the one that is worn, but how edges were
    made, also where they fall off too far to be an edge all over (`rounded_ends`).

    Parameters
    ----------
    maps : SideMaps
        One side of which is worn.
    zone : (2, rows, columns) bool
        From `end_zone`.
    module, noise : float
        Of the gear and of a point, mm.
    """
    low = zone & (typical_fall(maps.deviation) < -least_drop(module, noise))
    return np.asarray(low & low[::-1])

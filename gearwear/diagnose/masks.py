"""Which cells a fit may use, and how they are left out in turn."""

from __future__ import annotations

import warnings

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.design.surface import END_HIGH, END_LOW, FILLET, FLANK, TIP
from gearwear.design.twist import section_angle
from gearwear.diagnose.active_face import ActiveFace
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells, usual_count
from gearwear.placing.edges import rounded_ends
from gearwear.placing.low_tips import OFF
from gearwear.placing.side_maps import between, make_side_maps, rim, window_mean, worn_cells
from gearwear.robust import median_scale, tukey_weight

UPPER = 0.9
"""Quantile for the highest of many; numerical."""


def sound_cells(cells: Cells, worn: frozenset[Side], fillets_told: bool = True, faces: tuple[ActiveFace, ...] = ()) -> Bools:
    """Cells fit for a fit: enough points, away from the form circle's edge, not on a side worn throughout, nor where its mate ran; not on fillets that nobody knows.

    What levels for their columns leave of fillets that are far from the design's bends as a coat over teeth that are too thin.
    """
    gear, p = cells.grid.gear, cells.points
    seen = cells.seen
    usual = usual_count(cells)
    enough = cells.count >= np.where(usual < 2.0, 1.0, np.maximum(rules().fewest_points, rules().least_count * usual))
    edge = rules().edge * gear.transverse_module
    roll = np.nan_to_num(p.roll)
    away = (p.surface != FLANK) | (gear.orientation * roll > gear.orientation * gear.form_roll + edge)
    # Wear of a whole side runs out in the cells of the fillet next to it.
    worn_out = np.isin(p.side, [int(side) for side in worn])
    for face in faces:
        worn_out |= face.worn(p, cells.grid.row_height)
    worn_out &= (p.surface == FLANK) | above_last_fillet_edge(cells)
    known = (p.surface != FILLET) | fillets_told
    corners = _off_corners(cells, worn | {face.side for face in faces})
    return np.asarray(seen & enough & away & known & corners & _off_ends(cells) & ~worn_out & ~_pitted(cells))


def above_last_fillet_edge(cells: Cells) -> Bools:
    """Cells from the fillet's last column on, (m,): the one next to the flank."""
    radius = np.hypot(*cells.points.position[:, :2].T)
    return np.asarray(cells.grid.gear.orientation * (radius - cells.grid.fillet_radius[-2]) > 0.0)


def _pitted(cells: Cells) -> Bools:
    """Cells between the pits or grooves of a flank, and a rim of one cell: too shallow ones among them would pull the pose."""
    if cells.far is None:
        return np.zeros(len(cells.count), dtype=bool)
    return cells.grid.on_cells(rim(between(cells.grid.sides(cells.far.hung), cells.grid.fillet)))


def _off_corners(cells: Cells, worn: frozenset[Side]) -> Bools:
    """False on the tip land's columns next to a flank: points of a flank that lies low, worn or thinner, are nearer to the land there.

    Where the land has few columns, only next to a worn side.
    """
    p, gear, columns = cells.points, cells.grid.gear, cells.grid.tip
    if columns < rules().fewest_tip_columns and not worn:
        return np.ones(len(p), dtype=bool)
    within = np.remainder(section_angle(gear, *p.position.T) + 0.5 * gear.pitch_angle, gear.pitch_angle) - 0.5 * gear.pitch_angle
    if columns >= rules().fewest_tip_columns or len(worn) > 1:
        low = np.abs(within)
    else:
        low = sum(worn) * within
    return np.asarray((p.surface != TIP) | ~(low > (1.0 - 2.0 / columns) * gear.tip_half_angle))


def _off_ends(cells: Cells) -> Bools:
    """False on the rows of teeth next to an end that lies inside the drawn one: points of that end are nearer to a flank there."""
    p, width = cells.points, cells.grid.gear.face_width
    off = np.ones(len(p), dtype=bool)
    for code, from_end in ((END_LOW, p.position[:, 2]), (END_HIGH, width - p.position[:, 2])):
        end = cells.seen & (p.surface == code)
        scatter = cells.scatter[end]
        scatter = scatter[np.isfinite(scatter)]  # a single point has none
        if len(scatter) and float(np.median(p.deviation[end])) < -OFF * float(np.median(scatter)):
            off &= (p.surface > TIP) | ~(from_end < cells.grid.row_height)
    return off


def worn_mask(cells: Cells, residual: Floats, noise: float, caution: float) -> Bools:
    """Cells that look worn against the current model, with a rim of one cell, (m,); `caution` multiplies the limit.

    Where typical flanks of both sides are low alike, the gear was made so: a strong relief is not masked before it can be named.
    """
    sheets = make_side_maps(cells.with_deviation(residual - _low_alike(cells, residual)))
    local, number = window_mean(sheets)
    return cells.grid.on_cells(rim(worn_cells(local, number, noise, caution)[0]))


def whole_flanks(cells: Cells, plain: Floats, worn: Bools, sound: Bools) -> Bools:
    """The flanks of which more than a share of the sound cells look worn, (m,): what else of them a freedom of their tooth would follow.

    Only where the flank, as it was before any effect was taken out (`plain`, mm), lies far lower than the others of its side lie high: a wave
    round the gear, and pitch, go up as far as down.
    """
    grid = cells.grid

    def of_each(values: Floats | Bools) -> Floats:
        return np.asarray(grid.flank_shape(values.astype(np.float64)).sum(axis=(2, 3)))

    height = of_each(np.where(cells.seen, plain, 0.0)) / np.maximum(of_each(cells.seen), 1.0)
    height -= np.median(height, axis=0)
    far = -height > rules().errors * np.quantile(height, UPPER, axis=0)
    whole = far & (of_each(worn) > rules().whole * np.maximum(of_each(sound), 1.0))
    return grid.on_flanks(whole)


def _low_alike(cells: Cells, residual: Floats) -> Floats:
    """By how much the typical left and the typical right side both lie low at the same place of the tooth, (m,) mm, not above 0; the only one that was seen."""
    sides = cells.grid.sides(np.where(cells.seen, residual, np.nan))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # places nobody saw
        typical = np.nanmedian(sides, axis=0)
    only = np.isfinite(typical).any(axis=(1, 2))
    if only.sum() == 1:  # without the other side a turn moves all of one: how low it stands tells nothing
        typical = np.broadcast_to(typical[only], typical.shape)
    low = np.minimum(np.nan_to_num(typical.max(axis=0)), 0.0)
    return cells.grid.on_cells(np.broadcast_to(low, sides.shape))


def not_stray(residual: Floats, sound: Bools) -> Bools:
    """Cells within reach of the rest: what single torn cells (edges, chips) do not belong to."""
    centre, scale = median_scale(residual[sound])
    return np.asarray(tukey_weight(residual - centre, max(rules().stray_scale * scale, 1e-9)) > 0.0)


def folds(cells: Cells) -> tuple[Ints, Ints]:
    """Fold of every cell: by teeth (each by itself where they are few, else in groups, which are the same from whichever tooth is the first; of very few
    that were seen pieces along z or the profile), and by staggered blocks that way."""
    teeth = cells.grid.gear.teeth
    wanted = rules().folds_of_teeth
    groups = [number for number in range(min(wanted // 2 or 1, teeth), teeth + 1) if teeth % number == 0]
    by_tooth = cells.points.tooth % min(groups, key=lambda number: (abs(number - wanted), -number))
    seen = np.unique(by_tooth[cells.seen & (cells.points.surface <= TIP)])
    if 0 < len(seen) < wanted // 2:
        # Of three or four teeth nothing could be said: Student's t asks for more than any effect shows.
        pieces = -(-wanted // len(seen))
        by_tooth = np.searchsorted(seen, np.clip(by_tooth, seen[0], seen[-1])) * pieces + _stretch(cells, pieces)
    # Staggered from tooth to tooth: every tooth, and every block of some tooth, is always in what is fitted.
    block = _stretch(cells, rules().blocks)
    return by_tooth.astype(np.int64), (block + cells.points.tooth) % rules().blocks


def _stretch(cells: Cells, number: int) -> Ints:
    """Which of so many equal stretches of the face a cell lies in; a planar section has no height: of the profile."""
    position, gear = np.nan_to_num(cells.points.position), cells.grid.gear
    if cells.grid.rows > 1:
        share = position[:, 2] / gear.face_width
    else:
        share = (np.hypot(position[:, 0], position[:, 1]) - gear.root_radius) / (gear.tip_radius - gear.root_radius)
    return np.clip((share * number).astype(np.int64), 0, number - 1)


def tell_of_wear(cells: Cells, context: Context, noise: float) -> Bools:
    """Cells that tell whether a side is worn throughout, (m,). Where on the columns next to the form circle contact begins, and wear with it, no drawing of one gear tells."""
    points, way, edge = cells.points, cells.grid.gear.orientation, cells.grid.roll_edges[1]
    first = (points.surface == FLANK) & (way * np.nan_to_num(points.roll) < way * edge)
    first |= (points.surface == FILLET) & above_last_fillet_edge(cells)
    believed: Bools = sound_cells(cells, frozenset(), context.fillets_told) & ~first & ~rounded_ends(cells, noise)
    return believed

"""What a worn flank lies low or high as a whole because its tooth was made thinner or thicker: no wear of it.

Where every tooth has an index of its own (pitch errors), that follows the flank of which less is masked as worn, and the error of thickness of the tooth
stands on the worn flank alone: twice what it is on the flanks of sound teeth. A low flank then looks worn as a whole, a high one less worn than it is.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtri, stdtrit

from gearwear.arrays import Bools, Floats
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.diagnose.effects.each_tooth import EachTooth
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import SideMaps, make_side_maps, window_mean, worn_cells
from gearwear.robust import NORMAL_MAD

HIGHEST = 0.25
"""Share of a flank, its highest places, whose lower end is its level: of wear in one place that knows little until it takes most of the flank."""
FEWEST_TEETH = 6
"""Teeth without wear from which on their thickness scatters."""
SEEN = 0.5
"""Share of the teeth on which a place, and of a strip, that must be seen for anything to be said of all."""
CHANCE = 0.05
"""Chance, of both signs together, that any strip of a side that stands nowhere proud is taken to."""
WITHIN = 0.997
"""Share of teeth made like the sound ones whose thickness is taken for made."""


def at_own_level(cells: Cells, noise: float, loop: Loop | None, worn: frozenset[Side] = frozenset()) -> tuple[Cells, float]:
    """The cells with every flank on which wear stands out at the level of the sound flanks of its side, where its tooth is as thick as teeth are made.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        Where the as-made gear comes from; without an index for each tooth in it nothing is done.
    worn : frozenset of Side
        Sides worn throughout: left as they are.

    Returns
    -------
    Cells
    float
        What low flanks that were raised would have lost were that wear, mm³ (mm² for a planar section).

    Notes
    -----
    The levels of both flanks of a tooth add up to its thickness, whatever its index. A further tooth of n whose thickness has the standard deviation s
    lies within ``t(n − 1) s √(1 + 1/n)`` of their mean (Student), up as well as down; within that the level of a flank tells nothing of wear.
    """
    if loop is None or not any(isinstance(effect.candidate.effect, EachTooth) for effect in loop.effects):
        return cells, 0.0
    sheets = make_side_maps(cells)
    local, number = window_mean(sheets)
    heights = local[..., sheets.fillet :].reshape(*local.shape[:2], -1)
    seen = np.asarray(np.isfinite(heights).any(axis=2))
    known = np.where(seen[..., None], heights, 0.0)
    standing_out = np.asarray(worn_cells(local, number, noise)[0].any(axis=(2, 3)))
    sound = np.asarray(~standing_out[:, 0] & ~standing_out[:, 1] & seen[:, 0] & seen[:, 1])
    level = _levels(known, sound, np.zeros(standing_out.shape))
    level = np.where(standing_out & seen & _made(level, sound)[:, None], level, 0.0)
    level[:, [side.index for side in worn]] = 0.0
    if not level.any():
        return cells, 0.0
    # What is worn lies below: of the rest of the flank the highest places are a greater share.
    lower = worn_cells(local - level[..., None, None], number, noise)[0][:, :, cells.grid.toothed, sheets.fillet :].mean(
        axis=(2, 3)
    )
    level = np.where(level != 0.0, _levels(known, sound, lower), 0.0)
    taken = np.broadcast_to(level[..., None, None], sheets.count.shape)
    area = int(cells.grid.toothed.sum()) * sheets.flank_row
    lost = float(np.maximum(-level, 0.0).sum()) * area
    return cells.with_deviation(cells.points.deviation - cells.grid.on_cells(taken)), lost


def _levels(heights: Floats, sound: Bools, lower: Floats) -> Floats:
    """Level of each flank against the sound teeth, (teeth, 2) mm, from the heights of its places, (teeth, 2, places), of which the share `lower`,
    (teeth, 2), is worn: the same places of as many on sound flanks."""
    level = np.nanquantile(heights, 1.0 - HIGHEST, axis=2)
    if not sound.any():
        return np.asarray(level)
    for tooth, half in np.ndindex(level.shape):
        share = min(HIGHEST / max(1.0 - float(lower[tooth, half]), HIGHEST), 1.0)
        level[tooth, half] -= np.nanquantile(heights[sound, half], 1.0 - share, axis=1).mean()
    return np.asarray(level)


def _made(level: Floats, sound: Bools) -> Bools:
    """Teeth, (teeth,), of which the levels, (teeth, 2), say no other thickness than those of sound teeth scatter; none where these are few."""
    many, thickness = int(sound.sum()), level.sum(axis=1)
    if many < FEWEST_TEETH:
        return np.zeros_like(sound)
    reach = float(stdtrit(many - 1, 0.5 + 0.5 * WITHIN)) * float(thickness[sound].std(ddof=1)) * math.sqrt(1.0 + 1.0 / many)
    return np.asarray(np.abs(thickness) < reach)


def standing_proud(sheets: SideMaps, loop: Loop | None, worn: frozenset[Side]) -> tuple[float, float]:
    """How far left and right flanks that are worn throughout stand above the gear as made where they are highest, mm; 0 where that is chance.

    Metal does not come back: there the teeth were cut thicker than the loop could see, for a side that is worn is no datum. Highest is a strip, over
    the face or up the profile, in its mean: a single place may be the top of a form. It is rather less than more, for a strip may be worn too. A root
    that both sides share is on the other side at the same place, and off it; where both are worn there is none to compare with. Nor is anything asked
    of a side that a scan of the gear unworn shows (`Loop.made`).
    """
    level = [0.0, 0.0]
    if loop is None or loop.made is None or len(worn) != 1:
        return 0.0, 0.0
    (side,) = worn
    if any(face.side is side for face in loop.context.faces):  # where no mate ran it shows how high it was made
        return 0.0, 0.0
    above = above_made(sheets, side)
    flank = np.where(sheets.seen, sheets.deviation, np.nan)[:, side.index, :, sheets.fillet :]
    means, stds = zip(*(_strips(above, flank, axis) for axis in (0, 1)), strict=True)
    mean, std = np.concatenate(means), np.concatenate(stds)
    # All are as far off as the level is; by their own points the highest of many is high by chance.
    sure = float(ndtri(1.0 - 0.5 * CHANCE / max(len(mean), 1)))
    chance = np.hypot(NORMAL_95 * loop.as_made_std[side.index], sure * std)
    level[side.index] = float(mean[mean > chance].max(initial=0.0))
    return level[0], level[1]


def _strips(above: Floats, flank: Floats, axis: int) -> tuple[Floats, Floats]:
    """Means of the strips over an axis that were seen, of heights `above` (rows, columns), mm, and their standard deviations, by what the flanks
    (teeth, rows, columns) of the side scatter there: of a median of that many."""
    mean, often = strip_means(above, axis)
    own, _ = strip_means(flank, axis + 1)
    std = typical_std(np.where(np.isfinite(flank).any(axis=axis + 1), own, np.nan))
    return mean[often], std[often]


def above_made(sheets: SideMaps, side: Side) -> Floats:
    """How far the flanks of a side stand above the gear as made, and above the other side where that stands above it by more than chance, in the median
    of the teeth, (rows, columns) mm; nan where most were not seen."""
    flank = np.where(sheets.seen, sheets.deviation, np.nan)[..., sheets.fillet :]
    own, other = (flank[:, one.index] for one in (side, side.opposite))
    level = typical_heights(other)
    return np.asarray(typical_heights(own) - np.where(level > NORMAL_95 * typical_std(other), level, 0.0))


def highest_strip(above: Floats) -> float:
    """Mean of the highest strip over the face, or up the profile, of heights (rows, columns), mm; not below 0."""
    means = (strip_means(above, axis) for axis in (0, 1))
    return max(float(strips[often].max(initial=0.0)) for strips, often in means)


def strip_means(above: Floats, axis: int) -> tuple[Floats, Bools]:
    """Means of heights (rows, columns), or of those of each tooth, over one axis, mm, and of which strips enough was seen."""
    known = np.isfinite(above)
    strips = np.where(known, above, 0.0).sum(axis=axis) / np.maximum(known.sum(axis=axis), 1)
    return np.asarray(strips), np.asarray(known.mean(axis=axis) >= SEEN)


def typical_heights(heights: Floats) -> Floats:
    """The median of the teeth, (rows, columns), of heights (teeth, rows, columns); nan where most were not seen."""
    known = np.isfinite(heights)
    median = np.nanmedian(np.where(known.any(axis=0), heights, 0.0), axis=0)
    return np.where(known.mean(axis=0) >= SEEN, median, np.nan)


def typical_std(heights: Floats) -> Floats:
    """Standard deviation of the median of the teeth, of heights (teeth, …): by half of the teeth, for one that is far off says nothing of it; 0 where none was seen."""
    known = np.isfinite(heights)
    inside = np.where(known.any(axis=0), heights, 0.0)
    off = np.nanmedian(np.abs(inside - np.nanmedian(inside, axis=0)), axis=0)
    return np.asarray(NORMAL_MAD * off * np.sqrt(0.5 * math.pi / np.maximum(known.sum(axis=0), 1)))

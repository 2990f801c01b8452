"""A ridge at the pitch line of a worn side: metal that plastic flow moved there, and no thicker tooth.

Both are highest where nothing slides. A thicker tooth goes over from there into what the flank has lost farther off; a ridge is a hump of a fraction of a
module that stands above what the flank on both sides of it goes on to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from gearwear.arrays import Bools, Floats
from gearwear.design.quantity import NORMAL_95
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import CellGrid
from gearwear.placing.side_maps import SideMaps
from gearwear.wear.own_level import above_made, highest_strip, strip_means

WIDTHS = (0.1, 0.2, 0.4)
"""Standard deviations along the roll that a ridge may have, in modules: those of the effect `plastic_flow`."""
NARROWEST = 0.2
"""The same at least, in columns of cells at the pitch point: how high a narrower ridge is its mean over a column does not tell from how narrow."""
POWERS = (0.5, 0.75, 1.0)
"""Powers of the sliding that a loss may go with: below 1 it has a tip at the pitch point that is no ridge."""
NUMBERS = 5
"""What a profile with a ridge is told by: level, loss below and above the pitch point, height and width. Of no more columns nothing is told."""
PARTS = 16
"""Parts of a column over which shapes are averaged."""
FOOT = 0.135
"""Share of its height down to which a ridge reaches: two of its standard deviations."""
SURE = 0.5 + 0.5 * 0.95
"""Student's t from which on there is a ridge, and within which the level beside it lies, is that of this chance."""


@dataclass(frozen=True, slots=True)
class PitchRidge:
    """Metal that stands at the pitch line of a side.

    Parameters
    ----------
    side : Side
    height, std : float
        Above what the flank goes on to, mm.
    """

    side: Side
    height: float
    std: float


@dataclass(frozen=True, slots=True)
class WornLevel:
    """How high the flanks of a worn side stood as they were made.

    Parameters
    ----------
    height : float
        mm; wear is counted from there.
    low, high : float
        Within what that lies (95 %), mm: down to that beside the ridge they may have, up to where the profile goes on to at the pitch point.
    ridge : PitchRidge or None
    proud : (flank columns,) float
        How far the ridge stands above `height`, mm; 0 without one.
    """

    height: float
    low: float
    high: float
    ridge: PitchRidge | None
    proud: Floats


def worn_level(sheets: SideMaps, grid: CellGrid, loop: Loop, side: Side, highest: float) -> WornLevel:
    """Whether a worn side stands proud by thicker teeth, or by a ridge at the pitch line.

    Parameters
    ----------
    sheets : SideMaps
        Deviations from the as-made gear.
    grid : CellGrid
    loop : Loop
        Where the as-made gear comes from.
    side : Side
    highest : float
        How far the side stands proud where it is highest, mm (`standing_proud`).

    Returns
    -------
    WornLevel
        With `highest` where no ridge is told. What its level may be is then open below, down to that beside the ridge there may be.

    Notes
    -----
    The mean profile of the side is fitted by least squares with

        level − a f(L) below the pitch point − b f(L) above it + h exp(−½ (L − L_p)² / l²),

    f a power of the specific sliding, or of the way from the pitch point, and with the same without the last term; of each the shape that leaves least. Where
    contact begins no drawing of one gear tells: columns nearer the root than the deepest below the pitch point, and the first, are left out. What the squares
    gain by h, over what is left of them (and no less than the square of how well the level as made is known), is Student's t².
    """
    above = above_made(sheets, side)[grid.toothed]
    profile, often = strip_means(above, 0)
    std = loop.as_made_std[side.index]
    use = _slid(profile, often, grid, loop)
    nothing = np.zeros_like(profile)
    plain, hump = _best(profile, use, grid, loop, False), _best(profile, use, grid, loop, True)
    if hump is None or plain is None:
        return WornLevel(highest, highest if use.sum() > NUMBERS else 0.0, highest, None, nothing)
    free = hump.free
    scatter = hump.scatter(std)
    least = float(stdtrit(free, SURE)) if free > 0 else math.inf
    # A strip beside the pitch point has lost something; a row that has lost nothing is seen by itself.
    beside = max(highest_strip(above - hump.height * hump.shape), hump.level)
    wide = least * scatter * hump.level_std if free > 0 else math.inf
    # The highest strip is as wide as a column: what goes on to its middle may be higher.
    top = highest
    if free > 0:
        top = max(plain.level + float(stdtrit(plain.free, SURE)) * plain.scatter(std) * plain.level_std, highest)
    low, high = (min(max(level, 0.0), highest) for level in (beside - wide, beside + wide))
    if math.sqrt(max(plain.left - hump.left, 0.0)) <= least * scatter:
        return WornLevel(highest, low, top, None, nothing)
    height = beside if beside > math.hypot(NORMAL_95 * std, wide) else 0.0
    height = min(height, highest)
    proud = np.where(hump.shape > FOOT, np.maximum(profile - height, 0.0), 0.0)
    return WornLevel(height, min(low, height), max(high, height), PitchRidge(side, hump.height, scatter * hump.height_std), proud)


@dataclass(frozen=True, slots=True)
class _Profile:
    """A profile that was fitted: the squares left, mm², of how many more columns than numbers, and level, and the hump's height, mm, and shape (columns,);
    the standard deviations of level and height are in those of a column."""

    left: float
    free: int
    level: float
    level_std: float
    height: float
    height_std: float
    shape: Floats

    def scatter(self, std: float) -> float:
        """Standard deviation of a column, mm, by what is left of them and no less than `std`, mm."""
        return max(math.sqrt(self.left / max(self.free, 1)), std)


def pitch_level(heights: Floats, grid: CellGrid, loop: Loop, side: Side) -> tuple[float, float] | None:
    """How high a side stands at the pitch point as its profile goes on to it, and the standard deviation of that, mm; None of too few columns.

    Parameters
    ----------
    heights : (rows, columns) float
        Of the flanks of the side, in the median of the teeth, mm; nan where not seen.
    grid, loop, side
        As of `worn_level`; parameters of the fit likewise, without a ridge.
    """
    profile, often = strip_means(heights, 0)
    plain = _best(profile, _slid(profile, often, grid, loop), grid, loop, False)
    if plain is None or plain.free <= 0:
        return None
    return plain.level, plain.scatter(loop.as_made_std[side.index]) * plain.level_std


def _slid(profile: Floats, often: Bools, grid: CellGrid, loop: Loop) -> Bools:
    """Columns that were seen `often` and have slid since contact began: not the first, nor those nearer to the root than the deepest below the pitch point."""
    still = int(grid.flank_column(loop.context.pitch_roll))
    use = often.copy()
    use[: max(int(np.argmin(np.where(often, profile, np.inf)[:still])) if still else 0, 1)] = False
    return use


def _best(profile: Floats, use: Bools, grid: CellGrid, loop: Loop, hump: bool) -> _Profile | None:
    """The profile that leaves least, with a hump that stands up or without one; None where there is none, or nothing to fit."""
    rolls, pitch = grid.rolls(2 * PARTS)[1::2], loop.context.pitch_roll
    still, module = int(grid.flank_column(pitch)), grid.gear.transverse_module
    least = NARROWEST * abs(grid.roll_edges[still + 1] - grid.roll_edges[still])
    widths = [width * module for width in WIDTHS if width * module > least] or [WIDTHS[-1] * module]
    sliding = np.abs(loop.context.sliding(rolls))
    fits = list[_Profile]()
    for law in (way**power for way in (sliding, np.abs(rolls - pitch)) for power in POWERS):
        for width in widths if hump else [math.nan]:
            shape = np.exp(-0.5 * ((rolls - pitch) / width) ** 2) if hump else np.zeros_like(rolls)
            columns = np.stack([np.ones_like(law), -law * (rolls < pitch), -law * (rolls > pitch), shape])
            columns = columns.reshape(4, grid.flank, PARTS).mean(axis=2)
            design = columns[:, use].T
            value, _, rank, _ = np.linalg.lstsq(design, profile[use], rcond=None)
            if hump and not value[3] > 0.0:
                continue
            left = float(((profile[use] - design @ value) ** 2).sum())
            stds = np.sqrt(np.maximum(np.diag(np.linalg.pinv(design.T @ design)), 0.0))  # of columns alike rounding leaves less
            free = int(use.sum()) - int(rank) - hump  # the width is a number too
            fits.append(_Profile(left, free, float(value[0]), float(stds[0]), float(value[3]), float(stds[3]), columns[3]))
    return min(fits, key=lambda fit: fit.left, default=None)

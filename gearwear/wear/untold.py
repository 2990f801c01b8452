"""How high flanks were made that are no datum: of teeth that have amounts of their own, by what is left of the flank to see them by.

A flank that is hollow over much of it tells nothing of pitch and thickness. Its fillet and the other flank of its tooth do, as far as tools cut them together:
how far that is, the flanks say that are sound, each left out in turn.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.effects.each_tooth import EachTooth
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells

TOLD, SOUND = 0.1, 0.3
"""Share of a flank's cells that the fit used, below which it is none's datum, and above which it may be left out in turn to see what the others tell of it."""


@dataclass(frozen=True, slots=True)
class UntoldFlanks:
    """Flanks that tell nothing of their own level.

    Parameters
    ----------
    level : (teeth, 2) float
        By how much left and right flanks stand higher as made than the loop has it, mm: as the rest of their tooth has them, and no tooth's amount is what the
        sum of the others leaves for it.
    raised : (m,) float
        The same of the cells of flanks.
    fields : (m, k) float
        How high each may stand besides, mm, even all over it: the RMS by which sound flanks, each left out in turn, stand off where the rest of their
        tooth has them.
    """

    level: Floats
    raised: Floats
    fields: Floats

    @classmethod
    def of(cls, cells: Cells, loop: Loop) -> UntoldFlanks:
        """Of a scan; sides worn throughout have their own (`Loop.made`)."""
        points, weight = cells.points, loop.covariance.weight
        flank = (points.surface == FLANK) & cells.seen
        which = points.tooth.astype(np.int64) * len(Side) + (points.side < 0)
        on, flanks = np.flatnonzero(flank), cells.grid.gear.teeth * len(Side)
        number = np.bincount(which[on], minlength=flanks)
        share = np.bincount(which[on], loop.use[on], minlength=flanks) / np.maximum(number, 1)
        worn = np.isin(np.arange(flanks) % len(Side), [side.index for side in loop.worn_sides])
        hidden = np.flatnonzero((number > 0) & (share < TOLD) & ~worn)
        level, raised = np.zeros((cells.grid.gear.teeth, len(Side))), np.zeros(len(flank))
        if not len(hidden) or not any(effect.candidate.effect.tooth_specific for effect in loop.effects):
            return cls(level, raised, np.zeros((len(flank), 0)))
        columns, amounts = _amounts(cells, loop)
        found = (columns * amounts[points.tooth]).sum(axis=1)
        target, used = loop.residual_after + found, np.flatnonzero(loop.use & cells.seen)

        def amount(k: int) -> Floats:
            """Least amounts of a tooth with which the rest of it stands where it does, the flank `k` left out."""
            rows = used[(points.tooth[used] == k // len(Side)) & ~(flank & (which == k))[used]]
            root = np.sqrt(weight[rows])
            return np.asarray(np.linalg.lstsq(columns[rows] * root[:, None], target[rows] * root)[0], dtype=np.float64)

        for k in hidden:
            own = flank & (which == k)
            raised[own] = (columns[own] @ amount(int(k))) - found[own]
            level[divmod(int(k), len(Side))] = raised[own].mean()
        off = []
        for k in np.flatnonzero((share > SOUND) & ~worn):
            rows = used[(flank & (which == k))[used]]
            off.append(np.average(target[rows] - columns[rows] @ amount(int(k)), weights=weight[rows]))
        rms = math.sqrt(float(np.mean(np.square(off)))) if off else 0.0
        return cls(level, raised, (flank[:, None] & (which[:, None] == hidden)) * rms)


def _amounts(cells: Cells, loop: Loop) -> tuple[Floats, Floats]:
    """What an amount of 1 of a tooth does to its cells, (m, e), by the effects of which every tooth has one; and these, (teeth, e)."""
    seen, points = cells.seen, cells.points.take(cells.seen)
    columns, amounts = [], []
    for found in loop.effects:
        effect = found.candidate.effect
        if isinstance(effect, EachTooth):
            columns.append(np.zeros(len(seen)))
            columns[-1][seen] = effect.deviation(points, loop.context, found.candidate.shape)
            amounts.append(effect.amounts(np.nan_to_num(found.amplitudes), loop.context))
    return np.reshape(columns, (-1, len(seen))).T, np.reshape(amounts, (-1, cells.grid.gear.teeth)).T

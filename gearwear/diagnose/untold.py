"""How high flanks were made that are no datum: of teeth that have amounts of their own, by what is left of the flank to see them by.

A flank that is hollow over much of it tells nothing of pitch and thickness. Its fillet and the other flank of its tooth do, as far as tools cut them together:
how far that is, the flanks say that are sound, each left out in turn. That the amounts of all teeth add up to zero is how they are written, and tells nothing.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.effects.each_tooth import EachTooth
from gearwear.diagnose.found import FoundEffect, Loop, UntoldFlanks
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells


def with_untold(loop: Loop, cells: Cells) -> Loop:
    """A loop with what it does not tell: the levels of flanks that are no datum, and amounts of their teeth by the rest of these.

    Parameters
    ----------
    loop : Loop
        As it was fitted.
    cells : Cells
        Those it stands on.
    """
    points, weight = cells.points, loop.covariance.weight
    flank = (points.surface == FLANK) & cells.seen
    which = points.tooth.astype(np.int64) * len(Side) + (points.side < 0)
    on, flanks = np.flatnonzero(flank), cells.grid.gear.teeth * len(Side)
    number = np.bincount(which[on], minlength=flanks)
    share = np.bincount(which[on], loop.use[on], minlength=flanks) / np.maximum(number, 1)
    worn = np.isin(np.arange(flanks) % len(Side), [side.index for side in loop.worn_sides])  # `made` is their doubt
    hidden = np.flatnonzero((number > 0) & (share < rules().untold_flank) & ~worn)
    sound = np.flatnonzero((share > rules().sound_flank) & ~worn)
    own = [i for i, found in enumerate(loop.effects) if isinstance(found.candidate.effect, EachTooth)]
    if not (len(hidden) and len(sound) and own):
        return loop
    columns, amounts = _amounts(cells, loop, [loop.effects[i] for i in own])
    found = (columns * amounts[points.tooth]).sum(axis=1)
    target, used = loop.residual_after + found, np.flatnonzero(loop.use & cells.seen)

    def rest(k: int) -> tuple[Floats, Floats]:
        """Least amounts of a tooth with which the rest of it stands where it does, the flank `k` left out; and how they go together where it tells least."""
        rows = used[(points.tooth[used] == k // len(Side)) & ~(flank & (which == k))[used]]
        root = np.sqrt(weight[rows])
        told = columns[rows] * root[:, None]
        return np.linalg.lstsq(told, target[rows] * root)[0], np.linalg.eigh(told.T @ told)[1][:, 0]

    off = []
    for k in map(int, sound):
        rows = used[(flank & (which == k))[used]]
        off.append(np.average(target[rows] - columns[rows] @ rest(k)[0], weights=weight[rows]))
    rms = math.sqrt(float(np.mean(np.square(off))))
    raised, (level, level_std) = np.zeros(len(flank)), np.zeros((2, cells.grid.gear.teeth, len(Side)))
    effects, scatter = list(loop.effects), np.sqrt(np.mean(amounts[sound // len(Side)] ** 2, axis=0))
    for k in map(int, hidden):
        at, on = (k // len(Side), k % len(Side)), np.flatnonzero(flank & (which == k))
        told, free = rest(k)
        raised[on] = columns[on] @ told - found[on]
        level[at] = raised[on].mean()
        lever = columns[on].mean(axis=0)
        if told.any():
            level_std[at], stds = rms, np.abs(rms / (lever @ free) * free)
        else:  # nothing of the tooth is told: it is as others are
            level_std[at], stds = np.linalg.norm(lever * scatter), scatter
        for i, value, std in zip(own, told, stds, strict=True):
            effects[i] = _told(effects[i], at[0], float(value), float(std))
    fields = (flank[:, None] & (which[:, None] == hidden)) * level_std.reshape(-1)[hidden]
    return replace(loop, effects=tuple(effects), untold=UntoldFlanks(level, level_std, raised, fields))


def _told(found: FoundEffect, tooth: int, value: float, std: float) -> FoundEffect:
    """The effect with another amount of a tooth, mm, as reported; `std` besides what the fit says of it."""
    (parameter,) = found.candidate.effect.parameters
    known = found.parameters[parameter.name]
    own = parameter.estimate(value, std)
    values, stds = (np.array(each, dtype=np.float64) for each in (known.value, known.std))
    values[tooth], stds[tooth] = own.value, np.hypot(own.std, np.nanmedian(stds))
    changed = replace(known, value=tuple(values.tolist()), std=tuple(stds.tolist()))
    return replace(found, parameters={**found.parameters, parameter.name: changed})


def _amounts(cells: Cells, loop: Loop, effects: list[FoundEffect]) -> tuple[Floats, Floats]:
    """What an amount of 1 of a tooth does to its cells, (m, e), by effects of which every tooth has one; and these, (teeth, e)."""
    seen, points = cells.seen, cells.points.take(cells.seen)
    columns, amounts = np.zeros((len(seen), len(effects))), []
    for column, found in zip(columns.T, effects, strict=True):
        effect = found.candidate.effect
        assert isinstance(effect, EachTooth)
        column[seen] = effect.deviation(points, loop.context, found.candidate.shape)
        amounts.append(effect.amounts(np.nan_to_num(found.amplitudes), loop.context))
    return columns, np.transpose(amounts)

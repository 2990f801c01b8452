"""How high flanks were made that are no datum: of teeth that have amounts of their own, by what is left of the flank to see them by.

A flank that is hollow over much of it tells nothing of pitch and thickness. Its fillet and the other flank of its tooth do, as far as tools cut them together:
how far that is, the flanks say that are sound, each left out in turn. That the amounts of all teeth add up to zero is how they are written, and tells nothing.

With amounts a told by the rest of tooth k, the flank left out stands at c·a + m + e: m is the same on all flanks of its side, the form of that and what the
form of the rest has made of a, whether an effect has its name or not; e has the variance s² from tooth to tooth. So a flank that is no datum was made at c·a
and the mean of the sound ones, with s² by itself and s² / n of n sound flanks in common with all others of its side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtri

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK
from gearwear.diagnose.effects.base import Kind
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
    used = np.flatnonzero(loop.use & cells.seen)
    told_half = np.bincount(which[used[np.isin(points.surface[used], (FLANK, FILLET))]], minlength=flanks) > 0
    worn = np.isin(np.arange(flanks) % len(Side), [side.index for side in loop.worn_sides])  # `made` is their doubt
    seen = number > 0
    silent, by_side = seen & ~told_half, (cells.grid.gear.teeth, len(Side))
    by_most = told_half.reshape(by_side).sum(axis=0) > silent.reshape(by_side).sum(axis=0)
    at_an_edge = (silent.reshape(by_side) & by_most).reshape(-1)  # of a side that the halves of most others tell
    hidden = np.flatnonzero(seen & np.where(worn, at_an_edge, share < rules().untold_flank))
    sound = np.flatnonzero((share > rules().sound_flank) & ~worn)
    own = [i for i, found in enumerate(loop.effects) if isinstance(found.candidate.effect, EachTooth)]
    if not (len(hidden) and len(sound) and own):
        return loop
    columns, amounts = _amounts(cells, loop, [loop.effects[i] for i in own])
    found = (columns * amounts[points.tooth]).sum(axis=1)
    stands = _unexplained(cells, loop) + found - loop.form_of_all
    rows_of = {k: used[points.tooth[used] == k // len(Side)] for k in (*map(int, sound), *map(int, hidden))}

    def rest(k: int, target: Floats) -> tuple[Floats, Floats]:
        """Least amounts of a tooth with which the rest of it stands where it does, the flank `k` left out; and how they go together where it tells least."""
        rows = rows_of[k][~(flank & (which == k))[rows_of[k]]]
        root = np.sqrt(weight[rows])
        told = columns[rows] * root[:, None]
        return np.linalg.lstsq(told, target[rows] * root)[0], np.linalg.eigh(told.T @ told)[1][:, 0]

    def left_out(target: Floats) -> _SoundFlanks:
        off, own_mean, more = np.zeros(len(sound)), np.zeros(len(sound)), np.zeros((len(sound), len(own)))
        for i, k in enumerate(map(int, sound)):
            rows = rows_of[k][(flank & (which == k))[rows_of[k]]]
            told = rest(k, target)[0]
            off[i] = np.average(target[rows] - columns[rows] @ told, weights=weight[rows])
            own_mean[i] = np.average(target[rows], weights=weight[rows])
            more[i] = told - amounts[k // len(Side)]
        return _SoundFlanks.of(off, own_mean, more, sound % len(Side))

    known, waves = left_out(stands), loop.residual_after - loop.form_of_all - loop.left
    if waves.any():
        beside = left_out(stands - waves)
        if known.scatter > math.sqrt(float(fdtri(known.free, known.free, 1.0 - rules().significance))) * beside.scatter:
            known, stands, waves = beside, stands - waves, np.zeros_like(waves)
    raised, (level, level_std, shared) = np.zeros(len(flank)), np.zeros((3, cells.grid.gear.teeth, len(Side)))
    whole = np.unique(sound // len(Side))
    both: Bools = np.asarray(told_half.reshape(by_side).all(axis=1))[whole]
    whole = whole[both] if both.any() else whole
    effects, scatter = list(loop.effects), np.sqrt(np.mean(amounts[whole] ** 2, axis=0))
    for k in map(int, hidden):
        at, on = (k // len(Side), k % len(Side)), np.flatnonzero(flank & (which == k))
        told, free = rest(k, stands)
        lever = columns[on].mean(axis=0)
        if told.any():
            if told_half[k]:
                level_std[at], stds = known.scatter, np.abs(known.scatter / (lever @ free) * free)
            else:
                other = rows_of[k][(flank & (which == k + 1 - 2 * at[1]))[rows_of[k]]]
                told, spread = _likely(amounts[at[0]], columns[other].mean(axis=0) if len(other) else 0.0 * lever, scatter)
                level_std[at], stds = (np.sqrt(np.maximum(square, 0.0)) for square in (lever @ spread @ lever, np.diag(spread)))
            raised[on] = columns[on] @ told + known.off[at[1]]
            shared[at] = known.off_std[at[1]]
            told = told - known.more[at[1]]
        else:  # nothing of the tooth is told: it is as others are
            raised[on] = known.own[at[1]]
            level_std[at], stds = np.linalg.norm(lever * scatter), scatter
        raised[on] -= found[on] + waves[on]
        level[at] = raised[on].mean()
        for i, value, std in zip(own, told, stds, strict=True):
            effects[i] = _told(effects[i], at[0], float(value), float(std))
    apart = (flank[:, None] & (which[:, None] == hidden)) * level_std.reshape(-1)[hidden]
    alike = np.column_stack(
        [np.where(flank & (which % len(Side) == half), shared.reshape(-1)[which], 0.0) for half in range(len(Side))]
    )
    return replace(
        loop,
        effects=tuple(effects),
        untold=UntoldFlanks(level, np.hypot(level_std, shared), raised, np.hstack([apart, alike[:, alike.any(axis=0)]])),
    )


@dataclass(frozen=True, eq=False)
class _SoundFlanks:
    """What sound flanks, each left out in turn, say of those that are no datum; of left and right flanks.

    Parameters
    ----------
    off, off_std : (2,) float
        How far a flank stands on average off where the rest of its tooth has it, mm: by what form its side has and what that of the rest makes of the amounts.
    own : (2,) float
        How high a flank stands on average, the amounts of its tooth left in, mm.
    more : (2, e) float
        How much greater amounts on average come out that the rest of a tooth tells.
    scatter : float
        Standard deviation of one flank about `off`, mm.
    free : int
        Degrees of freedom of that.
    """

    off: Floats
    off_std: Floats
    own: Floats
    more: Floats
    scatter: float
    free: int

    @classmethod
    def of(cls, off: Floats, own: Floats, more: Floats, half: Ints) -> _SoundFlanks:
        """From the same of each of some flanks of left, 0, and right, 1; a side of which there are too few is taken for as drawn."""
        every = np.column_stack([off, own, more])
        number = np.bincount(half, minlength=len(Side))
        enough = number > 1  # one has no scatter about itself
        mean = np.array([every[half == side].mean(axis=0) if enough[side] else 0.0 * every[0] for side in range(len(Side))])
        free = max(len(off) - int(enough.sum()), 1)
        scatter = math.sqrt(float(((off - mean[half, 0]) ** 2).sum()) / free)
        off_std = np.where(enough, scatter / np.sqrt(np.maximum(number, 1)), math.sqrt(float(np.mean(off**2))))
        return cls(mean[:, 0], off_std, mean[:, 1], mean[:, 2:], scatter, free)


def _likely(amounts: Floats, lever: Floats, scatter: Floats) -> tuple[Floats, Floats]:
    """The amounts of a tooth, (e,), as likely as those of others make them, where only one flank of it tells ``lever · amounts``; and their covariance.

    Of N(0, S), S the diagonal of `scatter` squared, given c·a: the mean is ``S c (c·a) / cᵀSc``, the covariance ``S − S c cᵀ S / cᵀSc``.
    """
    prior = np.diag(scatter**2)
    pull = prior @ lever / max(float(lever @ prior @ lever), 1e-300)
    return pull * float(lever @ amounts), prior - np.outer(pull, lever @ prior)


def _told(found: FoundEffect, tooth: int, value: float, std: float) -> FoundEffect:
    """The effect with another amount of a tooth, mm, as reported; `std` besides what the fit says of it."""
    (parameter,) = found.candidate.effect.parameters
    known = found.parameters[parameter.name]
    own = parameter.estimate(value, std)
    values, stds = (np.array(each, dtype=np.float64) for each in (known.value, known.std))
    values[tooth], stds[tooth] = own.value, np.hypot(own.std, np.nanmedian(stds))
    changed = replace(known, value=tuple(values.tolist()), std=tuple(stds.tolist()))
    return replace(found, parameters={**found.parameters, parameter.name: changed})


def _unexplained(cells: Cells, loop: Loop) -> Floats:
    """What the amplitudes of a loop leave of its cells, (m,) mm: where waves are unexplained they were fitted beside these, and `residual_after` without."""
    left = np.zeros(len(cells.seen))
    points = cells.points.take(cells.seen)
    left[cells.seen] = points.deviation - loop.deviation(points, frozenset(Kind))
    return np.where(cells.seen, left - cells.motion @ loop.motion, 0.0)


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

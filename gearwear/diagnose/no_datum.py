"""Sides of which the scan has nothing to be held by but their own flanks: what all of these have in common may be how they were made, or what they lost.

A side that is worn throughout is no datum, and what it lost is told by the rest: the flanks of the other side, fillets, tips, ends, a bore. Where one side alone
was seen, or nothing but flanks of which both may be worn, nothing is left: the pose would rest on no cell. No loop can be closed without these flanks
then, and what is named of them, a relief, a slope, a crowning, may as well be wear.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.optimize import nnls

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.effects.base import Context, Kind
from gearwear.diagnose.effects.sliding_wear import SLIDING_WEAR
from gearwear.diagnose.found import FoundEffect, Loop
from gearwear.diagnose.masks import sound_cells
from gearwear.diagnose.pitch_point import pitch_points, price_of
from gearwear.diagnose.rules import rules
from gearwear.diagnose.side_costs import NO_SIDE
from gearwear.placing.cells import CellGrid, Cells

HYPOTHESES = frozenset({frozenset({Side.LEFT}), frozenset({Side.RIGHT}), frozenset(Side)})
"""Sides that may be worn throughout together."""
BESIDE = "the other flanks, fillets, tips and an end"
"""What holds a gear without the flanks of a side, for a reader."""
SEEN = 1e-6
"""Share of what is told of the best known direction of a motion from which on a scan tells anything of one; numerical."""
PARTS = 16
"""Parts of a column over which shapes are averaged; numerical."""
ACROSS = [0, 1, 3, 4]
"""Motions that move the axis: with both sides worn a turn adds to one what it takes off the other, and the height moves nothing."""


def sides_seen(cells: Cells) -> frozenset[Side]:
    """Sides of which the scan has flanks that a fit may use."""
    flank = sound_cells(cells, NO_SIDE) & (cells.points.surface == FLANK)
    return frozenset(side for side in Side if (flank & (cells.points.side == int(side))).any())


def leaves_a_datum(cells: Cells, context: Context, worn: frozenset[Side]) -> bool:
    """Whether the gear is still held by what was seen besides the flanks of sides `worn`, but for where they do not stand out.

    Notes
    -----
    With A and B the information of a small motion from all cells and from those that are left, it is the least eigenvalue of A^(-½) B A^(-½) that counts, in
    the directions of which A tells anything.
    """
    which = ACROSS if len(worn) == len(Side) else list(range(6))
    # By the tip's radius, a turn and a shift move surfaces alike.
    columns = cells.motion[:, which] / np.where(np.array(which) < 3, 1.0, cells.grid.gear.tip_radius)
    whole, left = (
        columns[rows].T @ columns[rows]
        for rows in (
            sound_cells(cells, NO_SIDE, context.fillets_told),
            sound_cells(cells, worn, context.fillets_told, context.faces),
        )
    )
    told, axes = np.linalg.eigh(whole)
    known = told > SEEN * told[-1]
    way = axes[:, known] / np.sqrt(told[known])
    return bool(known.any() and np.linalg.eigvalsh(way.T @ left @ way)[0] > rules().least_held)


def without_a_datum(cells: Cells, context: Context) -> frozenset[frozenset[Side]]:
    """Which sides, worn throughout together, leave no datum."""
    return frozenset(worn for worn in HYPOTHESES if not leaves_a_datum(cells, context, worn))


def not_to_be_asked(cells: Cells, bare: frozenset[frozenset[Side]]) -> frozenset[frozenset[Side]]:
    """Hypotheses that no scan decides: worn sides that were not seen, and one side that leaves no datum, of `bare`; whether both are worn, forms that they share
    or not speak for or against."""
    seen = sides_seen(cells)
    return frozenset(worn for worn in HYPOTHESES if not worn <= seen or (len(worn) == 1 and worn in bare))


def or_worn(effects: Iterable[FoundEffect], sides: frozenset[Side], cells: Cells, context: Context) -> tuple[FoundEffect, ...]:
    """Effects, with sliding wear among the alternatives of those that bend or lean the profile which all flanks of some sides have."""
    return tuple(
        effect.or_one_of({SLIDING_WEAR} if sides and _on_profile(effect, sides, cells, context) else ()) for effect in effects
    )


def _on_profile(effect: FoundEffect, sides: frozenset[Side], cells: Cells, context: Context) -> bool:
    """Whether what an effect does to the flanks of some sides goes by the height on the profile, the same on all teeth."""
    if effect.candidate.effect.tooth_specific or effect.kind is Kind.FORM:
        return False
    points = cells.points.take(cells.seen)
    field = np.full(len(cells.seen), np.nan)
    field[cells.seen] = effect.candidate.effect.basis(points, context, effect.candidate.shape) @ effect.amplitudes
    flanks = cells.grid.flank_shape(field)[:, [side.index for side in sides]]
    profile = _mean(flanks, axis=(0, 2))
    return bool(np.nanvar(profile) > rules().even_share * np.nanmean(flanks**2))


def most_lost(loop: Loop, cells: Cells) -> Floats:
    """What the flanks of both sides would have lost, were all that their teeth have in common wear, (2, rows, columns) mm; nan where nobody saw them.

    Parameters
    ----------
    loop : Loop
    cells : Cells
        Where it leaves them, with what its effects do still in them.

    Notes
    -----
    Nothing was lost where a side is highest. That may be a tip within a column of cells, which its mean does not show: the profile is gone on to it from both
    sides, as losses by the laws of wear do, about the pitch point with which they come out highest of all that leave no more than chance (`_tip`).
    """
    grid, flank = cells.grid, slice(cells.grid.fillet, None)
    points = cells.points.take(cells.seen)
    found = loop.form_of_all
    found[cells.seen] += loop.deviation(points, frozenset(Kind))
    # Averaged over cells, as it was fitted: at a knee their middle is higher.
    field = np.where(cells.seen, np.nan_to_num(cells.points.deviation) - loop.left, np.nan)
    form, count = _mean(grid.sides(field), axis=(0,))[..., flank], grid.flank_shape(cells.count).sum(axis=(0, 2))
    # Effects seldom fit what was lost: their profile is that which was measured.
    form += np.nan_to_num(_mean(grid.flank_shape(np.where(loop.use, loop.left, np.nan)), axis=(0, 2)))[:, None]
    lost = np.full(form.shape, np.nan)
    for side in Side:
        own = form[side.index]
        if not np.isfinite(own).any() or not found[cells.seen & (cells.points.side == int(side))].any():
            lost[side.index] = 0.0 * own
            continue
        profile, known = _mean(own, axis=(0,)), np.isfinite(own).any(axis=0)
        std = loop.noise / np.sqrt(np.maximum(count[side.index], 1.0))
        beyond = _tip(profile, std, known, grid, loop.context) - float(profile[known].max())
        lost[side.index] = np.nanmax(own) + max(beyond, 0.0) - own
    return lost


def _tip(profile: Floats, std: Floats, known: Bools, grid: CellGrid, context: Context) -> float:
    """How high a profile (columns,) mm stands at the tip between what it has lost below and above it, mm.

    Of level − a f(L) below the pitch point − b f(L) above it, averaged over columns, f the sliding or the way from there; of a and b each is at least the
    `least_load` part of the other. About the pitch points that a gear may have, the highest level of those that cost no more than the best does and chance, by
    the columns' standard deviations `std`.
    """
    rolls, least = grid.rolls(2 * PARTS)[1::2], rules().least_load
    answers = list[tuple[float, float]]()
    for pitch in (None, *(() if context.mate is not None or context.pitch is not None else pitch_points(context).tolist())):
        at = context if pitch is None else context.with_pitch(pitch)
        paid, still = 0.0 if pitch is None else price_of(pitch, context), at.pitch_roll
        for way in (np.abs(at.sliding(rolls)), np.abs(rolls - still)):
            below, above = np.where(rolls < still, way, 0.0), np.where(rolls < still, 0.0, way)
            law = np.stack([np.ones_like(way), -np.ones_like(way), -(below + least * above), -(least * below + above)])
            columns = law.reshape(4, grid.flank, PARTS).mean(axis=2)[:, known].T  # a level of either sign
            value, left = nnls(columns / std[known, None], profile[known] / std[known])
            answers.append((float(left) ** 2 + paid, float(value[0] - value[1])))
    cheapest = min(cost for cost, _ in answers)
    return max(level for cost, level in answers if cost <= cheapest + rules().close)


def _mean(values: Floats, axis: tuple[int, ...]) -> Floats:
    """Over some axes, of what is no nan; nan where nothing is."""
    known: Bools = np.isfinite(values)
    number = known.sum(axis=axis)
    return np.where(number > 0, np.where(known, values, 0.0).sum(axis=axis) / np.maximum(number, 1), np.nan)

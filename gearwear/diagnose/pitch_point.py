"""Where on the flanks nothing slides, of a gear without a mate in its design: as the loss of a whole side shows it.

Wear by sliding is none at the pitch point. At the centre distance of gears whose profile shifts sum to zero that is the reference circle; with other
shifts it lies off it, at the roll ``L = r_b tan α_w`` with ``inv α_w = inv α + 2 Σx tan α / (z1 + z2)`` (ISO 21771:2007), which is to first order

    L − L_reference = m Σx z1 / (z1 + z2) / sin α .

A loss about a pitch point that is another tells it, at the price of a shape value and of how seldom shifts sum to so much.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.side import Side
from gearwear.diagnose.columns import CellColumns
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.flank_columns import law_shapes
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules

STEP = 0.1
"""Between pitch points that are tried, modules of roll."""


def pitch_points(context: Context) -> Floats:
    """Rolls at which the pitch point may lie, mm, the reference circle's left out: as far off it as three standard deviations of the shifts of pairs
    in use, within the middle of the flank."""
    gear = context.gear
    step, spread = STEP * gear.transverse_module, rules().pitch_spread * gear.transverse_module
    many = int(3.0 * spread / step)
    rolls = gear.reference_roll + step * np.concatenate([np.arange(-many, 0), np.arange(1, many + 1)])
    ends = np.sort([gear.form_roll, gear.tip_roll])
    edge = rules().pitch_within * np.ptp(ends)
    return np.asarray(rolls[(rolls > ends[0] + edge) & (rolls < ends[1] - edge)], dtype=np.float64)


def price_of(roll: float, context: Context) -> float:
    """What a pitch point at some roll (mm) costs beyond that at the reference circle: a shape value, and twice the logarithm of how seldom it is there."""
    off = (roll - context.gear.reference_roll) / (rules().pitch_spread * context.gear.transverse_module)
    return float(rules().parameter_penalty * rules().shape_price + off**2)


def likeliest(
    context: Context, roll: Floats, side: Ints, target: Floats, weight: Floats, made: Floats, unit: float
) -> tuple[float, float] | None:
    """The pitch point off the reference circle at which a loss by sliding explains cells better than at it, and its price; None where none does.

    Parameters
    ----------
    context : Context
    roll : (n,) float
        Of cells, mm; on flanks.
    side : (n,) int
        +1 left, −1 right flank, 0 elsewhere.
    target, weight : (n,) float
        Their deviation, mm, and weight.
    made : (n, k) float
        What the gear may have been made with.
    unit : float
        Weighted square that is one of cost.

    Returns
    -------
    (float, float) or None
        Roll, mm, and price.
    """
    rolls = np.concatenate([[context.gear.reference_roll], pitch_points(context)])
    shapes = [_about(one, roll, context) for one in rolls]
    count = shapes[0].shape[1]
    # Side by side: what one has lost is nothing on the cells of the other, and off the flanks.
    parts = [np.flatnonzero(side == which) for which in (*map(int, Side), 0)]
    columns = CellColumns.of_pieces(
        np.hstack(
            [made[rows], *(np.where((side[rows] == int(one))[:, None], -shape[rows], 0.0) for shape in shapes for one in Side)]
        )
        for rows in parts
    )
    order = np.concatenate(parts)
    gram = Gram.by_weight(columns, target[order])(weight[order])
    at = made.shape[1] + count * np.arange(len(shapes) * len(Side)).reshape(-1, len(Side), 1) + np.arange(count)
    known = np.arange(made.shape[1])
    answers = [(0,), (1,), (0, 1)]  # the sides that have lost it
    square = np.array([[_left(gram, known, at[i, list(sides)].ravel()) for sides in answers] for i in range(len(rolls))])
    price = np.array([0.0, *(price_of(one, context) for one in rolls[1:])])
    best = int(np.argmin(square.min(axis=1) / unit + price))
    return None if best == 0 else (float(rolls[best]), float(price[best]))


def as_slid(lost: Floats, way: Floats, made: float) -> bool:
    """Whether a loss along the profile, (n,) mm, may follow load times sliding; `way` (n,) mm is how far up the line of action the pitch point lies behind.

    Away from the pitch point flanks slide faster, and two pairs of teeth share the load: further out each carries a third of it at least, at specific sliding of
    at least half. So where a place has lost anything, all beyond have lost a part of that times their way; but for what flanks are made with, `made` mm.
    """
    for half in (way < 0.0, way >= 0.0):
        half = half & (np.abs(way) > rules().least_way * np.abs(way[half]).max(initial=0.0))
        outward = np.flatnonzero(half)[np.argsort(np.abs(way[half]))]
        load = (lost[outward] - lost.min()) / np.abs(way[outward])
        if ((rules().least_load * np.maximum.accumulate(load) - load) * np.abs(way[outward]) > made).any():
            return False
    return True


def _about(pitch: float, roll: Floats, context: Context) -> Floats:
    """Losses about a pitch point, (n, 7): the sliding below and above it by amounts of their own, as the load is shared, the ways, and what plastic flow may have
    raised there, of widths from one step to four."""
    sliding, *ways = law_shapes(roll, context.with_pitch(pitch)).T
    below = roll < pitch
    off = (roll - pitch) / (STEP * context.gear.transverse_module)
    ridges = [-np.exp(-0.5 * (off / width) ** 2) for width in (1.0, 2.0, 4.0)]
    return np.column_stack([np.where(below, sliding, 0.0), np.where(below, 0.0, sliding), *ways, *ridges])


def _left(gram: Gram, free: Ints, lost: Ints) -> float:
    """Weighted square that some free columns and losses leave."""
    amplitudes, which = gram.solve_non_negative(free, lost), np.concatenate([free, lost])
    of_all, moment = gram.information[0], gram.moment[0]
    explained = 2.0 * amplitudes @ moment[which] - amplitudes @ of_all[np.ix_(which, which)] @ amplitudes
    return float(gram.square.sum() - explained)

"""Whether an effect stands out of a form round the gear, or is the part of it that has the effect's orders.

A blank of three lobes, views that lie apart and a range that drifts make waves of many orders. The catalogue has a name for some orders alone, an ovality of the
scanner's scale or a wobble, and would give it to what such a form has of them. A jump, of a view out of place or of a drift that closes, is waves of
all orders with heights that belong together; a form of few orders has some of them alone.
"""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri, fdtrc

from gearwear.arrays import Floats
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.jumps import has_jump
from gearwear.diagnose.own_waves import (
    HIGHEST_ORDER,
    LEAST_ORDER,
    NEIGHBOURS,
    all_teeth_seen,
    height_of,
    order_of,
    orders_beside,
    turned_to,
)
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem
from gearwear.placing.cells import CellGrid


def hidden_among_orders(fit: Fit, problem: Problem, model: Model) -> int | None:
    """The effect of one order, or with a jump, that stands out least; None where all do.

    Parameters
    ----------
    fit : Fit
        Its target holds the patterns found before, which are waves of such orders.
    problem, model : Problem, Model
        The effects to look at, all together.

    Notes
    -----
    What an effect of q columns explains beside the others, g, is put against what its own shape explains at the m / 2 other orders, h, each a wave
    and the same a quarter further round: F = (g / q) / (h / m), by Fisher's distribution, corrected for all candidates. Where h is no more than chance,
    its m waves being as independent as the cells' covariance has it, there is no form to be a part of. An effect that jumps has waves of these orders itself:
    h is what they explain with heights other than the jump's.
    """
    if not all_teeth_seen(fit.cells.grid, fit.use):
        return None
    amplitudes, _ = problem.gram.solve(problem.columns(model))
    columns, parts = fit.columns(model), fit.parts(model)
    least = (rules().significance_of_names, -1)
    for i, (candidate, part) in enumerate(zip(model, parts, strict=True)):
        if candidate.effect.tooth_specific or candidate.effect.kind in (Kind.WEAR, Kind.FORM):
            continue
        field = np.where(fit.cells.seen, columns[:, part] @ amplitudes[part], 0.0)
        if waves := _waves_beside(fit.cells.grid, field, has_jump(candidate.effect)):
            p_value = len(problem.dictionary.candidates) * _by_chance(fit, problem, columns, part, waves)
            least = max(least, (p_value, i))
    return least[1] if least[1] >= 0 else None


def _waves_beside(grid: CellGrid, field: Floats, jumps: bool) -> list[Floats]:
    """Waves of an effect's shape, (m, 2) each: at the orders beside its own, or, of one that jumps, at each of its own; none of another effect."""
    order = order_of(grid, field)
    if not (order or jumps):
        return []
    orders = orders_beside(grid, order, LEAST_ORDER, HIGHEST_ORDER + NEIGHBOURS)
    return [turned_to(grid, height_of(grid, field, order or k), k) for k in orders]


def _by_chance(fit: Fit, problem: Problem, columns: Floats, part: slice, waves: list[Floats]) -> float:
    """Probability that a part of what makes such waves (m, 2) explains as much as an effect does."""
    gram, every = fit.statistics(np.hstack([columns, *waves])), np.arange(columns.shape[1])
    own = every[part]
    (gain,) = gram.gains(np.setdiff1d(every, own), [own])
    places = columns.shape[1] + np.arange(2 * len(waves)).reshape(-1, 2)
    beside = float(np.sum(gram.gains(every, list(places)))) / problem.unit
    count = 2 * len(waves)
    if beside < float(chdtri(count, rules().significance)):
        return 0.0
    return float(fdtrc(len(own), count, gain / problem.unit / len(own) / (beside / count)))

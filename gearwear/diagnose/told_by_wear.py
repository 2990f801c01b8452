"""Which of several effects it is that the sound flanks cannot tell apart: the one beside which a worn side has lost metal as wear takes it.

The flanks of a side worn throughout are no evidence of what was made. Where they are left out, a taper and a helix slope are one effect: they differ
on the other side alone. There the wrong one of both leaves twice its size, as metal that no sliding took, or that stands proud.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import nnls

from gearwear.design.side import Side
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.flank_columns import law_shapes
from gearwear.diagnose.judge import replacements
from gearwear.diagnose.rules import rules
from gearwear.diagnose.search import Problem


def told_by_wear(fit: Fit, problem: Problem, model: Model) -> Model:
    """The model with another effect in the place of one that it cannot be told from, where the sides worn throughout look more like worn beside it.

    Parameters
    ----------
    fit : Fit
        Without the flanks of these sides.
    problem : Problem
    model : Model

    Returns
    -------
    Model
        The same where nothing gains more than chance.
    """
    worn = problem.context.worn
    if not worn:
        return model
    for index, candidate in enumerate(model):
        if candidate.name in problem.always:
            continue
        models = [model, *(other for _, other in replacements(problem, model, index))]
        if len(models) > 1 and (best := _likelier([_left(fit, problem, one, worn) for one in models])) is not None:
            model = models[best]
    return model


def _likelier(left: Sequence[tuple[float, float]]) -> int | None:
    """Which of some models, as `_left` tells of each, has so much less left than the first that it is no chance; None where none has.

    What the best leaves beyond noise is how far the metal is not lost as the shapes of wear have it, by an askew mate for one: that it is less by some
    cells' noise then tells nothing, and it is measured by what is left per cell (an overdispersed likelihood, Wedderburn 1974).
    """
    costs = [cost for cost, _ in left]
    best = int(np.argmin(costs))
    cost, number = left[best]
    return best if costs[0] - cost > rules().close * max(1.0, cost / max(number, 1.0)) else None


def _left(fit: Fit, problem: Problem, model: Model, worn: frozenset[Side]) -> tuple[float, float]:
    """What losing metal by sliding and evenly does not explain of what a model leaves of some sides, on most teeth, in units of the search's cost; and
    what noise would leave."""
    cells, left = fit.cells, np.where(fit.cells.seen, fit.residual(model), np.nan)
    weight = np.where(cells.seen, fit.covariance.weight, 0.0)
    total, number = 0.0, 0
    for side in worn:
        # Without the columns next to the form circle: where contact begins, and wear with it, no drawing of one gear tells.
        own, known, roll = (cells.grid.flank_shape(of)[:, side.index, :, 1:] for of in (left, weight, cells.points.roll))
        often = np.isfinite(own).mean(axis=0) > 0.5
        if not often.any():
            continue
        common, heavy = np.nanmedian(own[:, often], axis=0), np.sqrt(known[:, often].sum(axis=0))
        law = law_shapes(np.nanmean(roll[:, often], axis=0), problem.context)
        losses = -np.column_stack([law, np.ones(len(law))])
        total += nnls(losses * heavy[:, None], common * heavy)[1] ** 2
        number += len(law)
    return total / problem.unit, number / problem.unit

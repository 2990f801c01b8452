"""How surely the place of a jump round the gear is known: from how much worse the scan is explained as it moves.

A jump has no slope that a covariance of first order could use, and where no surface shows it, on lands and next to them on fillets whose normals run
outward, it may lie anywhere.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats
from gearwear.diagnose.dictionary import cell_basis
from gearwear.diagnose.effects.base import Context, Effect
from gearwear.diagnose.fit import Fit, Model
from gearwear.diagnose.parameter import Spread

PITCHES, STEPS = 2, 24
"""How far on either hand a jump is tried, and in how many steps a pitch; numerical."""


def has_jump(effect: Effect) -> bool:
    """Whether a shape value of an effect is a place at which it jumps."""
    return any(parameter.spread is Spread.JUMP for parameter in effect.parameters)


def jump_deviations(fit: Fit, model: Model, index: int, unit: float, context: Context) -> Floats | None:
    """Standard deviation of each place, (q,) rad, at which one of the effects of a model jumps; None where it does not.

    Parameters
    ----------
    fit : Fit
    model : Model
    index : int
        Which of them.
    unit : float
        Expected gain of a column that explains nothing, as of `Problem`.
    context : Context

    Notes
    -----
    Likelihood of the jump at each place about where it was found, its size, the pose and all other effects fitted anew:
    ``exp(−χ² / 2)``, with χ² in units of what correlated noise gains. The mean square of the way from where it was found, and what lies within a cell.
    """
    candidate, part = model[index], fit.parts(model)[index]
    if not has_jump(candidate.effect):
        return None
    pitch, cells = context.gear.pitch_angle, fit.cells
    way = pitch * np.arange(-PITCHES * STEPS, PITCHES * STEPS + 1) / STEPS
    used = np.flatnonzero(fit.use & cells.seen)
    root, points = np.sqrt(fit.weight[used]), cells.points.take(used)
    others = np.delete(fit.columns(model)[used], np.arange(part.start, part.stop), axis=1) * root[:, None]
    lengths = np.linalg.norm(others, axis=0)
    base = np.linalg.qr(others[:, lengths > 0.0] / lengths[lengths > 0.0])[0]
    target = root * fit.target[used]
    target = target - base @ (base.T @ target)
    within = cells.grid.size / context.gear.reference_radius / math.sqrt(12.0)
    result = np.zeros(len(candidate.shape))
    for axis in range(len(result)):
        gain = np.zeros(len(way))
        for i, step in enumerate(way):
            shape = (*candidate.shape[:axis], candidate.shape[axis] + float(step), *candidate.shape[axis + 1 :])
            own = cell_basis(candidate.effect, points, context, shape, cells.grid) * root[:, None]
            own = own - base @ (base.T @ own)
            amplitudes = np.linalg.lstsq(own, target)[0]
            gain[i] = float(target @ own @ amplitudes)
        likelihood = np.exp((gain - gain.max()) / (2.0 * unit))
        result[axis] = math.hypot(math.sqrt(float(likelihood @ way**2 / likelihood.sum())), within)
    return result

"""How low the flanks of a sound side lie in their mean because they are bowed, by less than is named.

Beside a side that is worn throughout the pose has the sound flanks on the line in their mean. A gear that was cut bulging, along the face or the profile, is
as drawn at the middle and low all round it; so what the sound flanks lie low in their mean the worn ones are turned low as well.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.clustered import fit_by_teeth
from gearwear.diagnose.effects.base import helix_place, profile_coordinate
from gearwear.diagnose.fit import Fit, Model


def bow_of_sound(fit: Fit, model: Model, worn: frozenset[Side]) -> float:
    """By how much the sound flanks lie lower or higher in their mean than at their middle beside a model, mm; 0 of no sound side, or of no more than chance.

    Parameters
    ----------
    fit : Fit
    model : Model
        What is told; of its effects nothing is asked.
    worn : frozenset of Side
        Sides worn throughout.

    Notes
    -----
    All sound flanks together are fitted by ``a + b u + c u² + d v + e v²`` (u along the profile, v along the face, −1 … 1); the mean of ``c u² + e v²`` over
    the flank is what the bows make it lie off. Its variance (`fit_by_teeth`) is taken off its square: what chance makes of flanks without a bow is none.
    """
    points = fit.cells.points
    flank = (points.surface == FLANK) & fit.cells.seen & ~np.isin(points.side, [int(side) for side in worn])
    used = flank & fit.use
    fitted = fit_by_teeth(_design(fit, used), fit.weight[used], fit.residual(model)[used], points.tooth[used])
    if fitted is None:
        return 0.0
    sizes, spread = fitted
    mean = _design(fit, flank).mean(axis=0) * np.array([0.0, 0.0, 1.0, 0.0, 1.0])[: len(sizes)]
    low, variance = float(mean @ sizes), float(mean @ spread @ mean)
    return math.sqrt(max(low**2 - variance, 0.0))


def _design(fit: Fit, which: Bools) -> Floats:
    """(n, 5) of some cells, (n, 3) of a planar section."""
    points, gear = fit.cells.points.take(which), fit.cells.grid.gear
    u = profile_coordinate(points, gear)
    columns = [np.ones(len(u)), u, u**2]
    if fit.cells.grid.rows > 1:
        v = 2.0 * helix_place(points, gear)
        columns += [v, v**2]
    return np.column_stack(columns)

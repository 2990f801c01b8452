"""How far the flanks of a side that is worn throughout were made apart: by pitch and thickness errors that nothing else shows where it is worn.

What a flank of such a side lost is counted from where all flanks of the side stood on average. Where nothing slides sliding takes nothing: how the flanks
stand off one another at the pitch point, and by no share of what they lost, is how they were made.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import chdtri

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import CellGrid
from gearwear.placing.side_maps import SideMaps
from gearwear.robust import median_scale
from gearwear.wear.uncertainty import CellErrors
from gearwear.wear.weights import SideWeights

ALARM = 0.05
"""Chance that what noise and texture scatter is taken for flanks made apart."""
FEWEST_FLANKS = 6
"""Flanks from which on what they have apart is a scatter."""
ABOUT = 1
"""Columns of cells on either side of the pitch point that are taken with it."""
MOST_SHARE = 0.9
"""Share of the mean loss that may be lost at the pitch point too and be told from how the flanks were made; of more, all is taken for made."""


def made_apart(known: CellErrors, sheets: SideMaps, grid: CellGrid, loop: Loop) -> Floats:
    """Standard deviation of how high each flank of a side worn throughout stood as it was made, about the mean of its side.

    Parameters
    ----------
    known : CellErrors
        What scatters by noise, texture and the model, which is none of it.
    sheets : SideMaps
        Deviations from the as-made gear.
    grid : CellGrid
    loop : Loop

    Returns
    -------
    (2,) float
        mm, left and right; 0 where the side is not worn throughout, or a scan before wear tells how each flank was made.

    Notes
    -----
    A flank that lost w (1 + s) on average and q w (1 + s) at the pitch point, and was made m too high, stands m off there and m off in the mean besides: both
    together give m, for any share s of its own. Where wear is as deep there as elsewhere (q near 1), they do not, and m is no more than the flanks'
    losses differ.
    """
    result = np.zeros(len(Side))
    if loop.made is None:
        return result
    about = int(grid.flank_column(loop.context.pitch_roll)) + sheets.fillet
    columns = slice(max(about - ABOUT, sheets.fillet), about + ABOUT + 1)
    for side in loop.worn_sides:
        seen = sheets.seen[:, side.index]
        there, whole = (np.where(seen[..., part], 1.0, 0.0) for part in (columns, slice(sheets.fillet, None)))
        some = (there.sum(axis=(1, 2)) > 0) & (whole.sum(axis=(1, 2)) > 0)
        if some.sum() < FEWEST_FLANKS:
            continue
        where = np.column_stack([np.flatnonzero(some), np.full(some.sum(), side.index)])
        weights = np.zeros((2, len(where), *seen.shape[1:]))
        for weight, part, cells in zip(weights, (columns, slice(sheets.fillet, None)), (there, whole), strict=True):
            weight[..., part] = cells[some] / cells[some].sum(axis=(1, 2), keepdims=True)
        deviation = np.where(seen, sheets.deviation[:, side.index], 0.0)[some]
        at_pitch_point, mean = (weights * deviation).sum(axis=(2, 3))
        share = float(np.clip(at_pitch_point.mean() / min(mean.mean(), -1e-12), 0.0, MOST_SHARE))
        apart = (weights[0] - share * weights[1]) / (1.0 - share)
        made = (at_pitch_point - share * mean) / (1.0 - share)
        chance = float(np.diag(known.covariance_of(SideWeights(where, apart, {}, {}))).mean())
        scatter, free = min(median_scale(made)[1], median_scale(mean)[1]), len(where) - 1
        if scatter**2 > chance * chdtri(free, ALARM) / free:
            result[side.index] = math.sqrt(scatter**2 - chance)
    return result

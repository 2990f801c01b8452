"""Whether flanks of one side differ more from each other than those of the other side: as they were cut all differ."""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri, fdtri

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.diagnose.rules import rules


def differ_more(left: Floats, weight: Floats, shape: Floats, side: Side) -> bool:
    """Whether flanks of a side differ more in some shape than those of the other do.

    Parameters
    ----------
    left, weight : (teeth, 2, cells) float
        What a model leaves of the flanks, mm, and how far it is believed, 1 / mm²; left flanks first.
    shape : (cells,) float
        The same on all flanks.
    side : Side

    Notes
    -----
    How much of the shape a flank has stands beside a level of its own, and with the slope it was cut with. Where the other side's flanks are alike but
    for noise (χ²) what this side's differ in is enough; else the variances of both sides are compared (F): noise and what a maker leaves are in both.
    """
    design = np.column_stack([np.ones(len(shape)), shape])
    information = np.einsum("tsc,ci,cj->tsij", weight, design, design)
    moment = np.einsum("tsc,ci->tsi", weight * left, design)
    inverse = np.linalg.pinv(information, rcond=1e-9, hermitian=True)
    spread, by_noise = (inverse @ moment[..., None])[..., 1, 0].var(axis=0, ddof=1), np.median(inverse[..., 1, 1], axis=0)
    own, other, freedom, p = side.index, side.opposite.index, len(left) - 1.0, rules().significance
    if spread[other] < by_noise[other] * float(chdtri(freedom, p)) / freedom:
        return True
    return bool(spread[own] > float(fdtri(freedom, freedom, 1.0 - p)) * spread[other])

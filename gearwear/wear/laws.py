"""Which law the worn depth follows: sliding (Archard) and uniform loss, fitted to the worn regions of one side."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.profiles import SIGN
from gearwear.diagnose.effects.base import Context
from gearwear.measure.cells import CellGrid
from gearwear.measure.robust import median_scale
from gearwear.wear.regions import Wear

LEAST_TEETH = 3
OUTLYING = 3.5
"""Robust standard deviations from the other teeth's mean depth at which a tooth is worn by something else as well."""
ALIKE = 0.1
"""Least standard deviation of the teeth's mean depths that is taken for granted, as a share of their median."""
EXPLAINED = 0.5
"""Least share of the mean square depth that laws must explain to be reported."""
NODES = 16
"""Places in a column over which a law is averaged."""


@dataclass(frozen=True, slots=True)
class FittedLaw:
    """A wear law on the worn flanks of one side.

    Parameters
    ----------
    name : str
        "sliding_wear" or "abrasive_wear".
    side : int
        +1 left, −1 right.
    depth, std : float
        mm: at the form circle for sliding wear, everywhere for abrasive wear; standard deviation from tooth to tooth.
    rms_before, rms_after : float
        Of the depth in the worn regions of that side, mm; before the laws, and after all laws of the side together.
    """

    name: str
    side: int
    depth: float
    std: float
    rms_before: float
    rms_after: float


def fit_laws(wear: Wear, grid: CellGrid, context: Context) -> tuple[FittedLaw, ...]:
    """Fit d = A |K(L)| / |K(L_form)| + B, A and B not negative, to the flanks of each side that are worn alike on several teeth.

    A law is reported only where both together explain more than half of the mean square depth; a patch on one tooth follows none.
    """
    found: list[FittedLaw] = []
    for half, side in enumerate(SIGN):
        # Not the cells that were filled from those round them: near the form circle these are less deep.
        depth, mask = wear.depth[:, half, :, -grid.flank :], (wear.mask & wear.sheets.seen)[:, half, :, -grid.flank :]
        teeth = alike_teeth(wear, half)
        if len(teeth) < LEAST_TEETH:
            continue
        mask = mask & np.isin(np.arange(len(mask)), teeth)[:, None, None]
        sliding = _sliding(grid, context, depth, mask)
        columns = np.column_stack([sliding, np.ones_like(sliding)])
        every = np.array([_amplitudes(columns, depth[k], mask[k]) for k in teeth])
        rows = np.broadcast_to(np.arange(grid.flank), mask.shape)[mask]
        values = depth[mask]
        whole = nnls(columns[rows], values)[0]
        before = float(np.sqrt(np.mean(values**2)))
        after = float(np.sqrt(np.mean((values - columns[rows] @ whole) ** 2)))
        if after**2 > (1.0 - EXPLAINED) * before**2:
            continue
        std = every.std(axis=0, ddof=1) / math.sqrt(len(teeth))
        for i, name in enumerate(("sliding_wear", "abrasive_wear")):
            if whole[i] > 2.0 * std[i] and whole[i] > 0.0:
                found.append(FittedLaw(name, side, float(whole[i]), float(std[i]), before, after))
    return tuple(found)


def _sliding(grid: CellGrid, context: Context, depth: Floats, mask: Bools) -> Floats:
    """|K(L)| / |K(L_form)| as the cells of each column show it, (columns,).

    Near the form circle K doubles within a column: it is averaged over the column, which is of equal weight in L² at the points' own radius.
    A point of the worn flank stands for the foot above it, further up by the depth.
    """
    gear = grid.gear
    own = np.sqrt(np.linspace(gear.form_roll**2, gear.tip_roll**2, 2 * NODES * grid.flank + 1)[1::2]).reshape(grid.flank, NODES)
    number = mask.sum(axis=(0, 1))
    lost = np.where(mask, depth, 0.0).sum(axis=(0, 1)) / np.maximum(number, 1)
    share = np.abs(context.sliding((own + np.maximum(lost, 0.0)[:, None]).ravel())).reshape(own.shape)
    return np.asarray(share.mean(axis=1) / abs(float(context.sliding(np.array([gear.form_roll]))[0])), dtype=np.float64)


def worn_teeth(wear: Wear, half: int) -> Ints:
    """The teeth (0-based) with wear that was seen on their flank of one side, 0 left or 1 right."""
    flank = (wear.mask & wear.sheets.seen)[:, half, :, wear.sheets.fillet :]
    return np.asarray(np.flatnonzero(flank.any(axis=(1, 2))), dtype=np.int64)


def alike_teeth(wear: Wear, half: int) -> Ints:
    """The teeth (0-based) whose flanks of one side (0 left, 1 right) are worn, and lost about as much as one another.

    A patch on one of them follows no law and would swamp the mean: teeth are left out whose mean depth lies more than 3.5 robust standard
    deviations from the median of all, and at least about a third of it.
    """
    worn, sheets = worn_teeth(wear, half), wear.sheets
    if len(worn) < LEAST_TEETH:
        return worn
    lost = -np.nanmean(np.where(sheets.seen, sheets.deviation, np.nan)[worn, half][..., sheets.fillet :], axis=(1, 2))
    middle, spread = median_scale(lost)
    return np.asarray(worn[np.abs(lost - middle) <= OUTLYING * max(spread, ALIKE * abs(middle))], dtype=np.int64)


def _amplitudes(columns: Floats, depth: Floats, mask: Floats) -> Floats:
    rows = np.broadcast_to(np.arange(columns.shape[0]), mask.shape)[mask]
    return np.asarray(nnls(columns[rows], depth[mask])[0], dtype=np.float64)

"""Which teeth a wear law can be asked of, and what one says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Ints
from gearwear.design.side import Side
from gearwear.placing.robust import median_scale
from gearwear.wear.regions import Wear

LEAST_TEETH = 3
OUTLYING = 3.5
"""Robust standard deviations from the other teeth's mean depth at which a tooth is worn by something else as well."""
ALIKE = 0.1
"""Least standard deviation of the teeth's mean depths that is taken for granted, as a share of their median."""


@dataclass(frozen=True, slots=True)
class FittedLaw:
    """A wear law on the worn flanks of one side.

    Parameters
    ----------
    name : str
        "sliding_wear" or "abrasive_wear".
    side : Side
    depth, std : float
        mm: at the form circle for sliding wear, everywhere for abrasive wear; and its standard deviation.
    rms_before, rms_after : float
        Of the depth in the worn regions of that side, mm; before the laws, and after all laws of the side together.
    """

    name: str
    side: Side
    depth: float
    std: float
    rms_before: float
    rms_after: float


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

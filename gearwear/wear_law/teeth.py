"""Which teeth a wear law can be asked of, and what one says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.side import Side
from gearwear.robust import median_scale
from gearwear.wear.regions import Wear

LEAST_TEETH = 3
OUTLIER_LIMIT_STDS = 3.5
"""Robust standard deviations from the other teeth's mean depth at which a tooth is worn by something else as well."""
LEAST_RELATIVE_SPREAD = 0.1
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
    flank = (wear.mask & wear.side_maps.seen)[:, half, :, wear.side_maps.fillet :]
    return np.asarray(np.flatnonzero(flank.any(axis=(1, 2))), dtype=np.int64)


def alike_teeth(wear: Wear, half: int) -> Ints:
    """The teeth (0-based) whose flanks of one side (0 left, 1 right) are worn, and lost about as much as one another.

    A patch on one of them follows no law and would swamp the mean: teeth are left out whose mean depth lies more than 3.5 robust standard
    deviations from the median of all, and at least about a third of it.
    """
    worn, side_maps = worn_teeth(wear, half), wear.side_maps
    if len(worn) < LEAST_TEETH:
        return worn
    lost = -np.nanmean(np.where(side_maps.seen, side_maps.deviation, np.nan)[worn, half][..., side_maps.fillet :], axis=(1, 2))
    middle, spread = median_scale(lost)
    return np.asarray(
        worn[np.abs(lost - middle) <= OUTLIER_LIMIT_STDS * max(spread, LEAST_RELATIVE_SPREAD * abs(middle))], dtype=np.int64
    )


def in_proportion(depth: Floats) -> Floats:
    """Depths of some teeth (k, ...) with their gaps, nan, filled from the mean of the others, each in its own proportion; 0 where none was seen."""
    known, places = np.isfinite(depth), tuple(range(1, depth.ndim))
    filled = np.where(known, depth, 0.0)
    mean = filled.sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    lost, usual = filled.sum(axis=places, keepdims=True), np.where(known, mean, 0.0).sum(axis=places, keepdims=True)
    share = np.where(usual > 0.0, lost / np.where(usual > 0.0, usual, 1.0), 1.0)
    return np.where(known, depth, share * mean)

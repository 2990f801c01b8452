"""Robust location, scale and weights."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats

TUKEY = 4.685
"""95 % efficiency on normal data (Huber & Ronchetti 2009)."""


def median_scale(values: Floats) -> tuple[float, float]:
    """Median and 1.4826 × median absolute deviation of the finite values; nan where there is none."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return float("nan"), float("nan")
    centre = float(np.median(finite))
    return centre, 1.4826 * float(np.median(np.abs(finite - centre)))


def tukey_weight(residual: Floats, scale: float) -> Floats:
    """Tukey's biweight (1 − (r / 4.685 s)²)², 0 outside; 0 where the residual is not finite."""
    ratio = residual / (TUKEY * scale)
    inside = np.abs(ratio) < 1.0  # False for nan
    weight: Floats = np.where(inside, (1.0 - np.where(inside, ratio, 0.0) ** 2) ** 2, 0.0)
    return weight


def tukey_slope(residual: Floats, scale: float) -> Floats:
    """Derivative of ψ(r) = r · weight: (1 − u²)(1 − 5 u²) with u = r / 4.685 s, 0 outside; negative where a point is losing its say."""
    square = np.minimum((residual / (TUKEY * scale)) ** 2, 1.0)
    return np.asarray(np.where(np.isfinite(square), (1.0 - square) * (1.0 - 5.0 * square), 0.0))

"""Robust location, scale and weights."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats

TUKEY = 4.685
"""95 % efficiency on normal data (Huber & Ronchetti 2009)."""


NORMAL_MAD = 1.4826
"""Standard deviation per median absolute deviation of normal data: 1 / Φ⁻¹(3/4)."""


def scale_about(values: Floats, centre: float = 0.0) -> float:
    """1.4826 × median absolute deviation of the finite values from `centre`; nan where there is none."""
    finite = values[np.isfinite(values)]
    return NORMAL_MAD * float(np.median(np.abs(finite - centre))) if len(finite) else float("nan")


def median_scale(values: Floats) -> tuple[float, float]:
    """Median of the finite values and their scale about it; nan where there is none."""
    finite = values[np.isfinite(values)]
    centre = float(np.median(finite)) if len(finite) else float("nan")
    return centre, scale_about(finite, centre)


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

"""Robust location, scale and weights, and a sample that hangs on no order."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats

TUKEY, HUBER = 4.685, 1.345
"""95 % efficiency on normal data (Huber & Ronchetti 2009)."""


NORMAL_MAD = 1.4826
"""Standard deviation per median absolute deviation of normal data: 1 / Φ⁻¹(3/4)."""


def median(values: Floats) -> float:
    """Median of finite values (n,), the same as numpy's; nan of none.

    From the one value that `np.partition` puts in its place: with three of them, as `np.median` asks for, it takes several times as long.

    >>> median(np.array([3.0, 1.0, 2.0])), median(np.array([4.0, 1.0, 2.0, 3.0]))
    (2.0, 2.5)
    """
    half = len(values) // 2
    if not len(values):
        return float("nan")
    ordered = np.partition(values, half)
    return float(ordered[half] if len(values) % 2 else 0.5 * (ordered[:half].max() + ordered[half]))


def scale_about(values: Floats, centre: float = 0.0) -> float:
    """1.4826 × median absolute deviation of the finite values from `centre`; nan where there is none."""
    finite = values[np.isfinite(values)]
    return NORMAL_MAD * median(np.abs(finite - centre)) if len(finite) else float("nan")


def median_scale(values: Floats) -> tuple[float, float]:
    """Median of the finite values and their scale about it; nan where there is none."""
    finite = values[np.isfinite(values)]
    centre = median(finite)
    return centre, scale_about(finite, centre)


def tukey_weight(residual: Floats, scale: float) -> Floats:
    """Tukey's biweight (1 − (r / 4.685 s)²)², 0 outside; 0 where the residual is not finite."""
    ratio = residual / (TUKEY * scale)
    inside = np.abs(ratio) < 1.0  # False for nan
    weight: Floats = np.where(inside, (1.0 - np.where(inside, ratio, 0.0) ** 2) ** 2, 0.0)
    return weight


def huber_weight(residual: Floats, scale: float) -> Floats:
    """Huber's weight, 1 as far as 1.345 s and 1.345 s / |r| beyond: convex, so that what it finds hangs on no start."""
    return np.asarray(1.0 / np.maximum(np.abs(residual) / (HUBER * max(scale, 1e-300)), 1.0))


def tukey_slope(residual: Floats, scale: float) -> Floats:
    """Derivative of ψ(r) = r · weight: (1 − u²)(1 − 5 u²) with u = r / 4.685 s, 0 outside; negative where a point is losing its say."""
    square = np.minimum((residual / (TUKEY * scale)) ** 2, 1.0)
    return np.asarray(np.where(np.isfinite(square), (1.0 - square) * (1.0 - 5.0 * square), 0.0))


SHARES = (0.7548776662466927, 0.5698402909980532)
"""1 / p and 1 / p² of the plastic number p: multiples of both fill the unit square most evenly (Roberts 2018)."""


GRAIN = 0.02
"""About how far apart the lines of `some_of` lie, in modules: as far as points do, so that it hardly matters how exactly their places are known."""


def evenly_drawn(first: Floats, second: Floats, grain: float = GRAIN) -> Floats:
    """(n,) numbers from 0 to 1 for points by two lengths, in modules, that say where each lies on the part, in whatever order they come; over a `grain`
    far below their scatter they are as if drawn."""
    turn = (SHARES[0] * first + SHARES[1] * second) / grain
    return np.asarray(turn - np.floor(turn), dtype=np.float64)


def some_of(first: Floats, second: Floats, most: int) -> Bools:
    """(n,) about `most` of many points, those near lines across the plane of both lengths; parameters as `evenly_drawn`.

    >>> x = np.random.default_rng(0).normal(size=(2, 1000))
    >>> kept, back = some_of(*x, 200), some_of(*x[:, ::-1], 200)
    >>> bool((kept == back[::-1]).all()), 150 < int(kept.sum()) < 250
    (True, True)
    """
    return np.asarray(evenly_drawn(first, second) < most / max(len(first), 1))

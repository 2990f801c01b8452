"""A measured number with what the scan's noise does to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from gearwear.arrays import Bools, Floats

COVERAGE_FACTOR = 2.0
"""k of the expanded uncertainty (about 95 %)."""

RESOLVABLE_SHARE = 0.3
"""A deviation is not graded where U is more than this share of the tolerance."""

DRAWS = 128
"""Repetitions with simulated noise behind the uncertainty of a maximum or a range."""

_EIGHTHS = ndtri((np.arange(8) + 0.5) / 8.0)
STEPS = _EIGHTHS / _EIGHTHS.std()
"""Eight equally likely sizes of a normal cause, of variance 1."""

LUCK = 1.5
"""Standard deviations by which a measured range may lie above its mean; with it U covers 96 to 100 % (docs/inspection.md)."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Values with their uncertainty from the scan.

    Parameters
    ----------
    value : (...) float
        As the standard defines it, on the trace as measured; nan where not seen.
    standard : (...) float
        Standard uncertainty u.
    noise : (...) float
        The most that the scan's noise may have added to `value`: a range or a greatest value of noisy numbers is too
        large on average. 0 for slopes, means and single deviations.
    shared : (..., m) float or None
        The part of the errors that the values have in common, per standard deviation of each of its m causes (the six motions of
        the registration); it is in `standard`. None: nothing in common.
    """

    value: Floats
    standard: Floats
    noise: Floats
    shared: Floats | None = None

    @property
    def own(self) -> Floats:
        """The part of `standard` that each value has for itself."""
        if self.shared is None:
            return self.standard
        return np.asarray(np.sqrt(np.maximum(self.standard**2 - (self.shared**2).sum(axis=-1), 0.0)))

    @property
    def expanded(self) -> Floats:
        """U = 2 u + |noise|: what noise may have added is not taken off, so it is added whole (coverage: docs/inspection.md)."""
        return np.asarray(COVERAGE_FACTOR * self.standard + np.abs(self.noise))

    def at(self, *index: int) -> Estimate:
        """One entry, or one row."""
        shared = None if self.shared is None else np.asarray(self.shared[index])
        value, standard, noise = (np.asarray(part[index]) for part in (self.value, self.standard, self.noise))
        return Estimate(value, standard, noise, shared)

    def where(self, mine: Bools, other: Estimate) -> Estimate:
        """These values where `mine`, the other's elsewhere."""
        value, standard, noise = (np.where(mine, getattr(self, n), getattr(other, n)) for n in ("value", "standard", "noise"))
        shared = None
        if self.shared is not None and other.shared is not None:
            shared = np.where(mine[..., None], self.shared, other.shared)
        return Estimate(value, standard, noise, shared)

    @classmethod
    def plain(cls, value: Floats, own: Floats, shared: Floats | None = None) -> Estimate:
        """Without bias from noise; `own` and `shared` as the fields of these names."""
        value = np.asarray(value, dtype=np.float64)
        total = np.asarray(own, dtype=np.float64)
        if shared is not None:
            total = np.sqrt(total**2 + (shared**2).sum(axis=-1))
        return cls(value, total, np.where(np.isnan(value), np.nan, 0.0), shared)

    @classmethod
    def empty(cls, shape: tuple[int, ...]) -> Estimate:
        """Nothing seen."""
        return cls(np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan))


def simulated(values: Floats, own: Floats, common: Floats | None = None) -> Floats:
    """(`DRAWS`, n) simulated errors of values round a gear. They hang on the values: which is called the first, which way they are counted and which way
    is up does not matter.

    Parameters
    ----------
    values : (n,) float
        Measured.
    own : (n,) float
        Standard uncertainty that each has for itself.
    common : (n, m) float or None
        What one standard deviation of each cause adds that the values share; None: nothing.
    """
    random = np.random.default_rng(0)
    size = np.abs(np.nan_to_num(values))
    rank, up = np.argsort(np.argsort(size)), 1.0 if values[int(np.argmax(size))] >= 0.0 else -1.0
    errors = random.standard_normal((DRAWS, len(values)))[:, rank] * (up * own)
    if common is not None:
        errors = errors + random.standard_normal((DRAWS, common.shape[-1])) @ with_sign_of(values, common).T
    return np.asarray(errors, dtype=np.float64)


def with_sign_of(values: Floats, common: Floats) -> Floats:
    """What causes add to values (…), (…, m), each with the sign that makes it go with them: a cause has none of its own."""
    along = np.nansum(values[..., None] * common, axis=tuple(range(values.ndim)))
    return np.asarray(common * np.where(along < 0.0, -1.0, 1.0))


def first_end(values: Floats) -> int:
    """1 where values (n, …) go further off in the first half of their first axis than in the second, else −1: from which end they are counted."""
    square = np.nan_to_num(values) ** 2
    half = len(values) // 2
    return 1 if float(square[:half].sum()) >= float(square[len(values) - half :].sum()) else -1


def of_statistic(statistic: Callable[[Floats], Floats], values: Floats, errors: Floats) -> Estimate:
    """Estimate of a statistic that noise biases upwards, such as max − min.

    Parameters
    ----------
    statistic : callable
        (d, n) → (d,), a seminorm: convex, and twice the values give twice the result.
    values : (n,) float
        Measured values.
    errors : (d, n) float
        Simulated errors of those values.

    Returns
    -------
    Estimate
        Of shape (). u is the standard deviation of the statistic when the errors are added once more; the noise is what the errors alone
        would read, that is what a perfect part would show.

    Notes
    -----
    For a seminorm the triangle inequality bounds the mean bias: it is at most the mean reading of the errors alone. It is also at most
    1 + sqrt(2) times what the errors add when they are added once more, for a mean reading is convex in the size t of the errors, which goes
    from 1 to sqrt(2) then (slope from 0 to 1 ≤ slope from 1 to sqrt(2)); `LUCK` standard deviations are for the value's own chance. The
    smaller bound counts: the first where the shape is flat, the second where its extremes stand out of the noise.

    >>> rng = np.random.default_rng(1)
    >>> flat = of_statistic(lambda y: np.ptp(y, axis=-1), rng.normal(size=50), rng.normal(size=(200, 50)))
    >>> bool(flat.expanded > flat.value)  # nothing but noise
    True
    """
    measured = float(statistic(values[None])[0])
    again = statistic(values[None] + errors)
    alone = float(statistic(errors).mean())
    most = (1.0 + math.sqrt(2.0)) * max(0.0, float(again.mean()) - measured) + LUCK * float(again.std())
    return Estimate(np.array(measured), np.array(again.std()), np.array(min(measured, alone, most)))


def of_causes(statistic: Callable[[Floats], Floats], values: Floats, errors: Floats, moved: Floats | None) -> Estimate:
    """`of_statistic`, with its uncertainty split by the causes that the values have in common.

    Parameters
    ----------
    statistic, values, errors
        As `of_statistic` takes them; the errors hold all causes.
    moved : (n, m) float or None
        What one standard deviation of each common cause adds to the values; None: nothing in common.

    Returns
    -------
    Estimate
        `shared` is the standard deviation of the statistic under each cause alone, without sign, and together at most the whole uncertainty,
        which the draws tell. A cause acts on a range by its size where the values are flat, so no slope would do.
    """
    whole = of_statistic(statistic, values, errors)
    if moved is None:
        return whole
    alone = values + (STEPS[:, None, None] * moved.T).reshape(-1, len(values))
    shared = statistic(alone).reshape(len(STEPS), -1).std(axis=0)
    size = float(np.linalg.norm(shared))
    if size > whole.standard:
        shared = shared * (float(whole.standard) / size)
    return replace(whole, shared=shared)

"""A measured number with what the scan's noise does to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats

COVERAGE_FACTOR = 2.0
"""k of the expanded uncertainty (about 95 %)."""

RESOLVABLE_SHARE = 0.3
"""A deviation is not graded where U is more than this share of the tolerance."""

DRAWS = 128
"""Repetitions with simulated noise behind the uncertainty of a maximum or a range."""


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
    """

    value: Floats
    standard: Floats
    noise: Floats

    @property
    def expanded(self) -> Floats:
        """U = 2 u + |noise|: what noise may have added is not taken off, so it is added whole (coverage: docs/inspection.md)."""
        return np.asarray(COVERAGE_FACTOR * self.standard + np.abs(self.noise))

    def at(self, *index: int) -> Estimate:
        """One entry, or one row."""
        return Estimate(*(np.asarray(part[index]) for part in (self.value, self.standard, self.noise)))

    @classmethod
    def plain(cls, value: Floats, standard: Floats) -> Estimate:
        """Without bias from noise."""
        value = np.asarray(value, dtype=np.float64)
        return cls(value, np.asarray(standard, dtype=np.float64), np.where(np.isnan(value), np.nan, 0.0))

    @classmethod
    def empty(cls, shape: tuple[int, ...]) -> Estimate:
        """Nothing seen."""
        return cls(np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan))


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
    found = float(statistic(values[None])[0])
    again = statistic(values[None] + errors)
    alone = float(statistic(errors).mean())
    most = (1.0 + math.sqrt(2.0)) * max(0.0, float(again.mean()) - found) + LUCK * float(again.std())
    return Estimate(np.array(found), np.array(again.std()), np.array(min(found, alone, most)))

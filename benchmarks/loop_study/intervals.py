"""Intervals of rates."""

from __future__ import annotations

from dataclasses import dataclass

from scipy import stats


@dataclass(frozen=True, slots=True)
class Rate:
    """k of n, with the exact (Clopper-Pearson) 95 % interval.

    >>> Rate(0, 36)
    Rate(count=0, of=36)
    >>> f"{Rate(0, 36).high:.4f}"
    '0.0974'
    """

    count: int
    of: int

    @property
    def value(self) -> float:
        return self.count / self.of if self.of else float("nan")

    @property
    def low(self) -> float:
        return float(stats.beta.ppf(0.025, self.count, self.of - self.count + 1)) if self.count else 0.0

    @property
    def high(self) -> float:
        return float(stats.beta.ppf(0.975, self.count + 1, self.of - self.count)) if self.count < self.of else 1.0

    def __str__(self) -> str:
        if not self.of:
            return "none"
        return f"{100 * self.value:.1f} % ({self.count} of {self.of}; {100 * self.low:.1f} … {100 * self.high:.1f})"

"""Which of many findings are significant, with what is to be expected from chance alone taken into account."""

from __future__ import annotations

import math
from collections.abc import Sequence

from scipy.special import ndtr, stdtr

LEVEL = 0.05
"""Share of chance findings that is borne: of those that are called significant, or of the whole family."""


def two_sided(statistic: float, degrees: float = math.inf) -> float:
    """Chance of a value as far from 0: of a normal deviate, or of Student's t.

    >>> round(two_sided(1.959964), 4), round(two_sided(12.7062, 1), 4)
    (0.05, 0.05)
    """
    if math.isnan(statistic):
        return math.nan
    below = ndtr(-abs(statistic)) if math.isinf(degrees) else stdtr(degrees, -abs(statistic))
    return 2.0 * float(below)


def discoveries(p_values: Sequence[float]) -> list[bool]:
    """Which are significant, so that at most a share `LEVEL` of them is chance (Benjamini and Hochberg 1995); nan never is.

    >>> discoveries([0.01, 0.02, 0.04, 0.2, math.nan])
    [True, True, False, False, False]
    """
    known = sorted(p for p in p_values if not math.isnan(p))
    limit = max((p for i, p in enumerate(known, 1) if p <= LEVEL * i / len(known)), default=-1.0)
    return [p <= limit for p in p_values]


def beyond_chance(p_values: Sequence[float], level: float = LEVEL) -> list[bool]:
    """Which are significant, so that the chance of any false one is at most `level` (Holm 1979); nan never is.

    >>> beyond_chance([0.01, 0.02, 0.04, 0.2])
    [True, False, False, False]
    """
    order = sorted((p, i) for i, p in enumerate(p_values) if not math.isnan(p))
    significant = [False] * len(p_values)
    for rank, (p, i) in enumerate(order):
        if p > level / (len(order) - rank):
            break
        significant[i] = True
    return significant

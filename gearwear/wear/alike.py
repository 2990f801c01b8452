"""Depths of flanks that wore alike: each known better by what the others of its side show.

The deepest place of a flank is of few cells. Of a side worn throughout the deepest of many is the one that chance made deepest; but flanks that rolled against
the same mate go as much deeper than their mean as the others do.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.robust import scale_about

FEWEST = 6
"""Flanks from which on they tell what they have in common."""
APART = 3.0
"""Own standard deviations beyond which a flank has a place of its own, deeper than what all have, and is left as it is."""


def alike(depth: Floats, own_std: Floats, mean: Floats, mean_std: Floats, apart: float = 0.0) -> tuple[Floats, Floats]:
    """Expected greatest depths, and their standard deviations without what all flanks have in common.

    Parameters
    ----------
    depth, own_std : (n,) float
        As each flank shows it by itself, and how well, mm.
    mean, mean_std : (n,) float
        Mean depth of the flanks, and how well it is known, mm.
    apart : float
        Standard deviation of the level of each flank, mm, which is in its depth and in its mean alike: in `mean_std`, and not in `own_std`.

    Notes
    -----
    Empirical Bayes (Efron and Morris 1975): greatest depths are N(R mean, τ²) with R and τ² as the flanks show them; what a flank shows beyond R mean counts
    with τ² / (τ² + s²). That τ² is known from n flanks alone is in the result (Morris 1983).
    """
    known = np.isfinite(depth) & np.isfinite(own_std) & (own_std > 0.0) & (mean > 0.0)
    value, std = depth.copy(), own_std.copy()
    if known.sum() < FEWEST:
        return value, np.hypot(std, apart)
    middle = float(np.median(depth[known] / mean[known]))
    beyond = depth - middle * mean
    spread = max(scale_about(beyond[known]) ** 2 - float(np.median(own_std[known] ** 2)), 0.0)
    among = known & (np.abs(beyond) < APART * np.sqrt(spread + own_std**2))
    if among.sum() < FEWEST:
        return value, np.hypot(std, apart)
    weight = np.where(among, 1.0 / (spread + np.maximum(own_std, 1e-12) ** 2), 0.0)
    information = float(weight @ mean**2)
    ratio = float(weight @ (depth * mean)) / information
    share = spread / (spread + own_std[among] ** 2)
    more = (depth - ratio * mean)[among]
    value[among] = ratio * mean[among] + share * more
    by_level = share * apart + (1.0 - share) * ratio * mean_std[among]
    std = np.hypot(std, apart)
    unknown = mean[among] ** 2 / information + 2.0 * more**2 / (among.sum() - 3)
    std[among] = np.sqrt(share * own_std[among] ** 2 + (1.0 - share) ** 2 * unknown + by_level**2)
    # A place of its own that does not stand out is half of it in doubt.
    std[among] = np.maximum(std[among], 0.5 * np.abs((1.0 - share) * more))
    return value, std

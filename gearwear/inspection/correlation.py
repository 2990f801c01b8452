"""How many points carry the information of one independent point, from the scan itself.

Texture, a coat's grain and a scanner's own waves hang together over a millimetre or more: a mean of a thousand such points is less sure
than of a thousand independent ones. Means of equal cells of a flank tell by how much: what they leave beside a profile form, a helix form
and a twist has the variance of their points' noise where the points are independent, and more where they are not.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.inspection.traces import Area, FlankSamples, topography

SCALES = ((8, 12), (4, 6))
"""Cells per flank, along z and along L; the second have twice the size of the first."""

LEAST_POINTS = 3
"""Of a cell that counts."""

LEAST_SEEN = 0.7
"""Share of a flank's cells that must count."""

EVIDENCE = 3.0
"""Standard errors by which a correlation must stand out."""


def points_per_independent(samples: FlankSamples, noise: float, area: Area | None = None) -> float:
    """Points per independent point, 1 for white noise.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    noise : float
        Standard deviation of one point, mm.
    area : ((float, float), (float, float)) or None
        Part of the flanks that is looked at, L to L and z to z, mm: rounded edges are no texture. None: all.

    Returns
    -------
    float
        ≥ 1; 1 also where no correlation stands out, and for a planar section, whose texture cannot be told from its form.

    Notes
    -----
    The design effect of cluster sampling (Kish 1965): variance of cell means over that of as many independent points. It nears its
    value for wide cells as 1 / width, so what doubling the width added is added once more. The median flank of either side counts,
    or of the better side where they disagree: neither a worn side nor a few pitted teeth do. Waves longer than about an eighth of
    the flank are form to it.

    Examples
    --------
    >>> from gearwear.design import Gear, GearSpec
    >>> rng = np.random.default_rng(0)
    >>> n, gear = 50_000, Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> roll, z = rng.uniform(gear.form_roll, gear.tip_roll, n), rng.uniform(0.0, 15.0, n)
    >>> white = FlankSamples(gear, rng.integers(0, 24, n), roll, z, rng.normal(0.0, 0.01, n), 0.01, 0)
    >>> points_per_independent(white, 0.01)
    1.0
    """
    if samples.is_section or not noise > 0.0 or not len(samples):
        return 1.0
    fine, coarse = (_excess(samples, noise, scale, area) for scale in SCALES)
    sides = [_carried_on(narrow, wide) for narrow, wide in zip(fine, coarse, strict=True)]
    seen = [side for side in sides if math.isfinite(side[0])]
    if len(seen) == 2 and abs(seen[0][0] - seen[1][0]) <= EVIDENCE * math.hypot(seen[0][1], seen[1][1]):
        return max(1.0, 0.5 * (seen[0][0] + seen[1][0]))
    return max(1.0, min((side[0] for side in seen), default=1.0))


def _carried_on(narrow: tuple[float, float], wide: tuple[float, float]) -> tuple[float, float]:
    """The factor of wide enough cells and its standard error, from those of two sizes; 1 where neither stands out."""
    if not math.isfinite(narrow[0]) or not math.isfinite(wide[0]):
        return math.nan, math.nan
    if max((factor[0] - 1.0) / factor[1] for factor in (narrow, wide)) <= EVIDENCE:
        return 1.0, wide[1]
    return wide[0] + max(0.0, wide[0] - narrow[0]), 2.0 * wide[0] * wide[1]


def _excess(samples: FlankSamples, noise: float, scale: tuple[int, int], area: Area | None) -> list[tuple[float, float]]:
    """On either side, the median flank's variance of cell means over that of white noise, and its standard error if there is none."""
    cells = topography(samples, *scale, area)
    row, column = (index.ravel() for index in np.indices(scale))
    twist = (row - row.mean()) * (column - column.mean())
    base = np.column_stack([np.eye(scale[0])[row], np.eye(scale[1])[column, 1:], twist])
    freedom = len(row) - base.shape[1]
    excess = []
    for side in (0, 1):
        ratios = [
            _ratio(base, cells.deviation[tooth, side].ravel(), cells.count[tooth, side].ravel(), noise)
            for tooth in range(samples.gear.teeth)
        ]
        seen = [ratio for ratio in ratios if math.isfinite(ratio)]
        error = math.sqrt(0.5 * math.pi * 2.0 / (freedom * max(len(seen), 1)))
        excess.append((float(np.median(seen)) if seen else math.nan, error))
    return excess


def _ratio(base: Floats, mean: Floats, count: Ints, noise: float) -> float:
    """χ² per degree of freedom of one flank's cell means (k,) about `base` (k, p); nan where too few were seen."""
    use = count >= LEAST_POINTS
    if use.mean() < LEAST_SEEN:
        return math.nan
    root = np.sqrt(count[use]) / noise
    columns, y = base[use] * root[:, None], mean[use] * root
    solution, _, rank, _ = np.linalg.lstsq(columns, y, rcond=1e-9)
    return float(((y - columns @ solution) ** 2).sum() / max(int(use.sum()) - int(rank), 1))

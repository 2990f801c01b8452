"""The surface of every flank at one radius, section by section: lines along the profile, and parabolas along the face where points are few."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy import ndimage

from gearwear.arrays import Floats, Ints

LEAST_SPREAD = 0.05
"""Standard deviation of the points of a section along the profile, as a share of the window's half width, from which a slope is fitted."""
LEAST_POINTS = 3
ENOUGH_POINTS = 12
"""Points a side and section should have, twice what a straight line through them needs; where the scan is thinner, the band is widened and
neighbouring sections are pooled until they do."""
BENT_POINTS = 8
"""Points through which a parabola is laid, twice its unknowns; through fewer their mean, or a straight line along the profile."""
FEWEST_POINTS = 6
"""The same on a tooth that was seen less well than most."""


@dataclass(frozen=True, slots=True)
class SectionSurface:
    """What the points of the sections say of the surface at the middle of their band.

    Parameters
    ----------
    value, variance : (teeth, 2, n_z) float
        Deviation there, mm, and its variance in that of one point; nan where there are too few.
    count : (teeth, 2, n_z) float
        Points it is from.
    scatter, free : (teeth, 2, n_z) float
        Their variance about it, mm², and its degrees of freedom.
    bend : (teeth, 2, n_z) float
        What the value lies off the mean of the pooled sections for being that of a parabola, mm.
    pooled : int
        Neighbouring sections whose points each value is from, on most teeth; odd.
    pooled_on : (teeth,) int
        The same on each tooth.
    """

    value: Floats
    variance: Floats
    count: Floats
    scatter: Floats
    free: Floats
    bend: Floats
    pooled: int
    pooled_on: Ints


def surface_in_sections(
    x: Floats, y: Floats, cell: Ints, shape: tuple[int, int, int], half: float, stretches: Sequence[slice], bent: bool
) -> SectionSurface:
    """Fit every section.

    Parameters
    ----------
    x, y : (n,) float
        Length of roll of the points from the middle of the band, and their deviation, mm.
    cell : (n,) int
        Their section, an index into an array of `shape`.
    shape : (int, int, int)
        Teeth, sides, sections.
    half : float
        Half width of the band, mm of roll.
    stretches : sequence of slice
        Sections that belong together: no window reaches from one stretch into the next.
    bent : bool
        Whether the surface through pooled sections is a parabola along the face, of which their mean would show less than there is.

    Notes
    -----
    The straight line along the profile through the points of a section and as many neighbours as it takes to have enough; their mean where they
    do not spread along the profile.
    """
    size = math.prod(shape)
    sums: list[Floats] = [
        np.bincount(cell, w, minlength=size).reshape(shape).astype(np.float64)
        for w in (np.ones_like(x), x, y, x * x, x * y, y * y)
    ]
    pooled = _sections_to_pool(sums[0], stretches)
    on = _on_each(sums[0], pooled, stretches)
    value, variance, count, scatter, free = _through_points(sums, half)
    bend = np.zeros_like(value)
    parts = value, variance, count, scatter, free, bend
    for width, rows in product(np.unique(on[on > 1]), stretches):
        teeth = np.flatnonzero(on == width)
        part = _through_sections([values[teeth][:, :, rows] for values in sums], int(width), half, bent)
        for whole, own in zip(parts, part, strict=True):
            whole[teeth, :, rows] = own
    return SectionSurface(value, variance, count, scatter, free, bend, pooled, on)


def _through_points(sums: Sequence[Floats], half: float) -> tuple[Floats, ...]:
    """The straight line along the profile through the points of each section: value, its variance, number of points, variance about it, degrees of
    freedom."""
    n, sx, sy, sxx, sxy, syy = sums
    with np.errstate(invalid="ignore", divide="ignore"):
        mean_x, mean_y = sx / n, sy / n
        spread = sxx - n * mean_x**2
        sloped = (n >= 6) & (spread > n * (LEAST_SPREAD * half) ** 2)  # points of a regular grid may all lie at one radius
        slope = np.where(sloped, (sxy - n * mean_x * mean_y) / spread, 0.0)
        value = np.where(n >= LEAST_POINTS, mean_y - slope * mean_x, np.nan)
        variance = np.where(n >= LEAST_POINTS, 1.0 / n + np.where(sloped, mean_x**2 / spread, 0.0), np.nan)
        about = syy - n * mean_y**2 - slope * np.where(sloped, sxy - n * mean_x * mean_y, 0.0)
        free = n - np.where(sloped, 2.0, 1.0)
        scatter = np.where(n >= LEAST_POINTS, about / free, 0.0)
    return value, variance, n.copy(), scatter, free


def _through_sections(sums: Sequence[Floats], width: int, half: float, bent: bool) -> tuple[Floats, ...]:
    """The same through the points of `width` neighbouring sections; or with a parabola along the face: what a mean hides of a hollow, it shows
    (local polynomials, Fan and Gijbels 1996)."""
    if not bent:
        straight = _through_points([_running_sum(values, width) for values in sums], half)
        return *straight, np.zeros_like(straight[0])
    n, sx, sy, sxx, sxy, syy = sums
    reach = np.arange(-(width // 2), width // 2 + 1) / width  # of the window

    def along(values: Floats, power: int) -> Floats:
        return np.asarray(ndimage.correlate1d(values, reach**power, axis=-1, mode="constant"))

    zeros = [along(n, k) for k in range(5)]
    ones, own = [along(sx, k) for k in range(3)], [along(sy, k) for k in range(3)]
    squares, crossed, total = along(sxx, 0), along(sxy, 0), along(syy, 0)
    count = zeros[0]
    # Unknowns: value, along the face, its square, along the profile, each in parts of the window.
    order = [(0, 1, 2), (1, 2, 3), (2, 3, 4)]
    matrix = np.zeros((*count.shape, 4, 4))
    for row, powers in enumerate(order):
        for column, power in enumerate(powers):
            matrix[..., row, column] = zeros[power]
        matrix[..., row, 3] = matrix[..., 3, row] = ones[row] / half
    matrix[..., 3, 3] = squares / half**2
    right = np.stack([*own, crossed / half], axis=-1)
    inverse = np.linalg.pinv(matrix, rcond=1e-4, hermitian=True)
    fitted = np.einsum("...ij,...j->...i", inverse, right)
    about = total - np.einsum("...i,...i->...", fitted, right)
    free = count - 4.0
    curved = fitted[..., 0], inverse[..., 0, 0], count, np.maximum(about, 0.0) / np.maximum(free, 1.0), free
    level = _through_points([count, ones[0], own[0], squares, crossed, total], half)
    known = count >= BENT_POINTS
    taken = tuple(np.where(known, of_parabola, of_line) for of_parabola, of_line in zip(curved, level, strict=True))
    return *taken, np.where(known, curved[0] - level[0], 0.0)


def _sections_to_pool(count: Floats, stretches: Sequence[slice]) -> int:
    """Odd number of neighbouring sections that together hold `ENOUGH_POINTS` points on most flanks that were seen; at most a third of a stretch."""
    seen = count.sum(axis=2)
    if not (seen > 0).any():
        return 1
    total, most = _lengths(stretches)
    per_section = float(np.median(seen[seen > 0])) / total
    wanted = math.ceil(ENOUGH_POINTS / per_section)
    return int(min(wanted, max(most, 1))) | 1


def _lengths(stretches: Sequence[slice]) -> tuple[int, int]:
    """Sections in all stretches together, and a third of the shortest."""
    lengths = [rows.stop - rows.start for rows in stretches]
    return sum(lengths), min(lengths) // 3


def _on_each(count: Floats, pooled: int, stretches: Sequence[slice]) -> Ints:
    """(teeth,) the same for each tooth, by its thinner flank: wider than `pooled` where it has less than half of `FEWEST_POINTS` with that."""
    total, third = _lengths(stretches)
    per_section = (count.sum(axis=2) / total).min(axis=1)
    thin = (per_section > 0.0) & (per_section * pooled < 0.5 * FEWEST_POINTS)
    wanted = np.ceil(FEWEST_POINTS / np.where(thin, per_section, 1.0))
    most = max(third, 1)
    return np.where(thin, np.clip(wanted, pooled, max(most, pooled)), pooled).astype(np.int64) | 1


def _running_sum(values: Floats, width: int) -> Floats:
    """Sum over a centred window along the last axis, cut off at the ends."""
    total = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(values, axis=-1)], axis=-1)
    at = np.arange(values.shape[-1])
    low, high = np.maximum(at - width // 2, 0), np.minimum(at + width // 2 + 1, values.shape[-1])
    return np.asarray(total[..., high] - total[..., low], dtype=np.float64)

"""The Gauss filter of ISO 16610-21 on a scan's samples: unevenly spaced, with gaps and thin places."""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.inspection.ranges import Range

GAUSS = math.sqrt(math.log(2.0) / math.pi)
"""α of ISO 16610-21: half of the amplitude passes at the cut-off wavelength."""

STATIONS_PER_CUTOFF = 4

LEAST_STATIONS = 120
"""Steps of an evaluation range at least: as many as the standard's own cut-off, a thirtieth of it, asks for."""

SAMPLES_PER_CUTOFF = 2.0
"""Where samples lie farther apart than the cut-off divided by this, the filter is widened until they do not."""

THIN = 4.0
"""A station with this many times fewer points than the trace's median is a gap, unless chance alone may have left so few."""

ROWS = 3.0
"""Usual spaces between samples that a hole may be wide."""

LUCK = 4.0
"""Standard deviations of a count of points that chance is allowed."""

SHOWN, INSIDE, ABOVE = range(3)
"""What a station counts for: the chart only; the evaluation; too much material only."""


def stations(where: Range, reach: tuple[float, float]) -> tuple[Floats, Ints]:
    """Stations over the whole `reach` of the trace, evenly spaced piece by piece, and what each counts for."""
    corners = (reach[0], where.start, where.end, where.outer, reach[1])
    least = where.cutoff / STATIONS_PER_CUTOFF
    station, zone = [np.array([where.start])], [np.array([INSIDE])]
    for low, high, code in zip(corners[:-1], corners[1:], (SHOWN, INSIDE, ABOVE, SHOWN), strict=True):
        if high - low < 1e-9:
            continue
        piece = np.linspace(low, high, max(LEAST_STATIONS if code == INSIDE else 1, math.ceil((high - low) / least)) + 1)
        station.append(piece[:-1] if high == where.start else piece[1:])
        zone.append(np.full(len(station[-1]), code))
    order = np.argsort(np.concatenate(station))
    return np.concatenate(station)[order], np.concatenate(zone)[order]


def gauss_filter(out: Floats, x: Floats, weight: Floats, cutoff: float | Floats) -> Floats:
    """Matrix of the Gauss filter from samples at `x` to places `out`.

    Parameters
    ----------
    out : (k,) float
        Where the filtered trace is wanted, mm.
    x, weight : (n,) float
        Places of the samples in mm, and their weights.
    cutoff : float or (k,) float
        λ_c in mm: a wave of this length passes with half its amplitude.

    Returns
    -------
    (k, n) float
        ``filtered = matrix @ samples``.

    Notes
    -----
    Weight function ``exp(−π (x / (α λ_c))²)``, α = sqrt(ln 2 / π) (ISO 16610-21). At ends and gaps its first moment is kept too
    (local line): a straight line passes unchanged everywhere, and in the inside of an even trace nothing changes.
    """
    width = np.broadcast_to(cutoff, out.shape)
    return _with_first_moment(weight * _bells(out, x, width), out, x, width)


def _bells(out: Floats, x: Floats, width: Floats) -> Floats:
    """(k, n) weight function round each place, its greatest value 1."""
    power = x[None] - out[:, None]
    power /= GAUSS * width[:, None]
    power *= power
    power *= -math.pi
    power -= power.max(axis=1, keepdims=True)
    bells = np.zeros_like(power)
    np.exp(power, out=bells, where=power > -80.0)  # most lie farther off, and denormal numbers would slow every product
    return bells


def _with_first_moment(kernel: Floats, out: Floats, x: Floats, width: Floats) -> Floats:
    """The kernel (k, n), each row to the sum of 1 and to the mean of its place."""
    kernel = kernel / kernel.sum(axis=1, keepdims=True)
    mean = kernel @ x
    off = x[None] - mean[:, None]
    square = off * off
    square *= kernel
    spread = square.sum(axis=1) + (1e-6 * width) ** 2
    off *= ((out - mean) / spread)[:, None]
    off += 1.0
    kernel *= off
    return np.asarray(kernel, dtype=np.float64)


def filter_samples(station: Floats, x: Floats, weight: Floats, where: Range, step: float) -> tuple[Bools, Floats, Floats, Bools]:
    """Filter for one trace's samples, only where there are enough of them.

    Parameters
    ----------
    station : (k,) float
        Where the filtered trace is wanted, rising, mm.
    x, weight : (n,) float
        Places of the samples, rising, in mm, and their numbers of points; n ≥ 2.
    where : Range
        Cut-off, and the widest hole that is bridged.
    step : float
        A sample stands for this width, mm.

    Returns
    -------
    known : (k,) bool
        Stations with a value.
    matrix : (known, n) float
        From samples to those stations.
    cutoff : (known,) float
        Cut-off used there, mm: the range's own, or more where the samples lie too far apart for it.
    steady : (known,) bool
        Not so at the ends of the samples, where the filter has one side only and its noise would make the extremes.
    """
    gap = max(where.gap, usual_gap(x, weight))
    known = _between_samples(station, x, gap, step)
    cutoff = np.maximum(where.cutoff, SAMPLES_PER_CUTOFF * _spacing(station[known], x, where.cutoff, gap))
    bells = _bells(station[known], x, cutoff)
    matrix = _with_first_moment(weight * bells, station[known], x, cutoff)
    variance = (matrix**2) @ (1.0 / weight)
    # What an even trace would have there too, at its ends, is no thinness.
    even = _with_first_moment(bells, station[known], x, cutoff)
    even *= even
    thinness = variance / even.sum(axis=1)
    usable = known.copy()
    if known.any():
        points, usual = 1.0 / np.maximum(variance, 1e-300), 1.0 / np.median(variance)
        by_chance = 2.0 * (np.sqrt(usual) - np.sqrt(points)) <= LUCK  # the root of a count has a standard deviation of 1/2
        usable[known] = (thinness <= THIN * np.median(thinness)) | by_chance
    usable = _long_runs(usable, max(STATIONS_PER_CUTOFF, round(where.cutoff / float(np.median(np.diff(station))))))
    kept = usable[known]
    return usable, matrix[kept], cutoff[kept], variance[kept] <= THIN * np.median(variance[kept]) if kept.any() else kept[kept]


def _between_samples(station: Floats, x: Floats, gap: float, step: float) -> Bools:
    """Stations with samples round them: between two no farther apart than `gap`, or within a bin of one."""
    right = np.clip(np.searchsorted(x, station), 1, len(x) - 1)
    low, high = x[right - 1], x[right]
    bridged = (station >= low) & (station <= high) & (high - low <= gap)
    return np.asarray(bridged | (np.minimum(np.abs(station - low), np.abs(station - high)) <= step))


def usual_gap(x: Floats, count: Floats) -> float:
    """Widest hole that is no hole in a scan of such density, mm.

    Parameters
    ----------
    x, count : (n,) float
        Places of the samples, rising, in mm, and their numbers of points.

    Notes
    -----
    Points in rows: `ROWS` times the usual space between them. Scattered points leave spaces that are exponential with mean length / count, so
    that ``P(widest > g) ≤ count · exp(−g · count / length)``: what is left by chance in 19 of 20 traces.
    """
    if len(x) < 2:
        return 0.0
    points, length = float(count.sum()), float(x[-1] - x[0])
    return max(ROWS * float(np.median(np.diff(x))), length * math.log(20.0 * points) / points)


def end_gap(count: float, length: float) -> float:
    """How far from an end the first of `count` points, scattered over `length` mm, lies in 19 of 20 traces at most, mm."""
    return length * math.log(20.0) / max(count, 1.0)


def _spacing(station: Floats, x: Floats, cutoff: float, gap: float) -> Floats:
    """Widest space between neighbouring samples within half a cut-off of each station; holes wider than `gap` do not count."""
    space = np.diff(x)
    half = 0.5 * cutoff
    near = (x[None, :-1] < station[:, None] + half) & (x[None, 1:] > station[:, None] - half) & (space <= gap)
    return np.asarray(np.where(near, space, 0.0).max(axis=1, initial=0.0), dtype=np.float64)


def _long_runs(known: Bools, least: int) -> Bools:
    """`known` without runs of fewer than `least` stations: shorter than the cut-off they are no trace."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]])))
    out = np.zeros_like(known)
    for start, end in zip(edge[::2], edge[1::2], strict=True):
        out[start:end] = end - start >= least
    return out

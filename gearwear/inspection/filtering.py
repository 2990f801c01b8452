"""The Gauss filter of ISO 16610-21 on a scan's samples: unevenly spaced, with gaps and thin places."""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.inspection.ranges import Range

GAUSS = math.sqrt(math.log(2.0) / math.pi)
"""α of ISO 16610-21: half of the amplitude passes at the cut-off wavelength."""

STATIONS_PER_CUTOFF = 4

SAMPLES_PER_CUTOFF = 2.0
"""Where samples lie farther apart than the cut-off divided by this, the filter is widened until they do not."""

THIN = 4.0
"""A station with this many times fewer points than the trace's median is a gap: near a base circle a scan is thin."""

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
        piece = np.linspace(low, high, max(8 if code == INSIDE else 1, math.ceil((high - low) / least)) + 1)
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
    distance = x[None] - out[:, None]
    width = np.broadcast_to(cutoff, out.shape)[:, None]
    power = -math.pi * (distance / (GAUSS * width)) ** 2
    power -= power.max(axis=1, keepdims=True)
    kernel = weight * np.where(power > -80.0, np.exp(power), 0.0)  # denormal numbers would slow every product
    kernel /= kernel.sum(axis=1, keepdims=True)
    mean = kernel @ x
    off = x[None] - mean[:, None]
    spread = (kernel * off**2).sum(axis=1) + (1e-6 * width[:, 0]) ** 2
    return np.asarray(kernel * (1.0 + off * ((out - mean) / spread)[:, None]), dtype=np.float64)


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
    known = _between_samples(station, x, where.gap, step)
    cutoff = np.maximum(where.cutoff, SAMPLES_PER_CUTOFF * _spacing(station[known], x, where))
    matrix = gauss_filter(station[known], x, weight, cutoff)
    variance = (matrix**2) @ (1.0 / weight)
    # What an even trace would have there too, at its ends, is no thinness.
    thinness = variance / (gauss_filter(station[known], x, np.ones_like(weight), cutoff) ** 2).sum(axis=1)
    usable = known.copy()
    usable[known] = thinness <= THIN * np.median(thinness) if known.any() else False
    usable = _long_runs(usable, STATIONS_PER_CUTOFF)
    kept = usable[known]
    return usable, matrix[kept], cutoff[kept], variance[kept] <= THIN * np.median(variance[kept]) if kept.any() else kept[kept]


def _between_samples(station: Floats, x: Floats, gap: float, step: float) -> Bools:
    """Stations with samples round them: between two no farther apart than `gap`, or within a bin of one."""
    right = np.clip(np.searchsorted(x, station), 1, len(x) - 1)
    low, high = x[right - 1], x[right]
    bridged = (station >= low) & (station <= high) & (high - low <= gap)
    return np.asarray(bridged | (np.minimum(np.abs(station - low), np.abs(station - high)) <= step))


def _spacing(station: Floats, x: Floats, where: Range) -> Floats:
    """Widest space between neighbouring samples within half a cut-off of each station; holes wider than `where.gap` do not count."""
    space = np.diff(x)
    half = 0.5 * where.cutoff
    near = (x[None, :-1] < station[:, None] + half) & (x[None, 1:] > station[:, None] - half) & (space <= where.gap)
    return np.asarray(np.where(near, space, 0.0).max(axis=1, initial=0.0), dtype=np.float64)


def _long_runs(known: Bools, least: int) -> Bools:
    """`known` without runs of fewer than `least` stations: shorter than the cut-off they are no trace."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]])))
    out = np.zeros_like(known)
    for start, end in zip(edge[::2], edge[1::2], strict=True):
        out[start:end] = end - start >= least
    return out

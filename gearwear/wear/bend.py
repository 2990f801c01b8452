"""What the flanks of a side bend alike within the band that thickness is measured on.

Sliding wears flanks less the nearer the pitch point: they have a ridge there, and a straight line through the points of a band lies below it. Where
the load was not alike over the face, the ridge is sharper towards one end.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.robust import scale_about, tukey_weight

FEWEST_POINTS = 6
"""Points of a place from which on it tells of the ridge."""
LEAST_SPREAD = 0.05
"""Standard deviation along the profile, as a share of the band's half width, of points that a slope is fitted to. Below it lies what a row of points at one
radius has of its noise: that moves a point along the profile as far as off the flank."""
PASSES = 4
"""Reweighted means over the places of a side; numerical."""


def without_ridge(moments: Floats, starts: Ints, noise: float, half: float) -> tuple[Floats, Floats]:
    """Sums over sections less the ridge that the flanks of a side have in common.

    Parameters
    ----------
    moments : (9, teeth, 2, n_z) float
        Number of points; of x, length of roll from the band's middle, and y, deviation, mm: Σx, Σy, Σx², Σxy, Σy², Σ|x|, Σx|x|, Σ|x|y.
    starts : (k,) int
        First sections of places: neighbouring sections whose points are looked at together.
    noise : float
        Scatter of points, mm.
    half : float
        Half the width of the band, mm.

    Returns
    -------
    moments : (6, teeth, 2, n_z) float
        The first six, of y − c |x|, where c is a straight line along the face.
    std : (2,) float
        What c leaves uncertain of a mean over the band on all flanks of a side alike, mm.

    Notes
    -----
    At each place of each flank c is the slope of y on |x| beside a straight line, its variance that of the noise over what is left of Σ|x|². Of a side
    it is their mean and their slope along the face, weighted by that and by Tukey's weights: a pit, or the edge of one, is no ridge. Of the square of
    each its variance v is expected of chance: the share ``1 − v / c²`` is taken (James and Stein 1961), so that straight flanks stay as they are.
    """
    n, x, y, xx, xy, yy, ax, xax, axy = moments
    count = moments.shape[-1]
    along = np.arange(count) / max(count - 1, 1) - 0.5
    middle = 0.5 * (along[starts] + along[np.append(starts[1:] - 1, count - 1)])
    c, std = np.zeros((2, count)), np.zeros(2)
    for side in range(2):
        places = np.add.reduceat(moments[:, :, side], starts, axis=-1)
        heights = np.broadcast_to(middle, places.shape[1:])
        mean, lean, spread = _ridge(places.reshape(len(moments), -1), heights.ravel(), noise, half)
        c[side] = mean + lean * along
        number = float(n[:, side].sum())
        std[side] = spread * float(ax[:, side].sum()) / max(number, 1.0)
    return np.stack([n, x, y - c * ax, xx, xy - c * xax, yy - 2.0 * c * axy + c**2 * xx]), std


def _ridge(moments: Floats, heights: Floats, noise: float, half: float) -> tuple[float, float, float]:
    """The slope on |x| that the flanks of a side share, in the middle of the face and its change over it, and the standard deviation of a mean over it;
    from the moments (9, m) of places at `heights` (m,), −0.5 … 0.5."""
    enough = moments[0] >= FEWEST_POINTS
    n, x, y, xx, xy, _, ax, xax, axy = moments[:, enough]
    if len(n) == 0:
        return 0.0, 0.0, 0.0
    spread = np.maximum(xx - x**2 / n, 1e-300)
    lean = (xax - x * ax / n) / spread
    free = xx - ax**2 / n - lean**2 * spread  # of |x|, beside a straight line
    along = axy - ax * y / n - lean * (xy - x * y / n)
    shows = free > n * (LEAST_SPREAD * half) ** 2  # with two rows of points it is a straight line
    if 2 * shows.sum() <= len(n) or noise <= 0.0:  # where few places show it, what is odd about these does
        return 0.0, 0.0, 0.0
    each, known, at = along[shows] / free[shows], free[shows] / noise**2, heights[enough][shows]
    order = np.lexsort((at, each))
    each, known, at = each[order], known[order], at[order]
    mean, change = float(np.interp(0.5, np.cumsum(known) / known.sum(), each)), 0.0
    for _ in range(PASSES):
        off = (each - mean - change * at) * np.sqrt(known)
        scale = max(scale_about(off), 1.0)
        weight = known * tukey_weight(off, scale)
        whole, centre = float(weight.sum()), float((weight * at).sum() / weight.sum())
        across = float((weight * (at - centre) ** 2).sum())
        level = float((weight * each).sum() / whole)
        change = float((weight * (at - centre) * each).sum() / across) if across > 1e-9 * whole else 0.0
        mean = level - change * centre
    variance = scale**2 / whole
    share = max(1.0 - variance / max(level**2, 1e-300), 0.0)
    of_change = scale**2 / max(across, 1e-300)
    leaning = max(1.0 - of_change / max(change**2, 1e-300), 0.0)
    kept = share * leaning * change  # what is no ridge leans to no end
    return share * level - kept * centre, kept, share * float(np.sqrt(variance))

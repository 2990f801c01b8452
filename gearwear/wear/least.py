"""The least of many noisy values, without the bias of having looked for it.

Of values that are known to ± σ the least is below the least true one: the more of them compete, the further (of 20 alike by 1.9 σ). How many
compete is seen in the values themselves. They are taken for draws from some distribution that need not be smooth, known from its own
greatest likelihood (Kiefer & Wolfowitz 1956; found by the steps of expectation and maximisation); each value's mean under it
is a set of truths that spreads as the truth does, not as the noise makes it. Noise is put on that set again and again: what the least then lies
below the least of the set is the bias, and its scatter is the standard deviation of the least.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats, Ints

DRAWS = 200
ATOMS = 100
"""Places at which the distribution of the true values may have weight, and values it is found from."""
STEPS = 100
LUCK = 1.5
"""Logarithm of the likelihood that a higher least may cost."""
UNSURE = 1.0
"""Standard deviation of the bias in the difference between the two distributions it is worked out with."""
NOT_BENT = 4.0
"""Standard deviations of a value that its second difference may be by noise, at a least."""
WIDTHS = (5, 3, 1)
"""Neighbours that are averaged, as long as that does not hide the bottom of a pit."""
HIDDEN = 0.5
"""Share of a window, in the middle of a row, that nobody looks at, at most; what is looked at twice counts twice, and takes more off for luck."""
HIDES = 2.0
"""Standard deviations by which fewer neighbours must show a lower least for that."""


def unmixed(value: Floats, std: Floats, apart: Bools | None = None) -> tuple[Floats, Floats]:
    """Means of the true values, (n,) twice, given that they are draws from one distribution; NaN stays.

    First under the distribution of greatest likelihood, whose least is low by luck; then under that with the highest least that is
    nearly as likely.

    Parameters
    ----------
    value, std : (n,) float
        Measured values and their standard deviations.
    apart : (n,) bool or None
        Values whose errors are independent, from which the distribution is found; None: all.
    """
    result = value.copy()
    known = np.flatnonzero(np.isfinite(value) & (std > 0.0))
    if len(known) < 2:
        return result, result
    use = known if apart is None else known[apart[known]]
    if len(use) < 2:
        return result, result
    # The lowest all by themselves, the others by their quantiles.
    order = use[np.argsort(value[use])]
    lowest, rest = order[:ATOMS], order[ATOMS:]
    groups = np.array_split(rest, min(ATOMS, len(rest))) if len(rest) else []
    part = np.concatenate([lowest, np.array([group[len(group) // 2] for group in groups], dtype=np.int64)])
    number = np.concatenate([np.ones(len(lowest)), [float(len(group)) for group in groups]])
    # Atoms no further apart than the noise: on the values themselves where they spread wide.
    atoms = np.linspace(value[part[0]], value[part[-1]], ATOMS)
    if atoms[1] - atoms[0] > 0.5 * float(std[known].min()):
        atoms = value[part]

    def likelihood(of: Ints) -> Floats:
        log = -0.5 * ((value[of, None] - atoms) / std[of, None]) ** 2
        return np.asarray(np.exp(log - log.max(axis=1, keepdims=True)), dtype=np.float64)

    seen, total = likelihood(part), number.sum()

    def fitted(first: int) -> tuple[Floats, float]:
        """Weights of the atoms from `first` on, and the logarithm of their likelihood."""
        of_some, share = np.ascontiguousarray(seen[:, first:]), number / total
        weight = np.full(len(atoms) - first, 1.0 / (len(atoms) - first))
        mixed, gain = np.empty(len(part)), np.empty_like(weight)
        for _ in range(STEPS):  # in place: each step is two small products
            np.maximum(of_some.dot(weight, out=mixed), 1e-300, out=mixed)
            np.divide(share, mixed, out=mixed)
            weight *= mixed.dot(of_some, out=gain)
        return np.concatenate([np.zeros(first), weight]), float(number @ np.log(np.maximum(of_some @ weight, 1e-300)))

    # The highest least of all that the values allow: one that is low by luck is not taken for one that is low.
    free, best = fitted(0)
    weight = free
    first, last = 0, len(atoms) - 1
    while last - first > 1:
        middle = (first + last) // 2
        tried, likely = fitted(middle)
        if likely > best - LUCK:
            first, weight = middle, tried
        else:
            last = middle
    of_all, raised = likelihood(known), value.copy()
    for estimate, weights in ((result, free), (raised, weight)):
        share = of_all * weights
        estimate[known] = share @ atoms / share.sum(axis=1)
    return result, raised


def places(count: int, width: int) -> Ints:
    """Middles of windows of `width` (odd) in a row of `count`, the same from either end: side by side from both ends inwards, those in the middle apart or over
    each other (`_apart`). Where more than `HIDDEN` of one would lie between them there are two more, and all overlap evenly, by half of one at most."""
    width = min(width, count)
    apart = np.flatnonzero(_apart(count, width))
    number, left = len(apart) + 2, count - width
    if count - len(apart) * width <= HIDDEN * width or left < 0.5 * width * (number - 1):
        return apart
    lower = width // 2 + np.arange(number // 2) * left // (number - 1)
    middle = [(count - 1) // 2] if number % 2 else []
    return np.concatenate([lower, middle, (count - 1 - lower)[::-1]]).astype(np.int64)


def _apart(count: int, width: int) -> Bools:
    """(count,) middles of windows side by side from both ends inwards. Where they do not go into the row, those in the middle overlap or leave a gap,
    whichever is less of a window."""
    number = -(-count // width)
    if (number - count) % 2:  # one lies in the middle where the row has one
        number += -1 if number > 1 else 1
    lower = np.minimum(width // 2 + width * np.arange(number // 2), (count - 1) // 2)
    result = np.zeros(count, dtype=bool)
    result[np.concatenate([lower, count - 1 - lower])] = True
    if number % 2:
        result[(count - 1) // 2] = True
    return result


@dataclass(frozen=True, slots=True)
class Least:
    """The least of several curves, and of each.

    Parameters
    ----------
    value, std : (k,) float
        Least true value of each curve and its standard deviation; NaN for a curve nobody saw.
    at : (k,) int
        Its place; −1 there.
    curve : int
        The one with the least of all; −1 if nothing was seen.
    overall, overall_std : float
        The least true value of all. Not that of `curve` alone: any of those that come near may be the one.
    """

    value: Floats
    std: Floats
    at: Ints
    curve: int
    overall: float
    overall_std: float


def least_of_curves(curves: Floats, std: Floats, texture: float = 0.0, step: float = 0.0, most: int = WIDTHS[0]) -> Least:
    """The least true value of each of several curves, measured at evenly spaced places, and of all.

    Parameters
    ----------
    curves : (k, n) float
        Measured; NaN where there is nothing.
    std : (k, n) float
        Standard deviation of each value by noise of its own.
    texture, step : float
        Variance of an error that is correlated along the curve, and its correlation from one place to the next.
    most : int
        Neighbours that may be averaged at most.

    Notes
    -----
    Running means are looked at, over as many places as do not hide a lower least of fewer. Means that the distribution of all leaves are taken for
    the truth, noise is put on them and they are averaged again: so the bias of smoothing is taken off with that of looking for a least.
    """
    k, n = curves.shape
    seen = np.isfinite(curves)
    if not seen.any():
        nothing = np.full(k, np.nan)
        return Least(nothing, nothing, np.full(k, -1), -1, float("nan"), float("nan"))
    random = np.random.default_rng(0)
    known = np.where(seen, std, 0.0)
    alone = _draws(
        random, 1, known, texture, step
    )  # each curve by itself has the same: which is called the first does not matter
    together = _draws(random, k, known[order := _own_order(curves)], texture, step)[:, np.argsort(order)]
    tried: list[Least] = []
    for width in sorted({min(width, n) for width in WIDTHS if width <= max(most, 1)}):
        tried.append(_of_width(curves, std, seen, (alone, together), width, texture, step))
    value, spread, at = tried[0].value.copy(), tried[0].std.copy(), tried[0].at.copy()
    best, overall_std = tried[0], tried[0].overall_std
    for wider in tried[1:]:
        # What fewer neighbours show beyond may be noise or a pit: half of it is in the standard deviation.
        hides = np.maximum(wider.value - value, 0.0)
        calm = hides < HIDES * np.hypot(spread, wider.std)
        value[calm], at[calm] = wider.value[calm], wider.at[calm]
        spread[calm] = np.minimum(np.hypot(wider.std, 0.5 * hides), np.maximum(spread, wider.std))[calm]
        hidden = max(wider.overall - best.overall, 0.0)
        if hidden < HIDES * np.hypot(overall_std, wider.overall_std):
            overall_std = min(float(np.hypot(wider.overall_std, 0.5 * hidden)), max(overall_std, wider.overall_std))
            best = wider
    # Whatever the bias is, no curve's least lies above its mean, nor the least of all above that of all; the least of their means is low by luck.
    means = np.divide(np.where(seen, curves, 0.0).sum(axis=1), seen.sum(axis=1), out=np.full(k, np.nan), where=seen.any(axis=1))
    return Least(np.minimum(value, means), spread, at, best.curve, min(best.overall, float(np.nanmean(means))), overall_std)


def _own_order(curves: Floats) -> Ints:
    """Curves from the lowest to the highest: which of them is called the first must not change what is drawn for it."""
    known = np.isfinite(curves)
    return np.argsort(np.where(known, curves, 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1), kind="stable")


def _draws(random: np.random.Generator, curves: int, std: Floats, texture: float, step: float) -> Floats:
    """(2 `DRAWS`, k, n) errors of curves; each also the other way round, so that which end comes first does not matter."""
    unit = random.normal(size=(2, DRAWS, curves, std.shape[1]))
    noise = np.concatenate([unit[0], unit[0, ..., ::-1]]) * std
    if texture > 0.0:
        long = np.sqrt(texture) * unit[1] @ _root(step, std.shape[1]).T
        noise += np.concatenate([long, long[..., ::-1]])
    return np.asarray(noise, dtype=np.float64)


def _of_width(
    curves: Floats, std: Floats, seen: Bools, noise: tuple[Floats, Floats], width: int, texture: float, step: float
) -> Least:
    number = np.maximum(_sums(seen.astype(np.float64), width), 1.0)
    mean = np.where(seen, _sums(np.where(seen, curves, 0.0), width) / number, np.nan)
    variance = _sums(np.where(seen, std, 0.0) ** 2, width) / number**2
    variance += texture * float(np.mean(correlation(step, width)))
    apart = np.broadcast_to(_apart(curves.shape[1], width), curves.shape)
    truths = unmixed(mean.ravel(), np.sqrt(np.where(seen, variance, np.nan)).ravel(), apart.ravel())
    known, least = seen.any(axis=1), np.where(seen, mean, np.inf)
    part = np.append(known, True)
    bias, scatter = [], []
    for truth in truths:
        true = np.where(seen, truth.reshape(mean.shape), np.inf)
        # What smoothing once more takes off the bottom, it took off before.
        alone, together = (
            np.where(seen, _sums(np.where(seen, truth.reshape(mean.shape) + draw, 0.0), width) / number, np.inf) for draw in noise
        )
        each = np.column_stack([alone.min(axis=2), together.min(axis=(1, 2))])[:, part]
        bias.append(each.mean(axis=0) - np.append(true.min(axis=1), true.min())[part])
        scatter.append(each.std(axis=0))
    lowest = np.append(least.min(axis=1), least.min())[part] - np.mean(bias, axis=0)
    std_of = np.hypot(np.mean(scatter, axis=0), UNSURE * np.abs(np.subtract(*bias)))
    value = np.full(len(curves), np.nan)
    spread, at = value.copy(), np.where(known, least.argmin(axis=1), -1)
    value[known], spread[known] = lowest[:-1], std_of[:-1]
    return Least(value, spread, at, int(least.min(axis=1).argmin()), float(lowest[-1]), float(std_of[-1]))


def below(before: Floats, least: Floats, after: Floats, std: Floats) -> Floats:
    """How far the bottom lies below the least of means over places side by side, by the bend that the means themselves show.

    A parabola through a place of width w has a mean that is D / 24 above its middle, D the second difference from place to place; and its bottom lies
    off the middle, anywhere within w, which is as much again on average. At the end of a flat bottom only one side rises: the lesser rise counts for both. What the noise makes of D at a
    least is left out.
    """
    bend = 2.0 * np.nan_to_num(np.minimum(before - least, after - least)) - NOT_BENT * np.nan_to_num(std)
    return np.asarray(np.maximum(bend, 0.0) / 12.0, dtype=np.float64)


def _sums(values: Floats, width: int) -> Floats:
    """Sums over a centred window along the last axis; nothing beyond its ends."""
    return np.asarray(ndimage.uniform_filter1d(values, width, axis=-1, mode="constant") * width, dtype=np.float64)


@lru_cache(maxsize=2)
def _unit(shape: tuple[int, int]) -> Floats:
    """(2, `DRAWS`, rows, columns) draws from N(0, 1), read-only, the same for all surfaces of one shape."""
    draws = np.random.default_rng(0).normal(size=(2, DRAWS, *shape))
    draws.setflags(write=False)
    return draws


@lru_cache(maxsize=2)
def _correlated(shape: tuple[int, int], steps: tuple[float, float], window: tuple[int, int]) -> Floats:
    """Means over windows of (2 `DRAWS`, rows, columns) draws of variance 1, correlated by `steps`, half of them the other way round: the same for all
    surfaces of one shape."""
    along, across = (_root(step, number) for step, number in zip(steps, shape, strict=True))
    long = along @ _unit(shape)[1] @ across.T
    means = _over_windows(np.concatenate([long, long[:, ::-1]]), window)
    means.setflags(write=False)
    return means


def _root(step: float, number: int) -> Floats:
    """Triangle whose products with white noise are correlated by `step` from one place to the next."""
    return np.asarray(np.linalg.cholesky(correlation(step, number) + 1e-9 * np.eye(number)), dtype=np.float64)


def correlation(step: float, number: int) -> Floats:
    """(n, n) of places in a row, `step` from one to the next."""
    index = np.arange(number)
    return np.asarray(step ** np.abs(index[:, None] - index), dtype=np.float64)


def _over_windows(values: Floats, window: tuple[int, int]) -> Floats:
    """Means of (…, rows, columns) over windows, with a window in the middle of each row; of even ones between rows, the same from either end."""
    ahead = values.ndim - 2
    means = ndimage.uniform_filter(values, (*[1] * ahead, *window), mode="nearest")
    return np.asarray(means[..., 1:, :] if window[0] % 2 == 0 else means, dtype=np.float64)


def least_mean(
    value: Floats,
    where: Bools,
    std: Floats,
    window: tuple[int, int],
    texture: float = 0.0,
    steps: tuple[float, float] = (0.0, 0.0),
) -> tuple[float, float, float]:
    """The least mean over a window of a surface that is known in cells, its standard deviation, and that of a window's mean that was not looked for.

    The last hangs on noise and bend alone, the one before it on which values the noise happened to leave near the least as well.

    Parameters
    ----------
    value : (rows, columns) float
        Of the cells.
    where : (rows, columns) bool
        Where the middle of the window may lie.
    std : (rows, columns) float
        Standard deviation of each cell by noise of its own.
    window : (int, int)
        Rows and columns of the window.
    texture, steps : float, (float, float)
        Variance of a correlated error, and its correlation from one row and from one column to the next.
    """
    mean = _over_windows(value, window)
    if mean.shape != where.shape:  # the middle of an even window lies between two rows
        where = np.logical_or(where[1:], where[:-1])
    size = window[0] * window[1]
    white = _over_windows(std**2, window) / size
    common = texture * float(np.prod([np.mean(correlation(step, number)) for step, number in zip(steps, window, strict=True)]))
    known = np.where(where, np.sqrt(white + common), np.nan)
    apart = np.outer(*(_apart(count, min(width, count)) for count, width in zip(mean.shape, window, strict=True)))
    truths = unmixed(mean[where], known[where], apart[where])
    unit = _unit(value.shape)[0]
    noise = _over_windows(np.concatenate([unit, unit[:, ::-1]]) * std, window)[:, where]  # which end comes first does not matter
    if texture > 0.0:
        noise += np.sqrt(texture) * _correlated(value.shape, steps, window)[:, where]
    drawn = [(truth + noise).min(axis=1) for truth in truths]
    bias = [again.mean() - truth.min() for again, truth in zip(drawn, truths, strict=True)]
    std_of = np.hypot(np.mean([again.std() for again in drawn]), UNSURE * abs(bias[0] - bias[1]))
    row, column = np.unravel_index(int(np.where(where, mean, np.inf).argmin()), mean.shape)
    wide = np.pad(mean, ((1, 1), (1, 1)), constant_values=np.nan)
    middle, error = mean[row, column], known[row, column]
    beside = [(wide[row, column + 1], wide[row + 2, column + 1])] if window[0] == 1 else []
    beside += [(wide[row + 1, column], wide[row + 1, column + 2])] if window[1] == 1 else []
    deeper = sum(float(below(before, middle, after, error)) for before, after in beside)
    # Cells that are larger than the window hide more than is sure.
    hides = sum(float(below(before, middle, after, np.zeros(()))) for before, after in beside)
    lowest, lowest_std = float(mean[where].min() - np.mean(bias) - deeper), float(np.hypot(std_of, hides - 0.5 * deeper))
    # Half of what a bend hides that is beyond the noise, or that the noise may hide. All windows, as how many points the deepest few hold is luck too.
    usual = float(np.median(known[where]))
    return lowest, lowest_std, float(np.hypot(usual, 0.5 * (deeper + len(beside) * NOT_BENT * usual / 12.0)))

"""How stiff the surface of a flank or a fillet is before its cells are seen, and which stiffness is the likeliest (`surface`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy import fft, ndimage

from gearwear.arrays import Bools, Floats

STIFFNESS = tuple(range(-10, 8))
"""Decades of stiffness along the face and along the profile, in units of the cells' usual weight, among which is searched; then to half a one."""
SAME_BOTH_WAYS = tuple(range(-8, 5))
"""Decades among which is searched where few cells are to tell only one stiffness."""
APART = 6
"""Decades that they may differ by."""
TENSION = (0.01, 0.1, 1.0)
"""κ² among which is searched: leaning counts as much as bending over 10, 3 and 1 cells."""
LEAST_SHARE = 0.01
"""Likelihood, of that of the likeliest, below which a stiffness does not count."""


class Stiffness(NamedTuple):
    """How stiff a surface is before its cells are seen.

    Parameters
    ----------
    along, across : float
        Decades of τ s² and τ / s², along the face and along the profile, in units of the cells' usual weight.
    tension : float
        κ².
    """

    along: float
    across: float
    tension: float

    @property
    def stiffness(self) -> float:
        """τ, in units of the cells' usual weight."""
        return float(10.0 ** (0.5 * (self.along + self.across)))

    @property
    def stretch(self) -> float:
        """s."""
        return float(10.0 ** (0.25 * (self.along - self.across)))

    def near(self) -> list[Stiffness]:
        """What is searched next to it: half a decade more or less either way, and another tension, about as stiff over a few cells."""
        along, across, tension = self
        near = [Stiffness(along + step, across, tension) for step in (-0.5, 0.5)]
        near += [Stiffness(along, across + step, tension) for step in (-0.5, 0.5)]
        near += [Stiffness(along + step, across - step, tension) for step in (-0.5, 0.5)]
        for other, share in product(TENSION, (0.0, 0.5, 1.0)):
            step = share * math.log10(tension / other)
            near += [Stiffness(along + step, across + step, other)] if other != tension else []
        return [one for one in near if STIFFNESS[0] <= min(one[:2]) <= max(one[:2]) <= min(min(one[:2]) + APART, STIFFNESS[-1])]


AsStiff = Mapping[Stiffness, float]
"""How stiff a surface may be, and the share of the likelihood of each."""

_ISOTROPIC = tuple(Stiffness(float(decade), float(decade), tension) for tension, decade in product(TENSION, SAME_BOTH_WAYS))
_ALL = tuple(
    Stiffness(float(along), float(across), tension)
    for along, across, tension in product(STIFFNESS[::2], STIFFNESS[::2], TENSION)
    if abs(along - across) <= APART
)


def shares_of_likelihood(cost: Callable[[Stiffness], float]) -> dict[Stiffness, float]:
    """The share of the likelihood that each stiffness and tension has that is the same both ways, expected alike before anything is seen, of a `cost` that
    is −2 log likelihood; those below `LEAST_SHARE` of the greatest are left out."""
    costs = np.array([cost(one) for one in _ISOTROPIC])
    likelihood = np.exp(-0.5 * (costs - costs.min()))
    likelihood[likelihood < LEAST_SHARE] = 0.0
    return {one: float(own / likelihood.sum()) for one, own in zip(_ISOTROPIC, likelihood, strict=True) if own}


def likeliest(cost: Callable[[Stiffness], float], begin: Stiffness) -> Stiffness:
    """The stiffness of less cost than all near it: from one to begin with to the first of those near it that costs less, as long as there is one."""
    known, best = cache(cost), begin
    while (less := next((one for one in best.near() if known(one) < known(best)), None)) is not None:
        best = less
    return best


def likeliest_of_cosines(seen: Bools, value: Floats, weight: float) -> Stiffness:
    """The stiffness that were the likeliest if all cells were seen alike: the cosines of their values are independent then, `value` (m,) of those that are
    `seen` (rows, columns), and of the nearest of them elsewhere. Where to begin."""
    number = np.zeros(seen.shape, dtype=np.int64)
    number[seen] = np.arange(len(value))

    def filled(way: int) -> Floats:
        nearest = ndimage.distance_transform_edt(~seen[::way], return_distances=False, return_indices=True)
        return np.asarray(value[number[::way][tuple(nearest)]][::way])

    # From both ends of the face: of two as near the first is taken.
    square = weight * fft.dctn(0.5 * (filled(1) + filled(-1)), norm="ortho").ravel()[1:] ** 2
    eigenvalues = path_eigenvalues(*seen.shape)

    def cost(stiffness: Stiffness) -> float:
        variance = 1.0 + 1.0 / penalised(eigenvalues, stiffness)
        return float((np.log(variance) + square / variance).sum())

    logarithms, inverse = _variances(seen.shape)
    return likeliest(cost, _ALL[int(np.argmin(logarithms + inverse @ square))])


@lru_cache(maxsize=4)
def _variances(shape: tuple[int, int]) -> tuple[Floats, Floats]:
    """Of each of `_ALL`: the sum of the logarithms of the variances of the cosines of so many cells, (k,), and their inverses, (k, n)."""
    eigenvalues = path_eigenvalues(*shape)
    variance = np.array([1.0 + 1.0 / penalised(eigenvalues, one) for one in _ALL])
    return np.log(variance).sum(axis=1), 1.0 / variance


def penalised(eigenvalues: tuple[Floats, Floats], stiffness: Stiffness) -> Floats:
    """Eigenvalues of Q but that of the level, where the cells weigh 1; `eigenvalues` of L_z and of L_p."""
    along, across = eigenvalues
    both = (stiffness.stretch * along[:, None] + across / stiffness.stretch).ravel()[1:]
    return np.asarray(stiffness.stiffness * both * (stiffness.tension + both), dtype=np.float64)


def path_eigenvalues(rows: int, columns: int) -> tuple[Floats, Floats]:
    """Eigenvalues of `_path` of so many rows, and of so many columns: those of cosines."""
    along, across = (2.0 - 2.0 * np.cos(np.pi * np.arange(number) / number) for number in (rows, columns))
    return along, across

"""How far the sizes of two effects are known only together: correlations from the joint covariance of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects.base import Context

LEAST = 0.1
"""Absolute correlation from which on one is reported."""
STEP = 1e-4
"""Relative step of the amplitudes with which it is seen how a parameter follows them."""


@dataclass(frozen=True, slots=True)
class Correlation:
    """How far the sizes of two effects are known only together.

    Parameters
    ----------
    effects, parameters : (str, str)
        Names of the effects, and of the parameters that are their sizes.
    value : float
        −1 … 1; +: both may be larger, or both smaller, without the fit getting worse by much.
    """

    effects: tuple[str, str]
    parameters: tuple[str, str]
    value: float


@dataclass(frozen=True, slots=True)
class EffectSize:
    """A size of an effect as a function of the fit's amplitudes, to first order.

    Parameters
    ----------
    index : int
        Number of the effect in the model.
    effect, parameter : str
    at : (p,) int
        Where its amplitudes stand in the joint covariance.
    slope : (p,) float
        Derivative by each of them.
    """

    index: int
    effect: str
    parameter: str
    at: Ints
    slope: Floats


def sizes(
    candidate: Candidate, index: int, amplitudes: Floats, covariance: Floats, at: Ints, context: Context
) -> list[EffectSize]:
    """The parameters of an effect that are sizes: those that grow as all its amplitudes together do.

    Parameters
    ----------
    candidate : Candidate
    index : int
        Its number in the model.
    amplitudes : (p,) float
    covariance : (p + q, p + q) float
        Of the amplitudes and the shape values.
    at : (p,) int
        Where the amplitudes stand in the joint covariance.
    context : Context

    Returns
    -------
    list of EffectSize
        A list of numbers (a value per tooth) counts as one: its length along what was found.
    """

    def values(moved: Floats) -> dict[str, float]:
        found = candidate.effect.estimates(moved, covariance, candidate.shape, context)
        return {
            name: float(np.linalg.norm(np.nan_to_num(one.value))) if isinstance(one.value, tuple) else one.value
            for name, one in found.items()
        }

    step = STEP * float(np.linalg.norm(amplitudes))
    if not step > 0.0:
        return []
    here, moves = values(amplitudes), step * np.eye(len(amplitudes))
    ahead, behind = ([values(amplitudes + sign * move) for move in moves] for sign in (1.0, -1.0))
    result = []
    for name, value in here.items():
        slope = np.array([(one[name] - other[name]) / (2.0 * step) for one, other in zip(ahead, behind, strict=True)])
        if value != 0.0 and abs(float(slope @ amplitudes) - value) < 1e-3 * abs(value):
            result.append(EffectSize(index, candidate.name, name, at, slope))
    return result


def correlations(known: Sequence[EffectSize], covariance: Floats) -> tuple[Correlation, ...]:
    """Correlations of sizes of different effects that are at least `LEAST`, the strongest first.

    Parameters
    ----------
    known : sequence of EffectSize
    covariance : (m, m) float
        Of all amplitudes together.
    """
    result = []
    for one, other in combinations(known, 2):
        if one.index == other.index:
            continue
        variances = [float(size.slope @ covariance[np.ix_(size.at, size.at)] @ size.slope) for size in (one, other)]
        if min(variances) > 0.0:
            value = float(one.slope @ covariance[np.ix_(one.at, other.at)] @ other.slope) / float(np.sqrt(np.prod(variances)))
            if abs(value) >= LEAST:
                result.append(Correlation((one.effect, other.effect), (one.parameter, other.parameter), value))
    return tuple(sorted(result, key=lambda found: -abs(found.value)))

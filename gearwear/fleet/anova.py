"""Crossed gauge study by analysis of variance: components of variance and their intervals.

After AIAG, Measurement Systems Analysis, 4th ed. (2010), chapter III, "Analysis of variance (ANOVA) method"; the intervals after Burdick,
Borror and Montgomery, Design and Analysis of Gauge R&R Studies (2005).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, fdtrc, fdtri

from gearwear.arrays import Floats

POOLED = 0.25
"""Chance from which on the interaction of operators and parts is taken for repeatability."""
ROUNDING = 16.0 * float(np.finfo(np.float64).eps)
"""Of the greatest value: differences of means below it are not told from none."""
SHARE = 0.95
"""That intervals hold the truth."""
WHOLES = {
    "reproducibility": ("operator", "interaction"),
    "gauge": ("repeatability", "reproducibility"),
    "total": ("gauge", "part"),
}
"""What is the sum of which components, in the order in which they add up."""


@dataclass(frozen=True, slots=True)
class MeanSquare:
    """A mean square and its degrees of freedom."""

    value: float
    degrees: int

    @property
    def total(self) -> float:
        """The sum of squares."""
        return self.value * self.degrees


@dataclass(frozen=True, slots=True)
class Component:
    """A variance with its 95 % interval; as in AIAG an estimate below 0 is 0.

    Parameters
    ----------
    variance, low, high : float
    """

    variance: float
    low: float
    high: float

    def of(self, variance: float) -> Component:
        """With another estimate; the interval holds it."""
        return Component(variance, min(self.low, variance), max(self.high, variance))

    @property
    def std(self) -> float:
        return math.sqrt(self.variance)

    @property
    def std_interval(self) -> tuple[float, float]:
        return math.sqrt(self.low), math.sqrt(self.high)


@dataclass(frozen=True, slots=True, kw_only=True)
class GaugeVariance:
    """Where the variance of a crossed study comes from.

    Parameters
    ----------
    parts, operators, repeats : int
        Its size.
    squares : dict of str to MeanSquare
        "part", "operator", "interaction", "repeat": the table, before anything is pooled; only "part" and "repeat" with one operator.
    p_interaction : float
        Chance of such an interaction where there is none; nan with one operator.
    pooled : bool
        Whether it was taken for repeatability.
    repeatability : Component
        Equipment variation, EV.
    operator, interaction : Component or None
        None where they cannot be seen: with one operator, the interaction also where it was pooled.
    reproducibility : Component or None
        Appraiser variation, AV: operators and interaction.
    gauge : Component
        GRR: repeatability and reproducibility.
    part : Component
        PV.
    total : Component
        TV.
    """

    parts: int
    operators: int
    repeats: int
    squares: Mapping[str, MeanSquare]
    p_interaction: float
    pooled: bool
    repeatability: Component
    operator: Component | None
    interaction: Component | None
    reproducibility: Component | None
    gauge: Component
    part: Component
    total: Component

    @property
    def share(self) -> float:
        """%GRR as a share: standard deviation of the gauge over that of the whole study; nan where all is equal."""
        return self.gauge.std / self.total.std if self.total.variance > 0.0 else math.nan

    @property
    def categories(self) -> int | None:
        """ndc: how many kinds of parts it tells apart, 1.41 PV / GRR cut to a whole number; None where the gauge shows no scatter."""
        return math.floor(math.sqrt(2.0) * self.part.std / self.gauge.std) if self.gauge.variance > 0.0 else None


def gauge_variance(values: Floats) -> GaugeVariance:
    """Analyse a balanced crossed study.

    Parameters
    ----------
    values : (parts, operators, repeats) float
        At least two parts and two repeats.

    Raises
    ------
    ValueError
        If there are fewer.
    """
    p, o, r = values.shape
    if p < 2 or r < 2 or o < 1:
        raise ValueError(f"a study of {p} parts, {o} operators and {r} repeats: at least 2 parts, 1 operator and 2 repeats")
    mean, by_part, by_operator, cell = values.mean(), values.mean((1, 2)), values.mean((0, 2)), values.mean(2)
    squares = {
        "part": MeanSquare(o * r * float(np.square(by_part - mean).sum()) / (p - 1), p - 1),
        "repeat": MeanSquare(float(np.square(values - cell[..., None]).sum()) / (p * o * (r - 1)), p * o * (r - 1)),
    }
    chance, pooled = math.nan, False
    if o > 1:
        crossed = cell - by_part[:, None] - by_operator[None, :] + mean
        squares["operator"] = MeanSquare(p * r * float(np.square(by_operator - mean).sum()) / (o - 1), o - 1)
        squares["interaction"] = MeanSquare(r * float(np.square(crossed).sum()) / ((p - 1) * (o - 1)), (p - 1) * (o - 1))
        chance = _chance(squares["interaction"], squares["repeat"], r * (ROUNDING * float(np.abs(values).max())) ** 2)
        pooled = not chance <= POOLED
    terms, used = _terms(p, o, r, pooled), _used(squares, pooled)
    components = {name: _component(weights, used) for name, weights in terms.items()}
    for whole, pieces in WHOLES.items():  # of estimates that were cut off at 0, as in AIAG
        if whole in components:
            components[whole] = components[whole].of(sum(components[piece].variance for piece in pieces if piece in components))
    return GaugeVariance(
        parts=p, operators=o, repeats=r, squares=squares, p_interaction=chance, pooled=pooled,
        repeatability=components["repeatability"], operator=components.get("operator"), interaction=components.get("interaction"),
        reproducibility=components.get("reproducibility"), gauge=components["gauge"], part=components["part"], total=components["total"],
    )  # fmt: skip


def _chance(interaction: MeanSquare, repeat: MeanSquare, nothing: float) -> float:
    """Chance of such an interaction where there is none; a mean square up to `nothing` is none.

    Beside repeats that are all identical any interaction is real, and where there is none either, chance explains it.
    """
    if repeat.value > nothing:
        return float(fdtrc(interaction.degrees, repeat.degrees, interaction.value / repeat.value))
    return 0.0 if interaction.value > nothing else 1.0


def _used(squares: Mapping[str, MeanSquare], pooled: bool) -> dict[str, MeanSquare]:
    """The mean squares that the components are made of."""
    if not pooled:
        return dict(squares)
    inner, error = squares["interaction"], squares["repeat"]
    degrees = inner.degrees + error.degrees
    return {
        "part": squares["part"],
        "operator": squares["operator"],
        "repeat": MeanSquare((inner.total + error.total) / degrees, degrees),
    }


def _terms(p: int, o: int, r: int, pooled: bool) -> dict[str, dict[str, float]]:
    """Each component as a sum of mean squares."""
    if o == 1:
        terms = {"repeatability": {"repeat": 1.0}, "part": {"part": 1.0 / r, "repeat": -1.0 / r}}
    elif pooled:
        terms = {
            "repeatability": {"repeat": 1.0},
            "operator": {"operator": 1.0 / (p * r), "repeat": -1.0 / (p * r)},
            "part": {"part": 1.0 / (o * r), "repeat": -1.0 / (o * r)},
        }
    else:
        terms = {
            "repeatability": {"repeat": 1.0},
            "operator": {"operator": 1.0 / (p * r), "interaction": -1.0 / (p * r)},
            "interaction": {"interaction": 1.0 / r, "repeat": -1.0 / r},
            "part": {"part": 1.0 / (o * r), "interaction": -1.0 / (o * r)},
        }
    between = [terms[name] for name in ("operator", "interaction") if name in terms]
    if between:
        terms["reproducibility"] = _sum(*between)
    terms["gauge"] = _sum(terms["repeatability"], *between)
    terms["total"] = _sum(terms["gauge"], terms["part"])
    return terms


def _sum(*parts: Mapping[str, float]) -> dict[str, float]:
    return {name: sum(part.get(name, 0.0) for part in parts) for name in dict.fromkeys(name for part in parts for name in part)}


def _component(weights: Mapping[str, float], squares: Mapping[str, MeanSquare]) -> Component:
    """A sum of mean squares with its interval (modified large samples: Graybill and Wang 1980, Ting et al. 1990)."""
    terms = [(weight, squares[name]) for name, weight in weights.items() if abs(weight) > 1e-12]
    value = sum(weight * square.value for weight, square in terms)
    low, high = _half_widths(terms)
    return Component(max(value, 0.0), max(value - low, 0.0), max(value + high, 0.0))


def _half_widths(terms: list[tuple[float, MeanSquare]]) -> tuple[float, float]:
    """How far the interval goes below and above."""
    tail = 0.5 * (1.0 - SHARE)
    below = above = 0.0
    for weight, square in terms:
        size = (weight * square.value) ** 2
        short, wide = _short(square.degrees, tail), _wide(square.degrees, tail)
        below += size * (short**2 if weight > 0.0 else wide**2)
        above += size * (wide**2 if weight > 0.0 else short**2)
    for plus, first in terms:
        for minus, second in terms:
            if plus > 0.0 > minus:
                size, n, m = plus * -minus * first.value * second.value, first.degrees, second.degrees
                upper, lower = float(fdtri(n, m, 1.0 - tail)), float(fdtri(n, m, tail))
                below += size * ((upper - 1.0) ** 2 - (_short(n, tail) * upper) ** 2 - _wide(m, tail) ** 2) / upper
                above += size * ((1.0 - lower) ** 2 - (_wide(n, tail) * lower) ** 2 - _short(m, tail) ** 2) / lower
    return math.sqrt(max(below, 0.0)), math.sqrt(max(above, 0.0))


def _short(degrees: int, tail: float) -> float:
    """How far a variance may lie below its mean square, as a share of it."""
    return 1.0 - degrees / float(chdtri(degrees, tail))


def _wide(degrees: int, tail: float) -> float:
    """How far above."""
    return degrees / float(chdtri(degrees, 1.0 - tail)) - 1.0

"""Repeated scans of the same gears: do they scatter as stated, and how much of it comes from who scans?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtrc, chdtri

from gearwear.arrays import Floats
from gearwear.fleet.anova import SHARE, GaugeVariance, gauge_variance
from gearwear.fleet.significance import beyond_chance


@dataclass(frozen=True, slots=True)
class Repeat:
    """One number of one scan of a study.

    Parameters
    ----------
    part : str
        Which gear, in which state.
    operator, repeat : str
    value, std : float
        nan where no standard deviation is stated.
    down, up : float
        How far below and above the range of the report reaches, where it leaves more open.
    found : bool
        False where no wear was found: then the value is 0 for want of one.
    """

    part: str
    operator: str
    repeat: str
    value: float
    std: float
    down: float = 0.0
    up: float = 0.0
    found: bool = True


class Accord(StrEnum):
    """Of the scatter of repeats with the stated standard deviations."""

    MORE = "repeats contradict the stated ±"
    OPERATORS = "operators contradict the stated ±"
    """Repeats by the same operator do not, but those by different ones do."""
    ALIKE = "repeats agree with the stated ±"
    RANGES = "repeats agree with the stated ranges, not with the ± alone"
    """They scatter more than the ±, and what the reports leave open beside it explains that."""
    LESS = "repeats scatter less than the stated ±"
    UNKNOWN = "no ± is stated"


@dataclass(frozen=True, slots=True)
class Scatter:
    """How far numbers scatter, over what is stated of them.

    Parameters
    ----------
    ratio, low, high : float
        Root mean square of deviation over stated standard deviation, with its 95 % interval.
    degrees : int
    p_value : float
        Chance of so much scatter where the stated ± is right, and the ranges.
    """

    ratio: float
    low: float
    high: float
    degrees: int
    p_value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class GaugeStudy:
    """A quantity in a gauge study.

    Parameters
    ----------
    quantity, flank : str
    parts, operators : tuple of str
        In the balanced study.
    repeats : int
    left_out : int
        Scans that did not fit in a balanced study, those that found no wear with them.
    variance : GaugeVariance or None
        None where there is no balanced study of two parts.
    stated : float
        Root mean square of the stated standard deviations; nan where there are none.
    repeatability : Scatter or None
        Of scans by the same operator, over what is stated; None where none is stated.
    reproducibility : Scatter or None
        Of all scans of a gear, whoever made them; None with one operator.
    accord : Accord
    without_wear : int
        Of those left out, how many found no wear.
    """

    quantity: str
    flank: str
    parts: tuple[str, ...]
    operators: tuple[str, ...]
    repeats: int
    left_out: int
    variance: GaugeVariance | None
    stated: float
    repeatability: Scatter | None
    reproducibility: Scatter | None
    accord: Accord = Accord.UNKNOWN
    without_wear: int = 0


def gauge_study(quantity: str, flank: str, scans: Sequence[Repeat]) -> GaugeStudy | None:
    """Analyse the repeats of one quantity.

    Parameters
    ----------
    quantity, flank : str
    scans : sequence of Repeat

    Returns
    -------
    GaugeStudy or None
        None where no gear was scanned twice by the same operator.
    """
    cells: dict[tuple[str, str], list[Repeat]] = {}
    for scan in sorted((scan for scan in scans if scan.found), key=lambda scan: (scan.part, scan.operator, scan.repeat)):
        cells.setdefault((scan.part, scan.operator), []).append(scan)
    repeated = {place: cell for place, cell in cells.items() if len(cell) > 1}
    if not repeated:
        return None
    parts, operators, repeats = _balanced({place: len(cell) for place, cell in repeated.items()})
    values = np.array([[[scan.value for scan in repeated[part, who][:repeats]] for who in operators] for part in parts])
    by_part: dict[str, list[Repeat]] = {}
    for (part, _), cell in repeated.items():
        by_part.setdefault(part, []).extend(cell)
    stated = [scan.std for cell in repeated.values() for scan in cell if scan.std > 0.0]
    return GaugeStudy(
        quantity=quantity,
        flank=flank,
        parts=parts,
        operators=operators,
        repeats=repeats,
        left_out=len(scans) - values.size,
        without_wear=sum(not scan.found for scan in scans),
        variance=gauge_variance(values) if len(parts) > 1 else None,
        stated=math.sqrt(float(np.mean(np.square(stated)))) if stated else math.nan,
        repeatability=scatter(repeated.values()),
        reproducibility=scatter(by_part.values()) if len(operators) > 1 else None,
    )


def in_accord(studies: Sequence[GaugeStudy]) -> list[GaugeStudy]:
    """The studies with what their repeats say of the stated ±: contradicted only where chance is out of question among all of them."""
    both = [*(study.repeatability for study in studies), *(study.reproducibility for study in studies)]
    more = beyond_chance([math.nan if scatter_ is None else scatter_.p_value for scatter_ in both])
    number = len(studies)
    return [
        replace(study, accord=_accord(study.repeatability, repeats, operators))
        for study, repeats, operators in zip(studies, more[:number], more[number:], strict=True)
    ]


def _accord(repeats: Scatter | None, more: bool, operators: bool) -> Accord:
    if repeats is None:
        return Accord.UNKNOWN
    if more or operators:
        return Accord.MORE if more else Accord.OPERATORS
    if repeats.low > 1.0 and repeats.p_value > 0.5 * (1.0 - SHARE):  # by the ± alone the chance is below this
        return Accord.RANGES
    return Accord.LESS if repeats.high < 1.0 else Accord.ALIKE


def scatter(groups: Iterable[Sequence[Repeat]]) -> Scatter | None:
    """Scatter within groups over the stated standard deviations: Σ ((x − weighted mean) / u)² is χ² with n − 1 degrees of freedom a group.

    Scans without a stated standard deviation are left out; None where no group has two others. For the chance each value counts from the nearest
    end of its range: what ranges can explain contradicts nothing.
    """
    square, least_square, degrees = 0.0, 0.0, 0
    for group in groups:
        known = [(scan.value, scan.std, scan.down, scan.up) for scan in group if scan.std > 0.0]
        if len(known) > 1:
            value, std, down, up = np.array(known).T
            mean = np.average(value, weights=1.0 / std**2)
            off = float(np.square((value - mean) / std).sum())
            square += off
            least_square += _least_square(value - down, value + up, std) if down.any() or up.any() else off
            degrees += len(known) - 1
    if not degrees:
        return None
    tail = 0.5 * (1.0 - SHARE)
    least, most = (math.sqrt(square / float(chdtri(degrees, share))) for share in (tail, 1.0 - tail))
    return Scatter(math.sqrt(square / degrees), least, most, degrees, float(chdtrc(degrees, least_square)))


def _least_square(low: Floats, high: Floats, std: Floats) -> float:
    """Σ ((distance from a mean to a range) / u)² for the mean of which it is least: where what pulls up is as much as what pulls down."""
    weights = 1.0 / np.square(std)

    def pull(mean: float) -> float:
        return float(weights @ (mean - np.clip(mean, low, high)))

    mean = brentq(pull, low.min(), high.max())
    return float(np.square((mean - np.clip(mean, low, high)) / std).sum())


def _balanced(sizes: Mapping[tuple[str, str], int]) -> tuple[tuple[str, ...], tuple[str, ...], int]:
    """Parts, operators and repeats of the largest balanced study: with so many operators that most scans are in it."""
    operators = sorted({who for _, who in sizes}, key=lambda who: (-sum(place[1] == who for place in sizes), who))
    parts = sorted({part for part, _ in sizes})
    best: tuple[tuple[str, ...], tuple[str, ...], int] = ((), (), 0)
    for number in range(1, len(operators) + 1):
        chosen = tuple(sorted(operators[:number]))
        full = tuple(part for part in parts if all((part, who) in sizes for who in chosen))
        repeats = min((sizes[part, who] for part in full for who in chosen), default=0)
        if _scans(full, chosen, repeats) >= _scans(*best):
            best = full, chosen, repeats
    return best


def _scans(parts: Sequence[str], operators: Sequence[str], repeats: int) -> int:
    return len(parts) * len(operators) * repeats

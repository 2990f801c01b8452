"""A straight line through measured numbers, and when it reaches a limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtrc, ndtri, stdtrit

from gearwear.arrays import Floats
from gearwear.design.quantity import NORMAL_95
from gearwear.fleet.significance import LEVEL, two_sided

BENT = 0.05
"""Chance below which points do not lie on a line for their stated scatter alone."""


@dataclass(frozen=True, slots=True)
class Pull:
    """What a number with a range does to a line: by how much more of it level and slope are more, and how far it may lie below and above.

    Parameters
    ----------
    level, slope : float
        Of the line, per unit of the number.
    down, up : float
        From the number to the ends of its range, 0 or more.
    """

    level: float
    slope: float
    down: float
    up: float

    def reach(self, off: float, level: float = 1.0) -> tuple[float, float]:
        """How far it may pull the line down and up at `off` from the middle; with a `level` of 0 and an `off` of 1 its slope."""
        share = level * self.level + off * self.slope
        down, up = (self.down, self.up) if share > 0.0 else (self.up, self.down)
        return abs(share) * down, abs(share) * up


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedLine:
    """y = level + slope · (x − middle), the scatter of level and slope independent of each other.

    Parameters
    ----------
    middle, level, slope : float
    level_std, slope_std : float
        Standard deviations.
    degrees : float
        Of freedom of these; inf where they come from stated ones.
    misfit : float
        χ² of the points per degree of freedom; nan where there are no more than two.
    bends : bool
        Whether the points lie further off the line than they scatter as stated; then the standard deviations are widened by √misfit
        (Birge's ratio).
    pulls : tuple of Pull
        Of the points that have a range beside their scatter.
    """

    middle: float
    level: float
    slope: float
    level_std: float
    slope_std: float
    degrees: float = math.inf
    misfit: float = math.nan
    bends: bool = False
    pulls: tuple[Pull, ...] = ()

    @property
    def p_value(self) -> float:
        """Chance of such a slope where there is none: of the least slope that the ranges leave."""
        return chance_of(self.slope, *self.slope_open, self.slope_std, self.degrees)

    @property
    def factor(self) -> float:
        """Standard deviations on either side of a 95 % interval."""
        share = 1.0 - 0.5 * LEVEL
        return float(ndtri(share) if math.isinf(self.degrees) else stdtrit(self.degrees, share))

    @property
    def slope_open(self) -> tuple[float, float]:
        """How far below and above the slope may lie for the ranges alone, each number anywhere in its own."""
        return _summed(pull.reach(1.0, level=0.0) for pull in self.pulls)

    @property
    def slope_interval(self) -> tuple[float, float]:
        """95 %, with all that the ranges leave open."""
        return interval(self.slope, *self.slope_open, self.factor * self.slope_std)

    def at(self, x: float) -> tuple[float, float]:
        """The line and its standard deviation at a place."""
        return self.level + self.slope * (x - self.middle), math.hypot(self.level_std, (x - self.middle) * self.slope_std)

    def band(self, x: float) -> tuple[float, float]:
        """The 95 % interval of the line at a place, with all that the ranges leave open."""
        y, std = self.at(x)
        return interval(y, *_summed(pull.reach(x - self.middle) for pull in self.pulls), self.factor * std)


def interval(value: float, down: float, up: float, expanded: float) -> tuple[float, float]:
    """The ends of an interval: as far as a range goes, and its scatter beyond."""
    return value - down - expanded, value + up + expanded


def beyond(value: float, std: float, low: float, high: float) -> tuple[float, float]:
    """How far below and above a number its range reaches, where that is further than the 95 % of its scatter; else 0.

    >>> beyond(10.0, 1.0, 8.04, 15.0), beyond(10.0, 1.0, math.nan, math.nan)
    ((0.0, 5.0), (0.0, 0.0))
    """
    own, down, up = NORMAL_95 * std * (1.0 + 1e-9), value - low, high - value
    return down if down > own else 0.0, up if up > own else 0.0


def own_range(value: float, std: float, low: float, high: float) -> tuple[float, float]:
    """What a scan says that its number lies between: its range, else its own 95 %."""
    own = NORMAL_95 * std if math.isfinite(std) else 0.0
    return low if math.isfinite(low) else value - own, high if math.isfinite(high) else value + own


def chance_of(value: float, down: float, up: float, std: float, degrees: float = math.inf) -> float:
    """Chance of a number so far from 0 where it is 0, if its range may be all of it that the scatter is not.

    >>> round(chance_of(5.0, 0.0, 0.0, 2.0), 4), round(chance_of(5.0, 3.0, 9.0, 1.0), 4), chance_of(5.0, 6.0, 0.0, 1.0)
    (0.0124, 0.0455, 1.0)
    """
    least = max(value - down, 0.0) if value > 0.0 else min(value + up, 0.0)
    return two_sided(least / std if std > 0.0 else math.nan, degrees)


def _summed(reaches_: Iterable[tuple[float, float]]) -> tuple[float, float]:
    every = list(reaches_)
    return sum(down for down, _ in every), sum(up for _, up in every)


def fit_line(x: Floats, y: Floats, std: Floats, down: Floats | None = None, up: Floats | None = None) -> FittedLine | None:
    """Weighted least squares.

    Parameters
    ----------
    x, y, std : (n,) float
        Places, numbers and their standard deviations; 0 where a number has a range alone.
    down, up : (n,) float or None
        How far below and above each number its range reaches, beside its scatter; None: not at all.

    Returns
    -------
    FittedLine or None
        None where there are fewer than two places.

    Notes
    -----
    A number weighs by half the longer arm of its 95 % interval, ``std + max(down, up) / 2``. Scatter goes through as variance. What a range
    leaves open may differ from number to number, so it goes through with its worst sign at each: it does not average out.
    """
    if len(x) < 2 or np.ptp(x) <= 0.0:
        return None
    down, up = (np.zeros(len(x)) if arm is None else arm for arm in (down, up))
    arm = std + 0.5 * np.maximum(down, up)
    weight = 1.0 / np.square(arm)
    middle = float(np.average(x, weights=weight))
    spread = float((weight * np.square(x - middle)).sum())
    of_level, of_slope = weight / weight.sum(), weight * (x - middle) / spread
    degrees = len(x) - 2
    square = float((weight * np.square(y - of_level @ y - of_slope @ y * (x - middle))).sum())
    bends = degrees > 0 and float(chdtrc(degrees, square)) < BENT
    scatter = math.sqrt(square / degrees) * arm if bends else std
    variance = float(np.square(of_slope * scatter).sum())
    if variance > 0.0:  # from where level and slope do not scatter together
        moved = -float((of_level * of_slope * np.square(scatter)).sum()) / variance
        middle, of_level = middle + moved, of_level + moved * of_slope
    return FittedLine(
        middle=middle,
        level=float(of_level @ y),
        slope=float(of_slope @ y),
        level_std=math.sqrt(float(np.square(of_level * scatter).sum())),
        slope_std=math.sqrt(variance),
        degrees=float(degrees) if bends else math.inf,
        misfit=square / degrees if degrees > 0 else math.nan,
        bends=bends,
        pulls=tuple(
            Pull(*map(float, one)) for one in zip(of_level, of_slope, down, up, strict=True) if one[2] > 0.0 or one[3] > 0.0
        ),
    )


def line_from_new(x: float, y: float, std: float, down: float = 0.0, up: float = 0.0) -> FittedLine:
    """The line from nothing at x = 0 through one point, with its standard deviation and how far its range reaches below and above."""
    pulls = (Pull(0.0, 1.0 / x, down, up),) if down > 0.0 or up > 0.0 else ()
    return FittedLine(middle=0.0, level=0.0, slope=y / x, level_std=0.0, slope_std=std / x, pulls=pulls)


@dataclass(frozen=True, slots=True)
class Reach:
    """A number with its 95 % interval; inf where there is no end."""

    value: float
    low: float
    high: float


def reaches(line: FittedLine, limit: float, now: float) -> Reach:
    """How far from `now` on a line reaches a limit.

    Parameters
    ----------
    line : FittedLine
    limit : float
    now : float
        A place.

    Returns
    -------
    Reach
        0 where it is reached by now; inf where the line never gets there. The interval ends where the upper and the lower edge of the
        line's 95 % band reach the limit; where the slope might be 0 it has no end.

    Notes
    -----
    These are the places where the line cannot be told from the limit (Fieller 1954), with what ranges leave open beside the scatter. The upper
    edge is convex and the lower one concave: far ahead they run as the ends of the slope's interval do.
    """
    (below, above), (slowest, fastest), y = line.band(now), line.slope_interval, line.at(now)[0]
    value = (limit - y) / line.slope if line.slope > 0.0 else math.inf
    return Reach(
        0.0 if y >= limit else value,
        0.0 if above >= limit else _crossing(lambda ahead: line.band(now + ahead)[1] - limit, above - limit, fastest),
        0.0 if below >= limit else _crossing(lambda ahead: line.band(now + ahead)[0] - limit, below - limit, slowest),
    )


def _crossing(gap: Callable[[float], float], gap_now: float, far_slope: float) -> float:
    """Where a gap that is below 0 now, and far ahead rises by `far_slope`, is closed; inf where it never is for good.

    An edge that is convex rises by less at first, one that is concave by more: no step beyond is further than twice the last.
    """
    if not far_slope > 0.0 or not math.isfinite(ahead := -gap_now / far_slope):
        return math.inf
    while gap(ahead) < 0.0:
        ahead *= 2.0
        if math.isinf(ahead):
            return math.inf
    return float(brentq(gap, 0.0, ahead, xtol=1e-12 * ahead, rtol=1e-12))

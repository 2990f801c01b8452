"""A straight line through measured numbers, and when it reaches a limit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, ndtri, stdtrit

from gearwear.arrays import Floats
from gearwear.fleet.significance import LEVEL, two_sided

BENT = 0.05
"""Chance below which points do not lie on a line for their stated scatter alone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedLine:
    """y = level + slope · (x − middle), level and slope independent of each other.

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
    """

    middle: float
    level: float
    slope: float
    level_std: float
    slope_std: float
    degrees: float = math.inf
    misfit: float = math.nan
    bends: bool = False

    @property
    def p_value(self) -> float:
        """Chance of such a slope where there is none."""
        return two_sided(self.slope / self.slope_std if self.slope_std > 0.0 else math.nan, self.degrees)

    @property
    def factor(self) -> float:
        """Standard deviations on either side of a 95 % interval."""
        share = 1.0 - 0.5 * LEVEL
        return float(ndtri(share) if math.isinf(self.degrees) else stdtrit(self.degrees, share))

    def at(self, x: float) -> tuple[float, float]:
        """The line and its standard deviation at a place."""
        return self.level + self.slope * (x - self.middle), math.hypot(self.level_std, (x - self.middle) * self.slope_std)


def fit_line(x: Floats, y: Floats, std: Floats) -> FittedLine | None:
    """Weighted least squares.

    Parameters
    ----------
    x, y, std : (n,) float
        Places, numbers and their standard deviations, above 0.

    Returns
    -------
    FittedLine or None
        None where there are fewer than two places.
    """
    if len(x) < 2 or np.ptp(x) <= 0.0:
        return None
    weight = 1.0 / np.square(std)
    middle, level = (float(np.average(values, weights=weight)) for values in (x, y))
    spread = float((weight * np.square(x - middle)).sum())
    slope = float((weight * (x - middle) * (y - level)).sum()) / spread
    degrees = len(x) - 2
    square = float((weight * np.square(y - level - slope * (x - middle))).sum())
    bends = degrees > 0 and float(chdtrc(degrees, square)) < BENT
    wider = math.sqrt(square / degrees) if bends else 1.0
    return FittedLine(
        middle=middle,
        level=level,
        slope=slope,
        level_std=wider / math.sqrt(float(weight.sum())),
        slope_std=wider / math.sqrt(spread),
        degrees=float(degrees) if bends else math.inf,
        misfit=square / degrees if degrees > 0 else math.nan,
        bends=bends,
    )


def line_from_new(x: float, y: float, std: float) -> FittedLine:
    """The line from nothing at x = 0 through one point."""
    return FittedLine(middle=0.0, level=0.0, slope=y / x, level_std=0.0, slope_std=std / x)


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
    These are the places where the line cannot be told from the limit (Fieller 1954): with the gap A = level − limit and τ = x − middle
    the roots of ``(A + slope τ)² = k² (u_level² + τ² u_slope²)``.
    """
    from_middle, gap, k = now - line.middle, line.level - limit, line.factor
    y, std = line.at(now)
    roots = _roots(line.slope**2 - (k * line.slope_std) ** 2, gap * line.slope, gap**2 - (k * line.level_std) ** 2)
    value = (limit - y) / line.slope if line.slope > 0.0 else math.inf
    low = min((root - from_middle for root in roots if root > from_middle and gap + line.slope * root <= 0.0), default=math.inf)
    high = min((root - from_middle for root in roots if root > from_middle and gap + line.slope * root >= 0.0), default=math.inf)
    rises = line.slope > k * line.slope_std
    return Reach(
        0.0 if y >= limit else value,
        0.0 if y + k * std >= limit else low,
        0.0 if y - k * std >= limit else high if rises else math.inf,
    )


def _roots(a: float, b: float, c: float) -> list[float]:
    """Of a x² + 2 b x + c, without the loss of digits where a is small."""
    square = b * b - a * c
    if square < 0.0:
        return []
    q = -(b + math.copysign(math.sqrt(square), b))
    return [top / bottom for top, bottom in ((q, a), (c, q)) if bottom != 0.0]

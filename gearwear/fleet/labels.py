"""Quantities and numbers in words."""

from __future__ import annotations

import math
from datetime import datetime

from gearwear.design.quantity import SPACE, pretty_unit, significant, with_std
from gearwear.fleet.line import Reach
from gearwear.fleet.trend import CYCLES, Trend

UNITS = ("mm3", "mm2", "mm", "um", "deg")
TITLES = {
    "wear_volume": "worn volume", "wear_area": "worn area", "wear_depth": "deepest wear", "thickness_loss": "loss of thickness",
    "lost_volume": "lost volume", "law_sliding_depth": "depth by sliding (law)", "thickness_min": "thinnest tooth",
}  # fmt: skip
MILLION = 1e6


def unit_of(quantity: str) -> str:
    """
    >>> unit_of("wear_volume_mm3")
    'mm³'
    """
    end = quantity.rsplit("_", 1)[-1]
    return pretty_unit(end) if end in UNITS else ""


def title_of(quantity: str, flank: str = "") -> str:
    """
    >>> title_of("wear_depth_mm"), title_of("profile_slope_um", "left")
    ('deepest wear', 'profile slope, left')
    """
    name = quantity.rsplit("_", 1)[0] if unit_of(quantity) else quantity
    return ", ".join(filter(None, (TITLES.get(name, name.replace("_", " ")), flank)))


def shown(quantity: str, value: float, std: float) -> str:
    """A value with its ± and unit."""
    return with_std(value, std, unit_of(quantity))


def rate_words(trend: Trend) -> str:
    """The rate with its ±, per million cycles or per year of 365.25 days; where ranges leave more open, its 95 % interval."""
    if trend.line is None:
        return "–"
    factor, per = (MILLION, "10⁶ cycles") if trend.clock == CYCLES else (365.25, "year")
    between = ""
    if any(trend.line.slope_open):
        between = f" ({' to '.join(significant(factor * end) for end in trend.line.slope_interval)})"
    return f"{shown(trend.quantity, factor * trend.line.slope, factor * trend.line.slope_std)}{between} per {per}"


def left_words(trend: Trend) -> str:
    """How long until the limit, with the 95 % interval: in time where that is known, else in cycles."""
    if trend.left is None:
        return ""
    if trend.left.value == 0.0:
        return "reached by its line"
    days = trend.days_left
    if days is not None:
        return _span(days, *_time_unit(days))
    return _span(trend.left, MILLION, f"{SPACE}× 10⁶ cycles")


def _time_unit(days: Reach) -> tuple[float, str]:
    far = days.value if math.isfinite(days.value) else days.low
    if far < 60.0:
        return 1.0, " days"
    return (30.4375, " months") if far < 730.0 else (365.25, " years")


def _span(span: Reach, unit: float, name: str) -> str:
    def end(value: float) -> str:
        return "never" if math.isinf(value) else significant(value / unit, 2)

    if math.isinf(span.value):
        if span.low == 0.0:
            return "never if it goes on along its line, but it may be soon"
        return "not by its line" if math.isinf(span.low) else f"not before {end(span.low)}{name}"
    if span.low == 0.0 and math.isinf(span.high):
        return f"whether and when it reaches the limit is open (by its line in {end(span.value)}{name})"
    if span.low == 0.0:
        between = f"up to {end(span.high)}"
    else:
        between = f"{end(span.low)} to {end(span.high)}" if math.isfinite(span.high) else f"from {end(span.low)} on"
    return f"{end(span.value)}{name} ({between})"


def date_words(moment: datetime | None) -> str:
    return "" if moment is None else moment.date().isoformat()

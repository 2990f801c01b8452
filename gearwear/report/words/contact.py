"""Within what limits the numbers of the contact lie where the scan leaves them open, in words."""

from __future__ import annotations

from gearwear.comparison.contact_readings import ReadOtherwise
from gearwear.comparison.results import PairResult
from gearwear.design.quantity import NORMAL_95, SPACE, number

SHORT = {
    ReadOtherwise.SIDES: "worn or made so",
    ReadOtherwise.PATTERN: "a form that may be the scanner's",
    ReadOtherwise.CARRIED: "a form that the worn side may have too",
    ReadOtherwise.EITHER: "made so or scanned so",
    ReadOtherwise.TOGETHER: "effects that take each other back",
    ReadOtherwise.UNSURE: "loss of flanks that look worn",
    ReadOtherwise.VIEWS: "views that lie apart",
}
"""What leaves them open, beside a number, without a comma, at which a terminal may cut it."""


def reaches_beyond(value: float, std: float, limits: tuple[float, float] | None, digits: int) -> bool:
    """Whether limits go beyond the value's own 95 % interval by what can be seen in so many digits."""
    if limits is None:
        return False
    return max(value - limits[0], limits[1] - value) > NORMAL_95 * std + 0.5 * 10.0**-digits


def between(limits: tuple[float, float], digits: int, unit: str = "") -> str:
    """
    >>> between((0.0, 16.77), 1, "µm").replace(SPACE, " ")
    '0.0 to 16.8 µm'
    """
    return f"{number(limits[0], digits)} to {number(limits[1], digits)}" + (f"{SPACE}{unit}" if unit else "")


def why_open(pair: PairResult) -> str:
    """What leaves the contact open, in few words; "" where nothing does."""
    return "" if pair.limits is None else SHORT[pair.limits.why[0]]

"""From a deviation and its uncertainty to a class, or to the statement that it cannot be told."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from gearwear.design.conformity import Conformity, conformity
from gearwear.design.side import Side
from gearwear.inspection.estimate import RESOLVABLE_SHARE
from gearwear.inspection.radial import RADIAL_SYMBOLS
from gearwear.inspection.tolerances import CLASSES, SYMBOLS, Edition, Size, least_class, tolerances


class Verdict(StrEnum):
    """What a measured deviation says."""

    GRADED = "graded"
    WITHIN = "within tolerance"
    EXCEEDS = "exceeds tolerance"
    NEITHER = "neither proven"
    """Of a required class: the tolerance lies within U of the value."""
    COARSER = "coarser than every class"
    NOT_RESOLVABLE = "not resolvable"
    NOT_SEEN = "not seen"
    NO_TOLERANCE = "no tolerance"


DECIDED = {Conformity.CONFORMING: Verdict.WITHIN, Conformity.NOT_CONFORMING: Verdict.EXCEEDS, Conformity.NEITHER: Verdict.NEITHER}
"""What a required class says."""


@dataclass(frozen=True, slots=True)
class Grade:
    """Class and verdict of one deviation.

    Parameters
    ----------
    iso_class : int or None
        Least class whose tolerance the value does not exceed.
    resolvable_class : int or None
        Least class for which U is at most 30 % of the tolerance.
    met_class : int or None
        Least of those whose tolerance is met for certain: the value and U together do not exceed it.
    tolerance : float
        Tolerance in mm of the required class, else of `iso_class`; nan where there is none.
    verdict : Verdict
    """

    iso_class: int | None
    resolvable_class: int | None
    met_class: int | None
    tolerance: float
    verdict: Verdict


@dataclass(frozen=True, slots=True)
class Finding:
    """The worst of one deviation, graded.

    Parameters
    ----------
    quantity : str
        Field of `Tolerances`, or one of `RADIAL_SYMBOLS`.
    side : Side or None
        None where both sides enter.
    tooth : int or None
        0-based, where the worst value is; None where it belongs to the whole gear.
    value, expanded, noise : float
        mm, with sign where the deviation has one; U (k = 2, with `noise`); the most the scan's noise may have added.
    seen : int
        Flanks (or spaces) behind it.
    grade : Grade
    """

    quantity: str
    side: Side | None
    tooth: int | None
    value: float
    expanded: float
    noise: float
    seen: int
    grade: Grade

    @property
    def symbol(self) -> str:
        return SYMBOLS.get(self.quantity) or RADIAL_SYMBOLS[self.quantity]

    @property
    def statement(self) -> str:
        """The verdict in words, with the class."""
        mark = self.grade
        if mark.verdict is Verdict.GRADED:
            return f"class {mark.iso_class}"
        if mark.verdict is Verdict.NOT_RESOLVABLE and mark.met_class is not None:
            return f"not resolvable; meets class {mark.met_class}"
        if mark.verdict is Verdict.NOT_SEEN and self.seen:
            return f"not all seen ({self.seen} of them)"
        return str(mark.verdict)


def grade(
    quantity: str,
    value: float,
    expanded: float,
    size: Size,
    edition: Edition = Edition.ISO_2013,
    required: int | None = None,
    sector: int | None = None,
) -> Grade:
    """Grade a deviation.

    Parameters
    ----------
    quantity : str
        Field of `Tolerances`.
    value, expanded : float
        Deviation and its expanded uncertainty U, mm.
    size, edition
        See `tolerances`.
    required : int or None
        Class the drawing asks for; None: find the class.
    sector : int or None
        See `tolerances`.

    Returns
    -------
    Grade

    Raises
    ------
    InputError
        If the gear or the required class is outside the edition's range.

    Notes
    -----
    Where U is over 30 % of the tolerance the verdict is "not resolvable", unless the value exceeds the tolerance by more than U: that is
    proven all the same. A required class is decided by ISO 14253-1: kept where value and U together do not exceed the tolerance, not kept where the value
    exceeds it by more than U, and in between neither is proven. The class that is found is that of the value alone.

    Examples
    --------
    >>> size = Size(76.2, 6.35, 15.0, 12)
    >>> grade("profile_slope", 0.017, 0.004, size).verdict, grade("profile_slope", 0.017, 0.009, size).verdict
    (<Verdict.GRADED: 'graded'>, <Verdict.NOT_RESOLVABLE: 'not resolvable'>)
    """

    def tolerance(iso_class: int) -> float:
        return float(getattr(tolerances(size, iso_class, edition, sector), quantity))

    return graded(value, expanded, tolerance, CLASSES[edition], required)


def graded(
    value: float, expanded: float, tolerance: Callable[[int], float], classes: range, required: int | None = None
) -> Grade:
    """Grade a deviation by the tolerance (mm) that any of some classes has; parameters and judgement as `grade`."""
    judged = classes[-1] if required is None else required
    if math.isnan(tolerance(judged)):
        return Grade(None, None, None, math.nan, Verdict.NO_TOLERANCE)
    if math.isnan(value):
        return Grade(None, None, None, tolerance(judged) if required is not None else math.nan, Verdict.NOT_SEEN)
    iso_class_found = least_class(value, tolerance, classes)
    resolvable = [c for c in classes if expanded <= RESOLVABLE_SHARE * tolerance(c)]
    met = next((c for c in resolvable if abs(value) + expanded <= tolerance(c) + 1e-12), None)
    if required is None and iso_class_found is not None:
        judged = iso_class_found
    limit = tolerance(judged)
    resolved = expanded <= RESOLVABLE_SHARE * limit
    over = abs(value) > limit + 1e-12
    if not resolved and not abs(value) - expanded > limit:
        verdict = Verdict.NOT_RESOLVABLE
    elif required is not None:
        verdict = DECIDED[conformity(abs(value) - expanded, abs(value) + expanded - 1e-12, limit)]
    else:
        verdict = Verdict.COARSER if over else Verdict.GRADED
    return Grade(iso_class_found, resolvable[0] if resolvable else None, met, limit, verdict)

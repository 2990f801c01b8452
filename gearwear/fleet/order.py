"""In what order the inspections of a gear were, and which of them may be its last."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from typing import Any

FALLS = "cycles_run falls from a date to a later one"
"""What is said of dates and cycles that contradict each other."""


@dataclass(frozen=True, slots=True)
class Occasion:
    """When an inspection was; scans of which all this is the same are of one.

    Parameters
    ----------
    inspected : datetime or None
    cycles : float or None
        Run since new.
    which : int
        Tells those apart that have neither.
    """

    inspected: datetime | None = None
    cycles: float | None = None
    which: int = 0


@dataclass(frozen=True, slots=True)
class Order:
    """The inspections of a gear in their order.

    Parameters
    ----------
    inspections : tuple of Occasion
        Each once; in some order where it is not `known`, those of `last` at the end all the same.
    last : frozenset of Occasion
        Those that may be the last: one, where that is known.
    known : bool
    note : str
        What the reader must know of it; "" where there is nothing.
    """

    inspections: tuple[Occasion, ...]
    last: frozenset[Occasion]
    known: bool = True
    note: str = ""

    @property
    def places(self) -> dict[Occasion, int]:
        """Place of each in the order."""
        return {one: i for i, one in enumerate(self.inspections)}


def order_of(inspections: Iterable[Occasion]) -> Order:
    """Order the inspections of one gear: by cycles, which are what wears it, where all have them; else by dates where all have one.

    Parameters
    ----------
    inspections : iterable of Occasion

    Notes
    -----
    Cycles that fall from a date to a later one are not gone by: a date is written down on its day, a counter may have been set back. Any
    inspection may be the last that is neither before the latest date nor below the most cycles.

    Examples
    --------
    >>> new, worn = Occasion(cycles=0.0), Occasion(datetime(2026, 3, 1), 1e6)
    >>> order_of([worn, new]).inspections == (new, worn)
    True
    >>> order_of([worn, Occasion()]).note
    'which of 2 inspections is the last is not known, the worst counts: 1 of 2 without inspected, 1 of 2 without cycles_run'
    """
    every = set(inspections)
    dates = [one.inspected for one in every if one.inspected is not None]
    cycles = [one.cycles for one in every if one.cycles is not None]
    both = sorted((one.inspected, one.cycles) for one in every if one.inspected is not None and one.cycles is not None)
    falls = any(after < before for (_, before), (_, after) in pairwise(both))
    by_cycles = len(cycles) == len(every) and not falls
    known = by_cycles or len(dates) == len(every) or len(every) == 1
    latest = max(dates, default=datetime.min)
    most = -math.inf if falls else max(cycles, default=-math.inf)
    last = frozenset(one for one in every if (one.inspected or latest) >= latest and (one.cycles is None or one.cycles >= most))

    def place(one: Occasion) -> tuple[Any, ...]:
        date, run = one.inspected or datetime.min, -1.0 if one.cycles is None else one.cycles
        return one in last, *((run, date) if by_cycles else (date, run)), one.which

    found = {"inspected": len(dates), "cycles_run": len(cycles)}
    missing = [f"{len(every) - number} of {len(every)} without {name}" for name, number in found.items() if number < len(every)]
    return Order(tuple(sorted(every, key=place)), last, known, _note(len(last), known, falls, missing))


def _note(last: int, known: bool, falls: bool, missing: list[str]) -> str:
    """What the reader must know of an order; `missing` says of how many inspections what does not stand there."""
    why = ", ".join([*missing, *([FALLS] if falls else [])])
    if last > 1:
        return f"which of {last} inspections is the last is not known, the worst counts: {why}"
    if not known:
        return f"the order of the inspections before the last is not known: {why}"
    return f"{FALLS}: the order is that of the dates" if falls else ""

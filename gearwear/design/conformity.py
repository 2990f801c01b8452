"""Whether a measured number keeps a limit, by the decision rule of ISO 14253-1."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

COVERAGE = 2.0
"""Standard deviations in the expanded uncertainty U, as in the room of inspection."""


class Conformity(StrEnum):
    """Of a number with a limit."""

    CONFORMING = "conforming"
    NOT_CONFORMING = "not conforming"
    NEITHER = "neither"
    """Neither can be proven: the limit lies within the uncertainty."""


GOOD_TO_BAD = (Conformity.CONFORMING, Conformity.NEITHER, Conformity.NOT_CONFORMING)
"""Which of several decides."""


def conformity(least: float, most: float, limit: float) -> Conformity:
    """Whether a number keeps an upper limit.

    Parameters
    ----------
    least, most : float
        Between what it lies: the number less and with its expanded uncertainty U, and what a range leaves open beyond; nan where none is
        stated.
    limit : float
        Of the same unit.

    Returns
    -------
    Conformity

    Notes
    -----
    ISO 14253-1: with U = 2 u a number y conforms if ``y + U <= limit``, does not if ``y − U > limit``, and in between neither is proven.
    The edition of 2017 asks for 95 % by default, for which 1.65 u would do with one limit; 2 u is on the safe side of it, and what the
    inspection takes. Where nothing is stated nothing is proven.

    Examples
    --------
    >>> [str(conformity(value - 0.02, value + 0.02, 0.1)) for value in (0.07, 0.09, 0.11, 0.13)]
    ['conforming', 'neither', 'neither', 'not conforming']
    """
    if most <= limit:
        return Conformity.CONFORMING
    return Conformity.NOT_CONFORMING if least > limit else Conformity.NEITHER


def worst(judged: Iterable[Conformity]) -> Conformity | None:
    """The worst of several; None of none.

    >>> str(worst([Conformity.CONFORMING, Conformity.NEITHER]))
    'neither'
    """
    return max(judged, key=GOOD_TO_BAD.index, default=None)


def exit_status(judged: Iterable[Conformity]) -> int:
    """For scripts: 0 all conform, or nothing has a limit; 1 one does not; 3 neither can be said of one.

    >>> exit_status([]), exit_status([Conformity.NEITHER]), exit_status([Conformity.NEITHER, Conformity.NOT_CONFORMING])
    (0, 3, 1)
    """
    return {Conformity.NOT_CONFORMING: 1, Conformity.NEITHER: 3}.get(worst(judged) or Conformity.CONFORMING, 0)

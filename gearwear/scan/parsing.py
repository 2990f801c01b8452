"""Numbers out of text and promises out of headers: what the readers share."""

from __future__ import annotations

import warnings

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError

SPACE, NEWLINE = 32, 10
MOST_UNPACKED = 200
"""A compressed file may become this many times as large; scans stay below 20."""


def parse_numbers(text: bytes) -> Floats:
    """All numbers of a text that holds nothing but numbers and white space.

    Parameters
    ----------
    text : bytes
        Numbers with a decimal point; "nan" and "inf" are numbers.

    Returns
    -------
    (n,) float

    Raises
    ------
    ValueError
        If something in it is no number.

    Examples
    --------
    >>> parse_numbers(b"1 2.5e1 -3\\n")
    array([ 1., 25., -3.])
    """
    text = text.strip()
    if not text:
        return np.empty(0)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # how older numpy says that it stopped half-way
        try:
            return np.fromstring(text, sep=" ")
        except DeprecationWarning as stopped:
            raise ValueError(str(stopped)) from None


def tokens_per_line(text: bytes) -> Ints:
    """How many words each line holds, blank lines left out, (lines,) int.

    >>> tokens_per_line(b"1 2 3\\n\\n 4 5")
    array([3, 2])
    """
    letters = np.frombuffer(text, np.uint8)
    if not letters.size:
        return np.empty(0, np.intp)
    white = letters <= SPACE
    starts = ~white
    starts[1:] &= white[:-1]
    line = np.searchsorted(np.flatnonzero(letters == NEWLINE), np.flatnonzero(starts))
    counts = np.bincount(line)
    return counts[counts > 0]


def check_count(what: str, promised: int, least_bytes: int, held_bytes: int) -> None:
    """Refuse a header that promises more than the file can hold, before any memory is asked for.

    Parameters
    ----------
    what : str
        "points", "triangles": named in the message.
    promised : int
        The header's count.
    least_bytes : int
        Fewest bytes that one of them takes.
    held_bytes : int
        Bytes that are there.

    Raises
    ------
    InputError
        If they do not hold that many.
    """
    if promised * least_bytes > held_bytes:
        held = held_bytes // least_bytes
        raise InputError(
            f"the header promises {promised:,} {what} and the file has room for {held:,}: it is cut off or its header is wrong; a complete file would be right"
        )


def short_by(what: str, promised: int, held: int) -> InputError:
    """The error of a text file whose header promises another number of `what` than it holds."""
    return InputError(f"the header promises {promised:,} {what} and the file holds {held:,}: a complete file would be right")


def not_installed(kind: str, package: str) -> InputError:
    """The error of a format whose package is an extra that is missing."""
    return InputError(f'reading {kind} needs {package}, which is not installed: pip install "gearwear[scans]"')

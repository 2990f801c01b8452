"""How much memory a file may ask for: what it needs follows from its counts, and is known before it is read.

A count alone is no promise: a header can say anything, a packed file can be nearly empty, one surface can be placed a thousand times. So each
reader works out from the bytes that it holds how many points and triangles can come out, and asks here before it makes the first array.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from gearwear.errors import InputError, NotEnoughMemory

GB = 1e9
DEFAULT = 4.0
"""GB of memory that a file may need where nothing else is said."""
POINT = 400
"""Bytes that a point takes at most at any one time, from the file to the report: measured on 0.1 to 1.5 million points, rounded up."""
TRIANGLE = 700
"""Bytes that a triangle takes at most while its corners are merged: measured on STL, which has three corners of its own in every triangle."""

_allowed: ContextVar[float] = ContextVar("allowed", default=DEFAULT * GB)


@contextmanager
def allowing(gigabytes: float) -> Iterator[None]:
    """Files read in the body may need so much memory.

    Parameters
    ----------
    gigabytes : float
        Of 10⁹ bytes.

    Raises
    ------
    InputError
        If it is no amount of memory.
    """
    if not 0.0 < gigabytes < math.inf:
        raise InputError(f"memory = {gigabytes:g} GB: above 0, such as {DEFAULT:g}, would be right")
    token = _allowed.set(gigabytes * GB)
    try:
        yield
    finally:
        _allowed.reset(token)


def allowed() -> int:
    """Bytes that a file may need."""
    return int(_allowed.get())


def check_memory(points: int = 0, triangles: int = 0, other: int = 0) -> None:
    """Refuse a file that would need more memory than is allowed.

    Parameters
    ----------
    points, triangles : int
        That come out of it.
    other : int
        Bytes beside them.

    Raises
    ------
    NotEnoughMemory
        With the counts, what they need and what would be right.

    Examples
    --------
    >>> check_memory(points=1_000_000)
    >>> check_memory(points=100_000_000)
    Traceback (most recent call last):
    ...
    gearwear.errors.NotEnoughMemory: its 100,000,000 points would need 40 GB of memory and 4 GB are allowed: a thinner scan, or memory = 40 GB, would be right
    """
    needed = points * POINT + triangles * TRIANGLE + other
    if needed <= allowed():
        return
    counts = [f"{count:,} {what}" for what, count in (("points", points), ("triangles", triangles)) if count]
    amount = math.ceil(10.0 * min(needed / GB, 1e12)) / 10.0
    raise NotEnoughMemory(
        f"its {' and '.join(counts) or 'contents'} would need {amount:g} GB of memory and {allowed() / GB:g} GB are allowed: a thinner scan, or memory = {math.ceil(amount):d} GB, would be right"
    )

"""The one error a user is meant to read, and names of files as it shows them."""

from __future__ import annotations

from types import UnionType
from typing import TYPE_CHECKING
from unicodedata import category

if TYPE_CHECKING:
    from gearwear.arrays import Floats


class InputError(ValueError):
    """An input or an argument is wrong.

    The message is one line that names the file, line or value, says what is wrong and what
    would be right. The commands print it and exit with status 2.
    """


class NotEnoughMemory(InputError):
    """A file is sound, and needs more memory than it may."""


class NotThisGear(InputError):
    """A scan is not of the design it was given with.

    Parameters
    ----------
    points : (n, 3) float
        The scan, mm: `gearwear.identify` can say what it looks like by itself.
    planar : bool
        True for a planar section.
    message : str
    """

    def __init__(self, points: Floats, planar: bool, message: str) -> None:
        super().__init__(message)
        self.points, self.planar = points, planar

    def __reduce__(self) -> tuple[type[NotThisGear], tuple[Floats, bool, str]]:
        """Made anew in another process, which an error's own way would try with the message alone."""
        return type(self), (self.points, self.planar, str(self))


def check_kind(value: object, kind: type | UnionType, name: str, right: str) -> None:
    """Refuse what a stage of the API does not take, a file's name above all, before it ends in an AttributeError.

    >>> check_kind("scan.ply", float, "scan", "what gw.read_scan returns")
    Traceback (most recent call last):
    gearwear.errors.InputError: scan of type str: what gw.read_scan returns would be right
    """
    if not isinstance(value, kind):
        raise InputError(f"{name} of type {type(value).__name__}: {right} would be right")


def printable(text: str) -> str:
    """A text on one line and without what moves a cursor or changes colours: words of a damaged file may hold anything.

    >>> printable("SIZE \\x1b[2J4\\n µm")
    'SIZE \\\\x1b[2J4\\\\n µm'
    """
    return "".join(
        letter.encode("unicode_escape").decode() if category(letter)[0] == "C" or category(letter) in ("Zl", "Zp") else letter
        for letter in text
    )


def readable(name: object) -> str:
    """A file's name as text that can be written anywhere: bytes of it that are no UTF-8 appear as ``\\xff``.

    >>> readable("müll\\udcff.ply")
    'müll\\\\xff.ply'
    """
    return str(name).encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")

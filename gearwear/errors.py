"""The one error a user is meant to read."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearwear.arrays import Floats


class InputError(ValueError):
    """An input or an argument is wrong.

    The message is one line that names the file, line or value, says what is wrong and what
    would be right. The commands print it and exit with status 2.
    """


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

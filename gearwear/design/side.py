"""Left and right: one encoding."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum

from gearwear.errors import InputError


class Side(IntEnum):
    """A tooth side, seen from +z: left is the counter-clockwise one. Its value is the sign s of the formulas.

    >>> Side.LEFT * 2.5, Side.RIGHT.index, str(Side.LEFT), Side.LEFT.opposite, Side("left")
    (2.5, 1, 'left', <Side.RIGHT: -1>, <Side.LEFT: 1>)
    """

    LEFT = 1
    RIGHT = -1

    @property
    def index(self) -> int:
        """Place in arrays of shape (teeth, 2, …): left first."""
        return 0 if self is Side.LEFT else 1

    @property
    def opposite(self) -> Side:
        return Side(-self)

    @classmethod
    def of(cls, given: object) -> Side:
        """A side as a user writes it: a `Side`, its sign, or its name.

        Raises
        ------
        InputError
            If it is anything else; 0 and 1 as places in arrays are refused with the rest.

        Examples
        --------
        >>> Side.of("right"), Side.of(1)
        (<Side.RIGHT: -1>, <Side.LEFT: 1>)
        """
        named = {str(side): side for side in cls}
        if isinstance(given, str) and given in named:
            return named[given]
        if isinstance(given, int) and not isinstance(given, bool) and given in (cls.LEFT, cls.RIGHT):
            return cls(given)
        raise InputError(f"side {given!r}: gw.Side.LEFT or gw.Side.RIGHT (+1, −1; 'left', 'right') would be right")

    @classmethod
    def _missing_(cls, value: object) -> Side:
        """What `Side(value)` is of anything but the two signs: one by its name; the rest ends in the error of `of`."""
        return cls.of(value)

    def __str__(self) -> str:
        return self.name.lower()

    def __format__(self, spec: str) -> str:
        return format(str(self), spec)


def sides_given(given: object, name: str) -> frozenset[Side]:
    """A set of sides as a user writes it: of any of what `Side.of` takes.

    Raises
    ------
    InputError
        If one of them is no side, or it is one alone; the message names it by `name`.

    Examples
    --------
    >>> sorted(sides_given(["left", Side.RIGHT], "worn"))
    [<Side.RIGHT: -1>, <Side.LEFT: 1>]
    """
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise InputError(f"{name} {given!r}: a set of sides such as {{gw.Side.LEFT}} would be right")
    return frozenset(map(Side.of, given))


def sides_of(side: Side | None) -> frozenset[Side]:
    """A side as a set; the empty one for None."""
    return frozenset() if side is None else frozenset({side})

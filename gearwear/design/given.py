"""What a caller may give: one of a few words, a whole number, a number."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Integral, Real

from gearwear.design.quantity import shown
from gearwear.errors import InputError


def check_choice(name: str, given: object, allowed: Iterable[str]) -> None:
    """Refuse what is none of a few words.

    >>> check_choice("cycle", "turns", ("pitch", "revolution"))
    Traceback (most recent call last):
    gearwear.errors.InputError: cycle = 'turns': one of pitch, revolution would be right
    """
    words = tuple(allowed)
    if not (isinstance(given, str) and given in words):
        raise InputError(f"{name} = {shown(given)}: one of {', '.join(words)} would be right")


def check_whole(name: str, given: object, least: int | None = None) -> None:
    """Refuse what is no whole number, or is below the least; integers of numpy are some, True and False are none.

    >>> check_whole("positions_per_pitch", 3.5, 1)
    Traceback (most recent call last):
    gearwear.errors.InputError: positions_per_pitch = 3.5: a whole number from 1 up would be right
    """
    if not (isinstance(given, Integral) and not isinstance(given, bool) and (least is None or int(given) >= least)):
        bound = "" if least is None else f" from {least} up"
        raise InputError(f"{name} = {shown(given)}: a whole number{bound} would be right")


def check_number(name: str, given: object, unit: str) -> None:
    """Refuse what is no number, such as its text; how great it may be is for others to say.

    >>> check_number("centre_distance", "114.3", "mm")
    Traceback (most recent call last):
    gearwear.errors.InputError: centre_distance = '114.3': a number, in mm, would be right
    """
    if not isinstance(given, Real) or isinstance(given, bool):
        raise InputError(f"{name} = {shown(given)}: a number{f', in {unit},' if unit else ''} would be right")

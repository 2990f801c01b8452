"""What a caller may give: one of a few words, a whole number, a number, several of these, an array."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Integral, Real
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from gearwear.arrays import Floats
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


def is_number(given: object) -> TypeGuard[float]:
    """Whether it is a real number that a float holds; True and False are none, a text or an array with one neither.

    >>> is_number(np.float32(2.5)), is_number(True), is_number("2.5"), is_number(10**400)
    (True, False, False, False)
    """
    if not isinstance(given, Real) or isinstance(given, bool):
        return False
    try:
        float(given)
    except OverflowError:
        return False
    return True


def check_number(name: str, given: object, unit: str) -> None:
    """Refuse what is no number, such as its text; how great it may be is for others to say.

    >>> check_number("centre_distance", "114.3", "mm")
    Traceback (most recent call last):
    gearwear.errors.InputError: centre_distance = '114.3': a number, in mm, would be right
    """
    if not is_number(given):
        raise InputError(f"{name} = {shown(given)}: a number{f', in {unit},' if unit else ''} would be right")


def check_within(name: str, given: object, low: float, high: float, right: str) -> None:
    """Refuse what is no finite number from low to high; nan is none.

    >>> check_within("um_per_tooth", 0.0, math.ulp(0.0), math.inf, "a number above 0")
    Traceback (most recent call last):
    gearwear.errors.InputError: um_per_tooth = 0.0: a number above 0 would be right
    """
    if not (is_number(given) and low <= given <= high and abs(given) < math.inf):
        raise InputError(f"{name} = {shown(given)}: {right} would be right")


def two_numbers(name: str, given: object, right: str) -> tuple[float, float]:
    """Two numbers as they were given, in their order; refused where these are none.

    >>> two_numbers("profile_band", 12.0, "two lengths in mm")
    Traceback (most recent call last):
    gearwear.errors.InputError: profile_band = 12.0: two lengths in mm would be right
    """
    first = last = None
    if isinstance(given, Iterable) and getattr(given, "ndim", 1) == 1 and len(both := list(given)) == 2:
        first, last = both
    if not (is_number(first) and is_number(last)):
        raise InputError(f"{name} = {shown(given)}: {right} would be right")
    return first, last


def check_several(name: str, given: object, what: str) -> list[Any]:
    """What was given one by one; refused where it is none that one can go through.

    >>> check_several("also", 3, "names")
    Traceback (most recent call last):
    gearwear.errors.InputError: also = 3: a list of names would be right
    """
    if not isinstance(given, Iterable) or getattr(given, "ndim", 1) == 0:
        raise InputError(f"{name} = {shown(given)}: a list of {what} would be right")
    return list(given)


def real_array(name: str, values: ArrayLike) -> Floats:
    """Numbers as an array; what numpy would cast silently, words and complex numbers, are none.

    >>> real_array("points", "scan.ply")
    Traceback (most recent call last):
    gearwear.errors.InputError: points of type <U8: an array of real numbers would be right
    """
    try:
        array = np.asarray(values)
        if array.dtype.kind in "fiuO":
            return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name}: rows of different lengths, or no numbers; an array of real numbers would be right") from None
    raise InputError(f"{name} of type {array.dtype}: an array of real numbers would be right")


def rising(name: str, values: ArrayLike) -> Floats:
    """Lengths in mm that rise, (n,); a single one may be given as a number.

    >>> rising("z", 7.5), rising("z", [1.0, 0.5])
    Traceback (most recent call last):
    gearwear.errors.InputError: z = [1.0, 0.5]: one or more finite numbers that rise, in mm, would be right
    """
    array = np.atleast_1d(real_array(name, values))
    if array.ndim != 1 or not array.size or not np.isfinite(array).all() or not (np.diff(array) > 0.0).all():
        raise InputError(f"{name} = {shown(values)}: one or more finite numbers that rise, in mm, would be right")
    return array

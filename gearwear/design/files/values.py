"""Values of a design file, each refused by name where it is none: what the readers of its tables share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

from gearwear.design.modification import KEYS as MODIFICATION_KEYS
from gearwear.design.quantity import shown
from gearwear.errors import InputError

MOST_LISTED = 20
"""Keys of a gear that the message on an unknown one lists."""
RATIOS = ("profile_shift", "addendum", "dedendum", "rack_tip_radius", "cutter_tip_radius")
"""Keys of a gear that are multiples of its module."""
MEASURED = "measured"
THINNING_FROM = ("drawing", MEASURED)
"""Where a thinning comes from: the drawing, or a gear that was measured and may be worn."""

Default = TypeVar("Default")


def check_keys(where: str, table: dict[str, Any], known: Sequence[str], needed: Sequence[str] = ()) -> None:
    """Refuse a key that a table (`where`: ``[gear]``) does not know, and one that is missing."""
    for key in table:
        if key not in known:
            raise InputError(unknown(f"{where} {shown_key(key)}", key, known))
    for key in needed:
        if key not in table:
            raise InputError(f"{where}: {key} is missing")


def exclusive(section: str, table: dict[str, Any], key: str, other: str) -> None:
    """Refuse two keys that say the same."""
    if key in table and other in table:
        raise InputError(f"[{section}] {key} and {other} are both given: one of them")


def quoted_word(section: str, table: dict[str, Any], key: str) -> str:
    """A word of a table."""
    value = table[key]
    if not isinstance(value, str):
        raise InputError(f"[{section}] {key} = {shown(value)}: must be a word in quotes")
    return value


def yes_or_no(section: str, table: dict[str, Any], key: str, default: bool) -> bool:
    """True or false in a table, or what holds where it is left out."""
    value = table.get(key, default)
    if not isinstance(value, bool):
        raise InputError(f"[{section}] {key} = {shown(value)}: must be true or false")
    return value


def unknown(place: str, key: str, known: Sequence[str]) -> str:
    """That a key is unknown, and which one was perhaps meant; failing that, all that are known."""
    near = get_close_matches(key.lower(), known, 1)
    if near:
        return f"{place} is unknown ({near[0]}?); docs/design.md has all that are known"
    plain = [name for name in known if known is MODIFICATION_KEYS or name not in MODIFICATION_KEYS]
    more = "" if len(plain) == len(known) else ", and all else that docs/design.md has"
    return f"{place} is unknown; known are {', '.join(plain if not more else plain[:MOST_LISTED])}{more}"


def shown_key(key: str) -> str:
    """A key of the file as it is, quoted where it would break the line."""
    return key if key.isprintable() and key else shown(key)


def number_or(section: str, table: dict[str, Any], key: str, default: Default) -> float | Default:
    """A number of a table, or what holds where it is left out."""
    return finite_number(section, table, key) if key in table else default


def finite_number(section: str, table: dict[str, Any], key: str) -> float:
    """A number of a table."""
    value = table[key]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"[{section}] {key} = {shown(value)}: must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"[{section}] {key} = {shown(value)}: must be a finite number")
    return number

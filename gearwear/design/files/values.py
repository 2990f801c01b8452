"""Values of a design file, each refused by name where it is none: what the readers of its tables share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

from gearwear.design.modification import KEYS as MODIFICATION_KEYS
from gearwear.design.spec import shown
from gearwear.errors import InputError

MOST_LISTED = 20
"""Keys of a gear that the message on an unknown one lists."""


def quoted_word(section: str, table: dict[str, Any], key: str) -> str:
    value = table[key]
    if not isinstance(value, str):
        raise InputError(f"[{section}] {key} = {shown(value)}: must be a word in quotes")
    return value


def unknown(what: str, key: str, known: Sequence[str]) -> str:
    """That a key is unknown, and which one was perhaps meant; failing that, all that are known."""
    near = get_close_matches(key.lower(), known, 1)
    if near:
        return f"{what} is unknown ({near[0]}?); docs/design.md has all that are known"
    plain = [name for name in known if known is MODIFICATION_KEYS or name not in MODIFICATION_KEYS]
    more = "" if len(plain) == len(known) else ", and all else that docs/design.md has"
    return f"{what} is unknown; known are {', '.join(plain if not more else plain[:MOST_LISTED])}{more}"


def shown_key(key: str) -> str:
    """A key of the file as it is, quoted where it would break the line."""
    return key if key.isprintable() and key else shown(key)


def finite_number(section: str, table: dict[str, Any], key: str) -> float:
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

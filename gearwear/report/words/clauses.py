"""Text on a terminal's lines: what has no room is left out from the end of a clause on."""

from __future__ import annotations

import re
import textwrap

from gearwear.design.quantity import unbroken

CLAUSE, MORE = re.compile(r"[;:,.](?=\s)"), " (more in the report)."
"""Where a clause ends, and what is said in the place of those for which there is no room."""


def wrapped(text: str, width: int, most: int) -> list[str]:
    """At most so many lines of a width; what is cut off stands in the report."""
    return textwrap.wrap(unbroken(text), width, max_lines=most, placeholder=" …", break_on_hyphens=False)


def to_a_clause(text: str, width: int, most: int) -> list[str]:
    """At most so many lines of a width; what has no room is left out from the end of a clause on, and said to stand in the report."""
    said = wrapped(text, width, most + 1)
    ends = [found.start() for found in CLAUSE.finditer(text)]
    while len(said) > most and ends:
        kept = text[: ends.pop()]
        if kept.count("(") == kept.count(")"):
            said = wrapped(kept + MORE, width, most + 1)
    return said if len(said) <= most else wrapped(text, width, most)

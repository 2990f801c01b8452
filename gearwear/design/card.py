"""Results that show themselves: a headline and a few rows, as text and as HTML; arrays are never dumped."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from gearwear.design.quantity import SPACE, with_std

CardRow = tuple[str, str]
"""A label and what it says."""


class Card:
    """What a result shows of itself in a terminal and in a notebook.

    A class that shows itself says `headline` and, where it has more to say, `rows`. It keeps no data of its own.
    """

    __slots__ = ()

    def headline(self) -> str:
        """The result in one line, units and uncertainty with every number."""
        raise NotImplementedError

    def rows(self) -> Sequence[CardRow]:
        """More, a label and a text each; at most a dozen."""
        return ()

    def __repr__(self) -> str:
        rows = self.rows()
        width = max((len(label) for label, _ in rows), default=0)
        lines = [f"  {label:<{width}}  {text}" for label, text in rows]
        return "\n".join([f"{type(self).__name__}: {self.headline()}", *lines])

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><th style="text-align:left">{escape(label)}</th><td style="text-align:left">{escape(text)}</td></tr>'
            for label, text in self.rows()
        )
        table = f"<table>{rows}</table>" if rows else ""
        return f"<div><b>{escape(type(self).__name__)}</b>: {escape(self.headline())}{table}</div>"


def measured(value: float, std: float, unit: str) -> str:
    """A number with its standard deviation as `with_std` rounds it, with ordinary spaces.

    >>> measured(82.2513, 0.4721, "mm³")
    '82.25 ± 0.47 mm³'
    >>> measured(-0.00312, math.nan, "mm")
    '−0.00312 mm'
    >>> measured(math.nan, 1.0, "µm")
    'not known'
    """
    return with_std(value, std, unit).replace(SPACE, " ") if math.isfinite(value) else "not known"


def few(rows: Sequence[CardRow], most: int = 10) -> list[CardRow]:
    """The first rows, and how many more there are."""
    left = len(rows) - most
    return [*rows[:most], *([("…", f"{left} more")] if left > 0 else [])]

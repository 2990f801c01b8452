"""Numbers and effects in words: what the page, the terminal and the verdict share."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from gearwear.design.quantity import MISSING, SPACE, UNITS, listed, number, plural, pretty_unit, significant, with_std
from gearwear.report.figures.arrays import Report


def quantity(item: object, unit: str = "") -> str:
    """``{value, std, unit}``, a bare number, or a list of numbers, in words."""
    if isinstance(item, Mapping):
        value, unit = item.get("value"), str(item.get("unit") or unit)
        if unit in ("", "1") and isinstance(value, float) and value.is_integer() and not item.get("std"):
            return number(value, 0)  # an order, a count
        if isinstance(value, (list, tuple)):
            return quantity(value, unit)
        std = item.get("std")
        if unit == "ppm" and isinstance(value, (int, float)) and abs(value) >= 1e4:
            value, std, unit = 1e-4 * value, None if std is None else 1e-4 * std, "%"
        return with_std(value, std, pretty_unit(unit))
    if isinstance(item, (list, tuple)):
        values = [v for v in item if isinstance(v, (int, float)) and math.isfinite(v)]
        if not values:
            return MISSING
        return f"{significant(min(values))} … {significant(max(values))}{SPACE}{pretty_unit(unit)}".rstrip(SPACE)
    return with_std(item, None, pretty_unit(unit))


def bare(item: object) -> str:
    """`quantity` without its unit, for a column that has it in its head."""
    return with_std(item.get("value"), item.get("std")) if isinstance(item, Mapping) else quantity(item)


def named(key: str, value: object) -> str:
    """A key of the report with its value; the unit in the key's name becomes a unit.

    >>> named("rotation_um", 0.05), named("order", 3), named("where", ["tooth 3", "tooth 4"])
    ('rotation 0.0500\\u202fµm', 'order 3', 'where tooth 3 and tooth 4')
    """
    stem, _, unit = key.rpartition("_")
    if stem and unit in UNITS and value is not None:
        return f"{stem.replace('_', ' ')} {quantity(value, unit)}"
    return f"{key.replace('_', ' ')} {said(value)}"


def said(value: object) -> str:
    """Any value of the report on one line."""
    if isinstance(value, Mapping):
        if "value" in value:
            return quantity(value)
        return ", ".join(named(str(key), item) for key, item in value.items() if item is not None)
    if isinstance(value, (list, tuple)):
        return listed(said(item) for item in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return significant(value) if isinstance(value, (int, float)) else "" if value is None else str(value)


def row(values: object, digits: int) -> str:
    """A vector on one line.

    >>> row([1.0, None, -2.25], 1)
    '1.0, –, −2.2'
    """
    return ", ".join(number(value, digits) for value in values) if isinstance(values, (list, tuple)) else ""


def which_flanks(regions: Iterable[Report], teeth: int | None = None) -> str:
    """Which flanks some regions of wear lie on, in few words.

    >>> which_flanks([{"tooth": 2, "flank": "left"}])
    'the left flank of tooth 2'
    >>> which_flanks([{"tooth": t, "flank": "left"} for t in (1, 2, 3)], 3)
    'all 3 left flanks'
    """
    found = {(region["tooth"], str(region["flank"])) for region in regions}
    sides = {side for _, side in found}
    if len(found) == 1:
        ((tooth, side),) = found
        return f"the {side} flank of tooth {tooth}"
    if len(sides) == 1:
        return f"{'all ' if len(found) == teeth else ''}{len(found)} {sides.pop()} flanks"
    numbers = {tooth for tooth, _ in found}
    return f"{len(found)} flanks of {plural(len(numbers), 'tooth', 'teeth')}"


def effect_title(name: str) -> str:
    """An effect's name as a person writes it.

    >>> effect_title("axis_offset_radial")
    'axis offset radial'
    """
    return name.replace("_", " ")


def ask(report: object, *path: str) -> Any:
    """Value at a path of keys, None where any of them is missing."""
    for key in path:
        if not isinstance(report, Mapping):
            return None
        report = report.get(key)
    return report

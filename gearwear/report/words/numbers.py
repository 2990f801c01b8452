"""Numbers and effects in words: what the page, the terminal and the verdict share."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from gearwear.report.figures.arrays import Report

MISSING = "–"
_UNITS = {"um": "µm", "mm": "mm", "deg": "°", "mm2": "mm²", "mm3": "mm³", "ppm": "ppm", "1": ""}
SPACE = "\u202f"
"""Narrow space that does not break, between digits and before units."""


def number(value: object, digits: int = 2) -> str:
    """A number with a fixed count of decimals and a true minus sign; a dash where there is none.

    >>> number(-0.5, 1), number(None), number(454500.0, 0)
    ('−0.5', '–', '454\\u202f500')
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return MISSING
    text = f"{value:,.{digits}f}"
    if not any(digit in text for digit in "123456789"):
        text = text.lstrip("-")  # no minus zero
    return text.replace("-", "−").replace(",", SPACE)


def significant(value: object, digits: int = 3) -> str:
    """A number to so many significant digits, never in powers of ten above 1e-4.

    >>> significant(0.012345), significant(1234.5), significant(3e-9)
    ('0.0123', '1\\u202f234', '3e−09')
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return MISSING
    if value == 0.0 or isinstance(value, int):
        return number(value, 0)
    if abs(value) < 1e-4:
        return f"{value:.{max(digits - 2, 0)}g}".replace("-", "−")
    return number(value, max(0, digits - 1 - math.floor(math.log10(abs(value)))))


def with_std(value: object, std: object, unit: str = "") -> str:
    """Value ± standard deviation, both to the digits that the latter deserves.

    >>> with_std(5.33897, 0.0512, "mm³"), with_std(20.04, None, "µm"), with_std(128.3, 14.2)
    ('5.34\\u202f±\\u202f0.05\\u202fmm³', '20.0\\u202fµm', '128\\u202f±\\u202f14')
    """
    tail = unit if unit == "°" else f"{SPACE}{unit}" if unit else ""
    if significant(value) == MISSING:
        return MISSING
    if not isinstance(std, (int, float)) or not math.isfinite(std) or std <= 0.0:
        return significant(value) + tail
    digits = decimals(std)
    return f"{number(value, digits)}{SPACE}±{SPACE}{number(std, digits)}{tail}"


def decimals(std: object) -> int:
    """Decimals that a standard deviation deserves: two digits where its first is 1, else one (Particle Data Group's rule, shortened).

    >>> decimals(0.0123), decimals(0.5), decimals(42.0), decimals(None)
    (3, 1, 0, 0)
    """
    if not isinstance(std, (int, float)) or not math.isfinite(std) or std <= 0.0:
        return 0
    power = math.floor(math.log10(std))
    return max(0, -power + (1 if std / 10.0**power < 2.0 else 0))


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


def pretty_unit(unit: str) -> str:
    """Unit as printed: ``um`` is µm, ``deg`` is °, ``mm3`` is mm³."""
    return _UNITS.get(unit, unit)


def named(key: str, value: object) -> str:
    """A key of the report with its value; the unit in the key's name becomes a unit.

    >>> named("rotation_um", 0.05), named("order", 3), named("where", ["tooth 3", "tooth 4"])
    ('rotation 0.0500\\u202fµm', 'order 3', 'where tooth 3 and tooth 4')
    """
    stem, _, unit = key.rpartition("_")
    if stem and unit in _UNITS and value is not None:
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


def plural(count: int, one: str, many: str = "") -> str:
    """
    >>> plural(1, "flank"), plural(3, "tooth", "teeth")
    ('1 flank', '3 teeth')
    """
    return f"{count} {one if count == 1 else many or one + 's'}"


def listed(items: Iterable[str], last: str = "and") -> str:
    """
    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    words = list(items)
    if len(words) > 2 and any("," in word for word in words):  # commas inside would run into those between
        return f"{'; '.join(words[:-1])}; {last} {words[-1]}"
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}" if words else ""


def sentence(text: str) -> str:
    """First letter large, a full stop at the end."""
    text = text.strip()
    return text if not text else text[0].upper() + text[1:] + ("" if text[-1] in ".!?" else ".")


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

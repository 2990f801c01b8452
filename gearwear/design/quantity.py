"""Numbers in words: one table of units, one rounding of a value with its standard deviation, and lists and sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable

MISSING = "–"
UNITS = {"um": "µm", "mm": "mm", "deg": "°", "mm2": "mm²", "mm3": "mm³", "ppm": "ppm", "1": ""}
NORMAL_95 = 1.96
"""Standard deviations on either side within which 95 of 100 normal values lie."""
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


def as_drawn(value: float) -> str:
    """A number of the drawing: three significant digits, six where it has more.

    >>> as_drawn(6.5), as_drawn(3.175), as_drawn(25.4 / 12), as_drawn(20.0), as_drawn(12.5783)
    ('6.50', '3.175', '2.11667', '20.0', '12.5783')
    """
    short, full = significant(value), f"{value:.6g}"
    return short if len(full) <= len(short) else full


def with_std(value: object, std: object, unit: str = "") -> str:
    """Value ± standard deviation, both to the second significant digit of the latter; the value alone to three digits.

    >>> with_std(5.33897, 0.0512, "mm³"), with_std(20.04, None, "µm"), with_std(128.3, 14.2)
    ('5.339\u202f±\u202f0.051\u202fmm³', '20.0\u202fµm', '128\u202f±\u202f14')
    """
    tail = unit if unit == "°" else f"{SPACE}{unit}" if unit else ""
    if significant(value) == MISSING:
        return MISSING
    if not isinstance(std, (int, float)) or not math.isfinite(std) or std <= 0.0:
        return significant(value) + tail
    digits = decimals(std)
    return f"{number(value, digits)}{SPACE}±{SPACE}{number(std, digits)}{tail}"


def decimals(std: object) -> int:
    """Decimals that a standard deviation deserves: its second significant digit is the last (JCGM 100:2008, 7.2.6: two at most; with
    one alone up to a third of it would be rounded away).

    >>> decimals(0.0123), decimals(0.5), decimals(42.0), decimals(0.0997), decimals(None)
    (3, 2, 0, 2, 0)
    """
    if not isinstance(std, (int, float)) or not math.isfinite(std) or std <= 0.0:
        return 0
    return max(0, 1 - math.floor(math.log10(float(f"{std:.1e}"))))


def pretty_unit(unit: str) -> str:
    """Unit as printed: ``um`` is µm, ``deg`` is °, ``mm3`` is mm³."""
    return UNITS.get(unit, unit)


def counted(number: int, singular: str, many: str = "") -> str:
    """A number and the word for it.

    >>> counted(1, "flank"), counted(3, "tooth", "teeth"), counted(1200, "region")
    ('1 flank', '3 teeth', '1,200 regions')
    """
    return f"{number:,} {singular if number == 1 else many or singular + 's'}"


def listed(items: Iterable[str], last: str = "and") -> str:
    """
    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    words = list(items)
    if len(words) > 2 and any("," in word for word in words):  # commas inside would run into those between
        return f"{'; '.join(words[:-1])}; {last} {words[-1]}"
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}" if words else ""


def teeth_words(numbers: Iterable[int], count: int = 0) -> str:
    """Teeth by their numbers, from 1 on, those that follow each other as a stretch; all of them where the gear has `count`.

    >>> teeth_words([4]), teeth_words([9, 3, 4, 5, 1, 2]), teeth_words([1, 2, 7]), teeth_words([1, 2, 3], 3)
    ('tooth 4', 'teeth 1 to 5 and 9', 'teeth 1, 2 and 7', 'all 3 teeth')
    """
    teeth, stretches = sorted(set(numbers)), list[list[int]]()
    if len(teeth) == count:
        return f"all {count} teeth"
    for tooth in teeth:
        if stretches and stretches[-1][-1] == tooth - 1:
            stretches[-1].append(tooth)
        else:
            stretches.append([tooth])
    words = [w for s in stretches for w in ([f"{s[0]} to {s[-1]}"] if len(s) > 2 else map(str, s))]
    return f"{'tooth' if len(words) == 1 and words[0].isdigit() else 'teeth'} {listed(words)}"


def unbroken(text: str) -> str:
    """For a terminal: a value stays with its unit by the common no-break space, since not every font has the narrow one."""
    return text.replace(SPACE, "\u00a0")


def sentence(text: str) -> str:
    """First letter large, a full stop at the end."""
    text = text.strip()
    return text if not text else text[0].upper() + text[1:] + ("" if text[-1] in ".!?" else ".")

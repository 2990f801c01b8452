"""Numbers in words: one table of units, one rounding of a value with its standard deviation, and lists and sentences."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable

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


def at_least(limit: float, digits: int = 4) -> str:
    """A limit from below, rounded up: what is written keeps the limit, and what does not keep it does not read like it.

    >>> at_least(114.30003), at_least(114.3), at_least(-0.00001)
    ('114.3001', '114.3000', '0.0000')
    """
    return _rounded(math.ceil, limit, digits)


def at_most(limit: float, digits: int = 4) -> str:
    """A limit from above, rounded down.

    >>> at_most(114.30007), at_most(5.0, 3)
    ('114.3000', '5.000')
    """
    return _rounded(math.floor, limit, digits)


def _rounded(way: Callable[[float], int], limit: float, digits: int) -> str:
    """A millionth of the last decimal is noise of the computer, no reason for the next one."""
    steps = limit * 10.0**digits
    return f"{way(round(steps, 6)) / 10.0**digits:z.{digits}f}" if abs(steps) < 1e15 else f"{limit:z.{digits}f}"


def not_zero(value: float, digits: int = 4) -> str:
    """A number that is told since it is not zero: where these decimals would be zeros, one significant digit.

    >>> not_zero(-0.01234), not_zero(-3.2e-6), not_zero(0.0)
    ('-0.0123', '-3e-06', '0.0000')
    """
    text = f"{value:z.{digits}f}"
    return text if value == 0.0 or any(digit in text for digit in "123456789") else f"{value:.1g}"


def apart(*values: float, digits: int = 4) -> list[str]:
    """Numbers with as many decimals as tell those apart that differ.

    >>> apart(34.0, 35.0), apart(34.0, 34.00001, digits=2)
    (['34.0000', '35.0000'], ['34.00000', '34.00001'])
    """
    most = 15
    while True:
        written = [f"{value:z.{digits}f}" for value in values]
        if digits >= most or len(set(written)) == len(set(values)):
            return written
        digits += 1


def outside(value: float, low: float, high: float, digits: int = 3) -> str:
    """A number outside of a range, to as many significant digits as show it.

    >>> outside(16.748, -2.0, 4.0), outside(4.0001, -2.0, 4.0)
    ('16.7', '4.0001')
    """
    return next(text for d in range(digits, 18) if not low <= float(text := f"{value:.{d}g}") <= high or d == 17)


def as_given(value: float) -> str:
    """A number as it was given, to twelve digits.

    >>> as_given(114.3), as_given(114.29995), as_given(0.1 + 0.2)
    ('114.3', '114.29995', '0.3')
    """
    return f"{value:.12g}"


def shown(value: object) -> str:
    """`value` as a message shows it: on one line, and short.

    >>> from numpy import eye
    >>> shown(eye(2))
    'array([[1., 0.], [0., 1.]])'
    """
    try:
        text = re.sub(r"\n\s*", " ", repr(value))
    except ValueError:  # Python does not print integers of more than 4300 digits
        return "a number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:57]}..."


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

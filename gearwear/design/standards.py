"""Modules, pressure angles and tooth depths in use, each with how rare it is.

A list only proposes candidates. What of it was compared with independent sources is said at each; the rest is in docs/limits.md.

Rarity is −2 ln (frequency relative to the commonest), as round numbers: 0 common, 2 seldom (a third), 4 rare (a seventh).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

MM_PER_INCH = 25.4

FIRST_SERIES = (
    0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.8,
    1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0,
)  # fmt: skip
"""ISO 54:1996 series I (agrees with one independent implementation); below 1 mm smaller ones in use (docs/limits.md)."""
SECOND_SERIES = (
    0.11, 0.14, 0.18, 0.22, 0.28, 0.35, 0.45, 0.55, 0.65, 0.7, 0.75, 0.9,
    1.125, 1.375, 1.75, 2.25, 2.75, 3.5, 4.5, 5.5, 6.5, 7.0, 9.0, 11.0, 14.0, 18.0, 22.0, 28.0, 36.0, 45.0,
)  # fmt: skip
"""ISO 54:1996 series II, of which 6.5 is to be avoided (agrees with one independent implementation); below 1 mm smaller ones in use
(docs/limits.md)."""
DIAMETRAL_PITCHES = (
    200, 180, 160, 150, 120, 96, 80, 72, 64, 48, 40, 32, 24, 20, 18, 16, 14, 12, 10, 9, 8, 7, 6, 5, 4, 3.5, 3, 2.75, 2.5, 2.25, 2,
    1.75, 1.5, 1.25, 1,
)  # fmt: skip
"""1/inch; pitches in use (docs/limits.md)."""
FRACTION = 64
"""Parts of an inch in which lengths of gears of a diametral pitch are drawn."""


def diametral_pitch(module: float) -> float | None:
    """The diametral pitch in use that a module, mm, is; None where it is none.

    >>> diametral_pitch(6.35), diametral_pitch(6.0)
    (4, None)
    """
    return next((p for p in DIAMETRAL_PITCHES if math.isclose(MM_PER_INCH / p, module, rel_tol=1e-12)), None)


def inch_words(length: float) -> str | None:
    """A length in mm as a fraction of an inch in lowest terms; None where it is no whole number of 1/64 in.

    >>> inch_words(19.05), inch_words(26.9875), inch_words(25.4), inch_words(19.0)
    ('3/4 in', '1 1/16 in', '1 in', None)
    """
    parts = length / MM_PER_INCH * FRACTION
    if round(parts) < 1 or abs(parts - round(parts)) > 1e-6:
        return None
    whole, rest = divmod(Fraction(round(parts), FRACTION), 1)
    return " ".join(filter(None, [str(whole) if whole else "", str(rest) if rest else ""])) + " in"


ANGLES = tuple(
    (math.radians(degrees), rarity)
    for degrees, rarity in ((20.0, 0.0), (25.0, 4.0), (14.5, 4.0), (22.5, 6.0), (17.5, 8.0), (15.0, 8.0), (30.0, 8.0))
)
"""Pressure angle in rad, and its rarity."""


@dataclass(frozen=True, slots=True)
class Module:
    """A module, mm, what it is called, and how rare it is."""

    mm: float
    name: str
    rarity: float


@dataclass(frozen=True, slots=True)
class Depth:
    """Addendum and dedendum in modules, what the system is called, and how rare it is."""

    addendum: float
    dedendum: float
    name: str
    rarity: float


DEPTHS = (
    Depth(1.0, 1.25, "full depth", 0.0),
    Depth(1.0, 1.4, "deep root (1.4)", 3.0),
    Depth(1.0, 1.2, "root 1.2", 3.0),
    Depth(1.0, 1.157, "root 1.157", 4.0),
    Depth(1.0, 1.35, "root 1.35", 4.0),
    Depth(0.8, 1.0, "stub teeth", 6.0),
)
"""The usual one first: ISO 53:1998 profiles A to C, and D (agree with one independent implementation); the others are in use
(docs/limits.md)."""

RING_DEPTHS = (
    Depth(1.0, 1.25, "full depth", 0.0),
    Depth(0.8, 1.25, "short teeth (0.8)", 1.0),
    Depth(0.9, 1.25, "short teeth (0.9)", 2.0),
    Depth(1.0, 1.4, "deep root (1.4)", 3.0),
    Depth(0.8, 1.0, "stub teeth", 6.0),
)
"""Of rings, whose tips are shortened as a rule so that they clear the pinion's fillet (docs/internal.md)."""


def modules_near(low: float, high: float) -> list[Module]:
    """Standard modules from `low` to `high` mm, smallest first; one that two systems share is named by the first.

    >>> [module.name for module in modules_near(6.0, 6.6)]
    ['module 6', 'diametral pitch 4 (module 6.35)', 'module 6.5']
    """
    every = [Module(m, f"module {m:g}", 0.0) for m in FIRST_SERIES]
    every += [Module(m, f"module {m:g}", 2.5 if m == 6.5 else 2.0) for m in SECOND_SERIES]
    for pitch in DIAMETRAL_PITCHES:
        m = MM_PER_INCH / pitch
        every.append(Module(m, f"diametral pitch {pitch:g} (module {m:.5g})", 1.0))
    return sorted((module for module in every if low <= module.mm <= high), key=lambda module: module.mm)

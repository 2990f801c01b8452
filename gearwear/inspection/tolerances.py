"""Flank tolerances and classes of ISO 1328-1: edition 2013, and edition 1995 as an option.

Tolerances are in mm, rounded in whole, half or tenth micrometres as the standards do. The printed standards were not at hand: each
docstring says which independent sources a formula agrees with (docs/inspection.md names them), docs/limits.md what is unconfirmed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import StrEnum
from functools import lru_cache

from gearwear.design.gear import Gear
from gearwear.design.tolerance import CLASS_STEP, profile_form_of_class_five
from gearwear.errors import InputError

FOOTNOTE = (
    "The printed text of ISO 1328-1 was not at hand. Tolerances of ISO 1328-1:2013 (5.2, 5.3) agree with three independent public "
    "implementations, those of ISO 1328-1:1995 with three and with the 80 values of three published KISSsoft reports; sector pitch and "
    "adjacent pitch difference follow annexes D and G as one of them reads them; those of ISO 1328-2:1997 agree with one in full and one in part. Unconfirmed: tolerances of sector pitch and runout "
    "(2013), the 95 % and 92 % of the profile range, the cut-off wavelengths, the default circle of pitch, the sign of a helix slope. "
    "Compare with the standard before one of these decides about a part."
)
"""Said under every table of tolerances."""


class Edition(StrEnum):
    """Which ISO 1328-1 the tolerances and the evaluation ranges follow."""

    ISO_2013 = "ISO 1328-1:2013"
    ISO_1995 = "ISO 1328-1:1995"


CLASSES = {Edition.ISO_2013: range(1, 12), Edition.ISO_1995: range(13)}
"""Tolerance classes (1995: accuracy grades) of each edition; larger is coarser."""


# Outer limits (d, m_n, b; mm) and, for 1995, the ranges whose geometric means stand for the actual value.
LIMITS = {
    Edition.ISO_2013: ((5.0, 15000.0), (0.5, 70.0), (4.0, 1200.0)),
    Edition.ISO_1995: ((5.0, 10000.0), (0.5, 70.0), (4.0, 1000.0)),
}
RANGES_1995 = (
    (5.0, 20.0, 50.0, 125.0, 280.0, 560.0, 1000.0, 1600.0, 2500.0, 4000.0, 6000.0, 8000.0, 10000.0),
    (0.5, 2.0, 3.5, 6.0, 10.0, 16.0, 25.0, 40.0, 70.0),
    (4.0, 10.0, 20.0, 40.0, 80.0, 160.0, 250.0, 400.0, 650.0, 1000.0),
)


@dataclass(frozen=True, slots=True)
class Size:
    """What the tolerances of a gear depend on.

    Parameters
    ----------
    reference_diameter, normal_module, face_width : float
        d, m_n and b in mm.
    teeth : int
        z.
    """

    reference_diameter: float
    normal_module: float
    face_width: float
    teeth: int

    @classmethod
    def of(cls, gear: Gear) -> Size:
        """Of a gear."""
        return cls(2.0 * gear.reference_radius, gear.spec.normal_module, gear.face_width, gear.teeth)


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Tolerances of one class, all in mm. Slopes and single pitch are ± values, the others are widths.

    A quantity an edition does not define is nan.
    """

    single_pitch: float
    """f_p (1995: f_pt)."""
    cumulative_pitch: float
    """F_p."""
    sector_pitch: float
    """F_pk over `sector_teeth` pitches."""
    adjacent_pitch: float
    """f_u, difference of two neighbouring single pitches."""
    runout: float
    """F_r."""
    profile_slope: float
    """f_Hα."""
    profile_form: float
    """f_fα."""
    profile_total: float
    """F_α."""
    helix_slope: float
    """f_Hβ."""
    helix_form: float
    """f_fβ."""
    helix_total: float
    """F_β."""


SYMBOLS = {
    "single_pitch": "f_p",
    "cumulative_pitch": "F_p",
    "sector_pitch": "F_pk",
    "adjacent_pitch": "f_u",
    "runout": "F_r",
    "profile_slope": "f_Hα",
    "profile_form": "f_fα",
    "profile_total": "F_α",
    "helix_slope": "f_Hβ",
    "helix_form": "f_fβ",
    "helix_total": "F_β",
}
"""Symbol of ISO 1328-1:2013 for every field of `Tolerances`."""


def check_validity(size: Size, edition: Edition = Edition.ISO_2013) -> None:
    """Refuse a gear for which the edition gives no tolerances.

    Notes
    -----
    2013: 5 ≤ z ≤ 1000, 5 ≤ d ≤ 15000, 0.5 ≤ m_n ≤ 70, 4 ≤ b ≤ 1200 mm (clause 1, as the published abstract has it). 1995:
    5 ≤ d ≤ 10000, 0.5 ≤ m ≤ 70, 4 ≤ b ≤ 1000 mm (ranges of the formulas; agree with three independent implementations).

    Raises
    ------
    InputError
        With the value and the range.
    """
    if not 5 <= size.teeth <= 1000:
        raise InputError(f"{edition}: {size.teeth} teeth are outside its range, 5 to 1000")
    values = (size.reference_diameter, size.normal_module, size.face_width)
    for label, value, (low, high) in zip(("reference diameter", "module", "face width"), values, LIMITS[edition], strict=True):
        if not low <= value <= high:
            raise InputError(f"{edition}: {label} {value:g} mm is outside its range, {low:g} to {high:g} mm")


def sector_teeth(teeth: int, edition: Edition = Edition.ISO_2013) -> int:
    """Number of pitches k of the sector deviation F_pk, at least 2.

    2013: z/8 to the nearest whole number (annex D.2, Formula (D.1); agrees with one independent implementation; halves go up). 1995:
    the whole number of z/8 (agrees with three published KISSsoft reports).

    >>> sector_teeth(12), sector_teeth(20), sector_teeth(93), sector_teeth(93, Edition.ISO_1995)
    (2, 3, 12, 11)
    """
    return max(2, (teeth + 4) // 8 if edition is Edition.ISO_2013 else teeth // 8)


@lru_cache(maxsize=64)
def tolerances(
    size: Size,
    iso_class: int,
    edition: Edition = Edition.ISO_2013,
    sector: int | None = None,
    rounded: bool = True,
) -> Tolerances:
    """Tolerances of a class.

    Parameters
    ----------
    size : Size
        The gear.
    iso_class : int
        1 to 11 (2013) or 0 to 12 (1995).
    edition : Edition
        Which formulas.
    sector : int or None
        Pitches k of F_pk; None: `sector_teeth`.
    rounded : bool
        Round as the standard does; False gives the formula's own value.

    Returns
    -------
    Tolerances
        mm.

    Raises
    ------
    InputError
        If the gear or the class is outside the edition's range.

    Notes
    -----
    Class-5 value × sqrt(2)^(A − 5), from the unrounded class-5 value. The formulas are in `_class_five_2013` and
    `_class_five_1995`.

    Examples
    --------
    >>> t = tolerances(Size(76.2, 6.35, 15.0, 12), 8, rounded=False)
    >>> round(1e3 * t.single_pitch, 1), round(1e3 * t.profile_total, 1)
    (21.5, 30.4)
    """
    check_validity(size, edition)
    if iso_class not in CLASSES[edition]:
        span = CLASSES[edition]
        raise InputError(f"{edition}: class {iso_class} does not exist, it has {span[0]} to {span[-1]}")
    formula = _class_five_2013 if edition is Edition.ISO_2013 else _class_five_1995
    factor = CLASS_STEP ** (iso_class - 5)
    five = formula(size, sector or sector_teeth(size.teeth, edition))
    values = {f.name: factor * getattr(five, f.name) for f in fields(Tolerances)}
    return Tolerances(**{name: 1e-3 * (round_micrometres(um) if rounded else um) for name, um in values.items()})


def least_class(value: float, tolerance_at: Callable[[int], float], classes: range) -> int | None:
    """The least class whose tolerance is not exceeded, or None where every class is.

    Parameters
    ----------
    value : float
        Deviation in mm; its sign does not count.
    tolerance_at : callable
        Tolerance in mm of a class.
    classes : range
        Those that there are.

    Examples
    --------
    >>> size = Size(76.2, 6.35, 15.0, 12)
    >>> least_class(-0.0185, lambda c: tolerances(size, c).profile_slope, CLASSES[Edition.ISO_2013])
    8
    """
    return next((c for c in classes if abs(value) <= tolerance_at(c) + 1e-12), None)


def round_micrometres(value: float) -> float:
    """Rounding rule for a tolerance in µm: above 10 to 1, from 5 to 10 to 0.5, below 5 to 0.1 (ISO 1328-1:2013, 5.2.3).

    Agrees with three independent implementations; of 1995, with one. Halves go up, also those that binary numbers fall short of.

    >>> [round_micrometres(v) for v in (21.55, 10.4, 7.3, 4.26, 4.85)]
    [22.0, 10.0, 7.5, 4.3, 4.9]
    """
    if math.isnan(value):
        return value
    step = 1.0 if value > 10.0 else 0.5 if value >= 5.0 else 0.1
    return round(math.floor(round(value / step, 9) + 0.5) * step, 1)


def _class_five_2013(size: Size, k: int) -> Tolerances:
    """Class-5 values in µm of ISO 1328-1:2013, 5.3, Formulae (5) to (12), with actual d, m_n and b.

    They agree with three independent implementations; f_u (annex G, Formula (G.2)) with one. F_pk (annex D) and F_r (annex E) are
    unconfirmed (docs/limits.md); that F_pk of a quarter of the teeth is F_p speaks for the former.
    """
    d, m, b = size.reference_diameter, size.normal_module, size.face_width
    single = 0.001 * d + 0.4 * m + 5.0
    cumulative = 0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0
    profile_slope, profile_form = 0.4 * m + 0.001 * d + 4.0, profile_form_of_class_five(m)
    helix_slope = 0.05 * math.sqrt(d) + 0.35 * math.sqrt(b) + 4.0
    helix_form = 0.07 * math.sqrt(d) + 0.45 * math.sqrt(b) + 4.0
    return Tolerances(
        single_pitch=single,
        cumulative_pitch=cumulative,
        sector_pitch=single + 4.0 * k / size.teeth * (0.001 * d + 0.55 * math.sqrt(d) + 0.3 * m + 7.0),
        adjacent_pitch=math.sqrt(2.0) * single,
        runout=0.9 * cumulative,
        profile_slope=profile_slope,
        profile_form=profile_form,
        profile_total=math.hypot(profile_slope, profile_form),
        helix_slope=helix_slope,
        helix_form=helix_form,
        helix_total=math.hypot(helix_slope, helix_form),
    )


def _class_five_1995(size: Size, k: int) -> Tolerances:
    """Class-5 values in µm of ISO 1328-1:1995 (and F_r of ISO 1328-2:1997, 0.8 F_p) at the geometric means of the ranges.

    The formulas agree with three independent implementations (one of them has 0.27 for the 0.7 of F_α and wider ranges of the module),
    the ranges with two, and all of it with the values of three published KISSsoft reports.
    """
    values = (size.reference_diameter, size.normal_module, size.face_width)
    d, m, b = (geometric_mean(value, steps) for value, steps in zip(values, RANGES_1995, strict=True))
    single = 0.3 * (m + 0.4 * math.sqrt(d)) + 4.0
    cumulative = 0.3 * m + 1.25 * math.sqrt(d) + 7.0
    helix_part = 0.07 * math.sqrt(d) + 0.45 * math.sqrt(b) + 3.0
    return Tolerances(
        single_pitch=single,
        cumulative_pitch=cumulative,
        sector_pitch=single + 1.6 * math.sqrt((k - 1) * m),
        adjacent_pitch=math.nan,
        runout=0.8 * cumulative,
        profile_slope=2.0 * math.sqrt(m) + 0.14 * math.sqrt(d) + 0.5,
        profile_form=2.5 * math.sqrt(m) + 0.17 * math.sqrt(d) + 0.5,
        profile_total=3.2 * math.sqrt(m) + 0.22 * math.sqrt(d) + 0.7,
        helix_slope=helix_part,
        helix_form=helix_part,
        helix_total=0.1 * math.sqrt(d) + 0.63 * math.sqrt(b) + 4.2,
    )


def geometric_mean(value: float, steps: tuple[float, ...]) -> float:
    """Geometric mean of the range (low, high] that holds `value`; the first range holds its lower limit too."""
    high = next(i for i in range(1, len(steps)) if value <= steps[i])
    return math.sqrt(steps[high - 1] * steps[high])

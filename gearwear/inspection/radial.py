"""Tolerances of double flank composite deviations, ISO 1328-2:1997: accuracy grades 4 to 12, a system of its own beside ISO 1328-1.

The printed standard was not at hand, and that of 2020 (classes R30 to R50) was not found; docs/inspection.md says what these formulas agree with.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from gearwear.design.tolerance import CLASS_STEP
from gearwear.errors import InputError
from gearwear.inspection.tolerances import RANGES_1995, Size, geometric_mean, round_micrometres

STANDARD = "ISO 1328-2:1997"
GRADES = range(4, 13)
"""Accuracy grades; larger is coarser."""
DIAMETERS = tuple(limit for limit in RANGES_1995[0] if limit <= 1000.0)
"""Limits of the ranges of d, mm: those of ISO 1328-1:1995 up to 1000."""
MODULES = (0.2, 0.5, 0.8, 1.0, 1.5, 2.5, 4.0, 6.0, 10.0)
"""Limits of the ranges of m_n, mm."""
TOTAL, TOOTH_TO_TOOTH = "radial_composite_total", "radial_composite_tooth_to_tooth"
RADIAL_SYMBOLS: Mapping[str, str] = {TOTAL: "F_i″", TOOTH_TO_TOOTH: "f_i″"}
"""By quantity: total radial composite deviation, and tooth to tooth."""


def check_radial(size: Size) -> None:
    """Refuse a gear for which ISO 1328-2:1997 gives no tolerances.

    Raises
    ------
    InputError
        With the value and the range.
    """
    values = (("reference diameter", size.reference_diameter, DIAMETERS), ("module", size.normal_module, MODULES))
    for label, value, limits in values:
        if not limits[0] <= value <= limits[-1]:
            raise InputError(f"{STANDARD}: {label} {value:g} mm is outside its range, {limits[0]:g} to {limits[-1]:g} mm")


def radial_tolerance(quantity: str, size: Size, iso_grade: int, rounded: bool = True) -> float:
    """Tolerance of F_i″ or f_i″, mm.

    Parameters
    ----------
    quantity : str
        `TOTAL` or `TOOTH_TO_TOOTH`.
    size : Size
        The gear; its face width does not enter.
    iso_grade : int
        One of `GRADES`.
    rounded : bool
        Round as the standard does; False gives the formula's own value.

    Raises
    ------
    InputError
        If the gear is outside the ranges.

    Notes
    -----
    Of grade 5, µm, with d and m_n the geometric means of the limits of their ranges: ``F_i″ = 3.2 m_n + 1.01 √d + 6.4`` and
    ``f_i″ = 2.96 m_n + 0.01 √d + 0.8``; √2 from grade to grade. Their difference is ``F_r = 0.8 F_p`` of the same year.

    >>> [round(1e3 * radial_tolerance(name, Size(10.0, 0.3, 5.0, 33), 5), 1) for name in RADIAL_SYMBOLS]
    [11.0, 1.8]
    """
    check_radial(size)
    d, m = geometric_mean(size.reference_diameter, DIAMETERS), geometric_mean(size.normal_module, MODULES)
    five = {TOTAL: 3.2 * m + 1.01 * math.sqrt(d) + 6.4, TOOTH_TO_TOOTH: 2.96 * m + 0.01 * math.sqrt(d) + 0.8}[quantity]
    value = CLASS_STEP ** (iso_grade - 5) * five
    return 1e-3 * (round_micrometres(value) if rounded else value)

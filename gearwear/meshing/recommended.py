"""Backlash that standards and handbooks recommend for a new pair; nothing is calculated from it.

Inch values are kept as their tables print them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.design.gear import Gear
from gearwear.errors import InputError

MM_PER_INCH = 25.4

_PITCHES = (0.5, 2.0, 3.5, 6.0, 10.0, 20.0)
"""Diametral pitches that part the columns of the coarse-pitch table."""

_COARSE: tuple[tuple[float, tuple[tuple[float, float] | None, ...]], ...] = (
    (5.0, (None, None, None, None, (0.005, 0.015))),
    (10.0, (None, None, None, (0.010, 0.020), (0.010, 0.020))),
    (20.0, (None, None, (0.020, 0.030), (0.015, 0.025), (0.010, 0.020))),
    (30.0, (None, (0.030, 0.040), (0.025, 0.030), (0.020, 0.030), None)),
    (40.0, ((0.040, 0.060), (0.035, 0.045), (0.030, 0.040), (0.025, 0.035), None)),
    (50.0, ((0.050, 0.070), (0.040, 0.055), (0.035, 0.050), (0.030, 0.040), None)),
    (80.0, ((0.060, 0.080), (0.045, 0.065), (0.040, 0.060), None, None)),
    (100.0, ((0.070, 0.095), (0.050, 0.080), None, None, None)),
    (120.0, ((0.080, 0.110), None, None, None, None)),
)
"""Up to this centre distance in inches, the range in inches by column."""

_ASSEMBLY: tuple[tuple[float, float, tuple[float, float]], ...] = (
    (1.0, 1.0, (0.025, 0.040)),
    (2.0, 2.0, (0.014, 0.020)),
    (2.5, 2.5, (0.011, 0.016)),
    (3.0, 3.0, (0.009, 0.014)),
    (4.0, 4.0, (0.007, 0.011)),
    (5.0, 5.0, (0.006, 0.009)),
    (6.0, 6.0, (0.005, 0.008)),
    (7.0, 7.0, (0.004, 0.007)),
    (8.0, 9.0, (0.004, 0.006)),
    (10.0, 13.0, (0.003, 0.005)),
    (14.0, 32.0, (0.002, 0.004)),
)
"""From and to this diametral pitch, the range in inches."""


@dataclass(frozen=True, slots=True)
class RecommendedBacklash:
    """What is recommended for a pair; mm.

    Parameters
    ----------
    least_normal : float
        Least normal backlash by ISO/TR 10064-2.
    coarse_pitch : (float, float) or None
        AGMA's range for coarse pitches, in the normal plane; None where the table has no entry.
    assembly : (float, float) or None
        The classical range for assembly, by diametral pitch alone; None where the table has no entry.
    """

    least_normal: float
    coarse_pitch: tuple[float, float] | None
    assembly: tuple[float, float] | None


def recommended_backlash(pinion: Gear, centre_distance: float) -> RecommendedBacklash:
    """Recommended backlash of a new pair.

    Parameters
    ----------
    pinion : Gear
        Either gear of the pair: its normal module is what is asked for.
    centre_distance : float
        mm.

    Returns
    -------
    RecommendedBacklash

    Raises
    ------
    InputError
        If the centre distance is not above 0.

    Notes
    -----
    ``j_bn,min = ⅔ (0.06 + 0.0005 a + 0.03 m)`` mm (ISO/TR 10064-2; agrees with one independent implementation). AGMA's coarse-pitch
    range as reprinted in handbooks. The range for assembly is that of a handbook (docs/limits.md).

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> found = recommended_backlash(pinion, 114.3)
    >>> round(found.least_normal, 4), found.coarse_pitch, [round(mm, 4) for mm in found.assembly]
    (0.2051, None, [0.1778, 0.2794])
    """
    if not 0.0 < centre_distance < math.inf:
        raise InputError(f"centre distance = {centre_distance:g} mm: must be above 0")
    module = pinion.normal_module
    pitch = round(MM_PER_INCH / module, 9)
    least = 2.0 / 3.0 * (0.06 + 0.0005 * centre_distance + 0.03 * module)
    return RecommendedBacklash(least, _coarse(round(centre_distance / MM_PER_INCH, 9), pitch), _assembly(pitch))


def _coarse(distance: float, pitch: float) -> tuple[float, float] | None:
    column = sum(pitch >= edge for edge in _PITCHES) - 1
    if not 0 <= column < len(_PITCHES) - 1:
        return None
    row = next((ranges for most, ranges in _COARSE if distance <= most), None)
    return None if row is None else _mm(row[column])


def _assembly(pitch: float) -> tuple[float, float] | None:
    return _mm(next((values for low, high, values in _ASSEMBLY if low <= pitch <= high), None))


def _mm(inches: tuple[float, float] | None) -> tuple[float, float] | None:
    return None if inches is None else (inches[0] * MM_PER_INCH, inches[1] * MM_PER_INCH)

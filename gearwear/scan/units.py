"""Units of length, and whether the scan can be in the one that was said."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.scan.types import Scan

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001, "in": 25.4, "inch": 25.4, "ft": 304.8}
"""mm per unit."""

SMALL = 0.1
"""Share of a gear's longest side below which hardly anybody scans a piece of it alone."""
LARGE = 6.0
"""Longest side, in a gear's, beyond which it is no table with a gear on it."""
OFFERED = ("mm", "cm", "m", "um", "in")
READ_WITH = "read with units"
"""How another unit is proposed."""


def factor(units: str) -> float:
    """Millimetres per unit; InputError for a name that is none."""
    if not (isinstance(units, str) and units in UNITS):
        raise InputError(f"units {units!r}: one of {', '.join(OFFERED)} would be right")
    return UNITS[units]


def extents(scan: Scan) -> Floats:
    """How long the scan is along its three principal axes, longest first, (3,) mm.

    Between the 0.1 % and the 99.9 % quantile, so that strays do not count; of at most 50,000 points.
    """
    sample = scan.points[:: 1 + len(scan.points) // 50_000]
    centred = sample - np.median(sample, axis=0)
    axes = np.linalg.eigh(centred.T @ centred)[1]
    low, high = np.quantile(centred @ axes, [0.001, 0.999], axis=0)
    return np.sort(high - low)[::-1]


def outer_diameter(gear: Gear) -> float:
    """Longest side of a gear, mm: its tip diameter, of a ring its rim's, or that of its roots where no rim is stated."""
    return max(2.0 * gear.root_radius, 2.0 * gear.body_radius) if gear.spec.internal else 2.0 * gear.tip_radius


def check_size(scan: Scan, gear: Gear) -> None:
    """Refuse a scan whose size says that it is in another unit.

    Parameters
    ----------
    scan : Scan
        As read.
    gear : Gear
        What it should be of.

    Raises
    ------
    InputError
        If the scan fits the gear in another unit, and not in this one. It names the file, both sizes and the unit.

    Notes
    -----
    Two cases. The size is impossible for any part of this gear, and for a table with it (above `LARGE` or below 0.01 of its longest side) and
    another unit brings it to 0.2 … 1.2. Or it is possible, but in another unit both the
    longest and the shortest side are those of the whole gear or of a view of it (0.75 … 1.1; of a section the two
    sides, 0.9 … 1.1). A size that no unit explains is not refused here: it is another gear, which registration finds.
    """
    measured = extents(scan)
    diameter, width = outer_diameter(gear), gear.face_width
    flat = scan.planar
    whole = np.array([diameter, diameter] if flat else sorted([diameter, diameter, width], reverse=True))
    ratio = measured[: len(whole)] / whole
    if not ratio[0] > 0.0:
        return
    impossible = ratio[0] > LARGE or ratio[0] < 0.01
    least = np.array([0.9, 0.9] if flat else [0.75, 0.0, 0.75])
    best, unit = np.inf, ""
    for name in OFFERED:
        there = ratio * UNITS[name] / UNITS[scan.units]
        fits = bool(((there >= least) & (there <= 1.1)).all())
        if UNITS[name] == UNITS[scan.units] and fits:
            return
        miss = abs(float(np.log(there[0])))
        if (fits or (impossible and 0.2 <= there[0] <= 1.2)) and miss < best:
            best, unit = miss, name
    if not unit:
        return
    shown = " × ".join(f"{side:.4g}" for side in measured[: len(whole)])
    design = f"{'outer' if gear.spec.internal else 'tip'} diameter {diameter:.4g} mm" + (
        "" if flat else f", face width {width:.4g} mm"
    )
    would = _would_be(unit, ratio[0] * UNITS[unit] / UNITS[scan.units])
    raise InputError(f"{', '.join(scan.files)}: measures {shown} mm and the gear has {design}; {would}")


def other_unit(scan: Scan, gear: Gear) -> str:
    """What a refusal of a scan much smaller or larger than its gear adds: in which unit it would be as long as the gear or a part of it; "" where
    in none."""
    length = float(extents(scan)[0])
    ratio = length / outer_diameter(gear)
    if not length > 0.0 or SMALL <= ratio <= 1.5:
        return ""
    fits = {name: ratio * UNITS[name] / UNITS[scan.units] for name in OFFERED}
    near = {name: there for name, there in fits.items() if SMALL <= there <= 1.1}
    if not near:
        return ""
    unit = max(near, key=lambda name: near[name])
    return f"; it is {length:.3g} mm long: {_would_be(unit, near[unit])}"


def _would_be(unit: str, share: float) -> str:
    return f"{READ_WITH} = {unit} it would be {share:.2f} of the gear"

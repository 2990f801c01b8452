"""How far a gear may lie off its drawing: what is stated, or the usual where nothing is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.design.bounds import check_between
from gearwear.design.given import check_whole
from gearwear.errors import InputError

GRADES = {9: 40.0, 11: 100.0, 12: 160.0, 13: 250.0}
"""Standard tolerance in units of i, by grade (ISO 286-1: IT9, IT11, IT12, IT13)."""
FLANK_CLASSES = range(1, 13)
CLASS_STEP = math.sqrt(2.0)
"""Ratio of the tolerances of neighbouring flank tolerance classes."""
USUAL_FLANK_CLASS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class GearTolerance:
    """Tolerances of a gear, each ± about the drawing's value; None where the drawing does not say.

    Parameters
    ----------
    tip_diameter, root_diameter, bore_diameter, face_width : float or None
        mm.
    thickness : float or None
        Of the tooth, mm of arc at the reference circle.
    profile_shift : float or None
        In modules.
    flank_class : int or None
        Flank tolerance class of ISO 1328-1, 1 to 12.
    """

    tip_diameter: float | None = None
    root_diameter: float | None = None
    bore_diameter: float | None = None
    face_width: float | None = None
    thickness: float | None = None
    profile_shift: float | None = None
    flank_class: int | None = None

    def __post_init__(self) -> None:
        if self.flank_class is not None:
            check_whole("[gear.tolerance] flank_class", self.flank_class)
            if self.flank_class not in FLANK_CLASSES:
                raise InputError(
                    f"[gear.tolerance] flank_class = {self.flank_class}: must be a whole number from 1 to 12 (ISO 1328-1)"
                )
        for name in self.__slots__[:-1]:
            if getattr(self, name) is not None:
                unit = "modules" if name == "profile_shift" else "mm"
                check_between("gear.tolerance", name, getattr(self, name), 0.0, 10.0, unit)

    def or_usual(self, tip_diameter: float, root_diameter: float, bore_diameter: float, face_width: float) -> GearTolerance:
        """The tolerances with the usual ones where none is stated, for a gear of these dimensions (mm).

        Notes
        -----
        Usual are, as ±, IT11 for the tip, IT13 for the root (a tool fed for thickness), IT9 for the bore, IT12 for the face width, half of
        IT11 of the tip diameter for the tooth's thickness, 0.05 modules of shift, flank class 8: classes of general machining, wider than
        most drawings.
        """
        usual = {
            "tip_diameter": standard_tolerance(tip_diameter, 11),
            "root_diameter": standard_tolerance(root_diameter, 13),
            "bore_diameter": standard_tolerance(bore_diameter, 9) if bore_diameter > 0.0 else 0.0,
            "face_width": standard_tolerance(face_width, 12),
            "thickness": 0.5 * standard_tolerance(tip_diameter, 11),
            "profile_shift": 0.05,
        }
        told = {name: usual[name] if getattr(self, name) is None else getattr(self, name) for name in usual}
        return GearTolerance(**told, flank_class=USUAL_FLANK_CLASS if self.flank_class is None else self.flank_class)


def standard_tolerance(size: float, grade: int) -> float:
    """Standard tolerance IT of a dimension, mm (ISO 286-1).

    ``IT = n i, i = 0.45 ∛D + 0.001 D`` in µm with D in mm, n by grade; the standard's tables take D in steps, which moves them by some
    per cent.

    >>> round(1e3 * standard_tolerance(40.0, 9))  # the table says 62 µm for 30 to 50 mm
    63
    """
    return float(1e-3 * GRADES[grade] * (0.45 * np.cbrt(size) + 0.001 * size))


def profile_form_tolerance(module: float, flank_class: int | None) -> float:
    """Profile form tolerance f_fαT of a normal module (mm), mm (ISO 1328-1:2013, not rounded; it agrees with three independent implementations).

    ``f_fαT = (0.55 m + 5) √2^(A − 5)`` in µm.

    >>> round(1e3 * profile_form_tolerance(4.0, 8), 1)
    20.4
    """
    steps = (USUAL_FLANK_CLASS if flank_class is None else flank_class) - 5
    return float(1e-3 * profile_form_of_class_five(module) * CLASS_STEP**steps)


def profile_form_of_class_five(module: float) -> float:
    """f_fαT of class 5 at a normal module (mm), µm."""
    return 0.55 * module + 5.0

"""What the gear weighed before and after: ``[weighing]`` of a design file."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwear.errors import InputError

DENSITY = {
    "steel": 7.85, "stainless_steel": 7.9, "cast_iron": 7.2, "aluminium": 2.7, "brass": 8.5, "bronze": 8.8, "titanium": 4.43, "pom": 1.41,
    "pa66": 1.14,
}  # fmt: skip
"""g/cm³ by material: usual values of handbooks."""
DENSITY_STD = 0.01
"""Relative standard deviation of a density that is taken from the material's name, or stated without one."""


@dataclass(frozen=True, slots=True)
class WeighingSpec:
    """Two weighings of one gear.

    Parameters
    ----------
    before, after : float
        g.
    std : float
        Of one weighing, one standard deviation, g.
    density : float
        g/cm³.
    density_std : float
        Its relative standard deviation.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    before: float
    after: float
    std: float
    density: float
    density_std: float = DENSITY_STD

    def __post_init__(self) -> None:
        for label, value, low, high, unit in (
            ("before_g", self.before, 1e-6, 1e9, "g"),
            ("after_g", self.after, 1e-6, 1e9, "g"),
            ("std_g", self.std, 1e-9, 1e6, "g"),
            ("density_g_cm3", self.density, 0.1, 25.0, "g/cm³"),
            ("density_std_percent", 100.0 * self.density_std, 0.0, 50.0, "%"),
        ):
            if not low <= value <= high:  # refuses NaN too
                raise InputError(f"[weighing] {label} = {value:g} {unit}: must lie from {low:g} to {high:g}")

    @property
    def lost_mass(self) -> float:
        """g."""
        return self.before - self.after

    @property
    def lost_volume(self) -> tuple[float, float]:
        """Volume that was lost, mm³, and its standard deviation: ``V = (m1 − m2) / ρ``, the terms of GUM 5.1.2."""
        volume = 1e3 * self.lost_mass / self.density
        return volume, math.hypot(1e3 * math.sqrt(2.0) * self.std / self.density, volume * self.density_std)

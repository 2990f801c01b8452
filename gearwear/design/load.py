"""What the user says about the load of a pair: ``[load]`` of a design file."""

from __future__ import annotations

from dataclasses import dataclass

from gearwear.design.given import check_number
from gearwear.errors import InputError

UNITS = {
    "torque": "N mm",
    "load_per_width": "N/mm",
    "speed_rpm": "1/min",
    "elastic_modulus": "MPa",
    "poisson": "",
    "misalignment": "mm",
}
"""Of what is said about a load."""
OPTIONAL = {"torque", "load_per_width", "speed_rpm"}
"""Of these, what need not be said: None."""


@dataclass(frozen=True, slots=True)
class LoadSpec:
    """The load of a pair and what its teeth are made of. One of torque and load per width is given.

    Parameters
    ----------
    torque : float or None
        Of the pinion, N mm.
    load_per_width : float or None
        Tooth force on all pairs per common face width, along the transverse line of action, N/mm; without the groove of double helical gears.
    speed_rpm : float or None
        Of the pinion, 1/min; it only gives the mesh frequency: nothing here is dynamic.
    elastic_modulus : float
        E of both gears, MPa.
    poisson : float
        ν.
    misalignment : float
        Gap in the plane of action over the common face width, mm, along the transverse line of action; + opens towards the upper end on the pinion's left flank.

    Raises
    ------
    InputError
        If a value is impossible, or torque and load are both given or neither.
    """

    torque: float | None = None
    load_per_width: float | None = None
    speed_rpm: float | None = None
    elastic_modulus: float = 206_000.0
    poisson: float = 0.3
    misalignment: float = 0.0

    def __post_init__(self) -> None:
        if (self.torque is None) == (self.load_per_width is None):
            how_many = "both given" if self.torque is not None else "both missing"
            raise InputError(f"[load] torque_Nm and load_per_width_N_mm are {how_many}: one of them is needed")
        for name, unit in UNITS.items():
            if getattr(self, name) is not None or name not in OPTIONAL:
                check_number(name, getattr(self, name), unit)
        if self.torque is not None:
            _above("torque_Nm", 1e-3 * self.torque, 1e9)
        if self.load_per_width is not None:
            _above("load_per_width_N_mm", self.load_per_width, 1e5)
        if self.speed_rpm is not None:
            _within("speed_rpm", self.speed_rpm, 0.0, 1e6)
        _within("elastic_modulus_MPa", self.elastic_modulus, 10.0, 1e7)
        _within("poisson", self.poisson, 0.0, 0.49)
        _within("misalignment_um", 1e3 * self.misalignment, -1e4, 1e4)

    def force(self, pinion_base_radius: float, width: float) -> float:
        """Transverse tooth force on all pairs, N, for the pinion's base radius and the common face width in mm."""
        if self.torque is not None:
            return self.torque / pinion_base_radius
        assert self.load_per_width is not None
        return self.load_per_width * width


def _above(label: str, value: float, high: float) -> None:
    """Refuse what is no load: without one nothing is elastic, and every share of it is 0 / 0."""
    if not 0.0 < value <= high:  # refuses NaN too
        raise InputError(f"[load] {label} = {value:g}: must be above 0 and at most {high:g}")


def _within(label: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:  # refuses NaN too
        raise InputError(f"[load] {label} = {value:g}: must lie from {low:g} to {high:g}")

"""Parameters of effects: what each one says, its unit and its sign; the one place where inner units become reported ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from gearwear.arrays import Floats

FACTORS = {"um": 1e3, "mm": 1.0, "deg": 180.0 / math.pi, "ppm": 1e6, "1": 1.0}
"""Reported unit per inner unit (mm, rad, ratio, number); the units' names are those of `gearwear.design.quantity.UNITS`."""


class Role(StrEnum):
    """SIZE: how large an effect is; all sizes 0 is no effect. PLACE: where it is, which way it points or how fine it is."""

    SIZE = "size"
    PLACE = "place"


class Spread(StrEnum):
    """What a ± of a parameter means. SMOOTH: first order in the covariance of the fit. JUMP: the place of a step, known to the noise beside
    it and not by a slope. NONE: a number chosen among a few, which has no ±."""

    SMOOTH = "smooth"
    JUMP = "jump"
    NONE = "none"


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """A reported parameter: value and standard deviation in `unit`; a list where there is one per tooth."""

    value: float | tuple[float, ...]
    std: float | tuple[float, ...]
    unit: str


@dataclass(frozen=True, slots=True)
class Parameter:
    """One reported parameter of an effect.

    Parameters
    ----------
    name : str
        As in the contract; its end is its unit, a name without one is a number.
    role : Role
    signed : bool
        False where it cannot be below 0.
    period : float or None
        Of a direction or a phase, in reported units: values lie from 0 to it.
    spread : Spread
    """

    name: str
    role: Role = Role.SIZE
    signed: bool = True
    period: float | None = None
    spread: Spread = Spread.SMOOTH

    @property
    def unit(self) -> str:
        """``um``, ``mm``, ``deg``, ``ppm``, or ``1``.

        >>> Parameter("depth_um").unit, Parameter("order").unit
        ('um', '1')
        """
        unit = self.name.rsplit("_", 1)[-1]
        return unit if unit in FACTORS else "1"

    def estimate(self, value: float, std: float) -> ParameterEstimate:
        """An inner value (mm, rad, ratio) in the parameter's unit.

        >>> Parameter("depth_um").estimate(0.012, 0.001)
        ParameterEstimate(value=12.0, std=1.0, unit='um')
        """
        factor = FACTORS[self.unit]
        reported = value * factor
        if self.period is not None:
            reported %= self.period
        return ParameterEstimate(reported, 0.0 if self.spread is Spread.NONE else std * factor, self.unit)

    def estimates(self, values: Floats, stds: Floats) -> ParameterEstimate:
        """The same of a list, (n,)."""
        factor = FACTORS[self.unit]
        return ParameterEstimate(
            tuple((factor * np.asarray(values)).tolist()), tuple((factor * np.asarray(stds)).tolist()), self.unit
        )


def angular(name: str, period: float = 360.0, spread: Spread = Spread.SMOOTH) -> Parameter:
    """A phase, a direction or a place round the gear."""
    return Parameter(name, Role.PLACE, period=period, spread=spread)

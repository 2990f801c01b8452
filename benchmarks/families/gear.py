"""Numbers of a spur gear and the exact involute, from the definitions of ISO 21771; mm and rad."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class GearNumbers:
    """A spur gear as made.

    Parameters
    ----------
    teeth : int
    module, face_width : float
        mm.
    pressure_angle : float
        Of the reference profile, degrees.
    profile_shift, addendum, dedendum : float
        In modules.
    thinning : float
        Arc taken from the tooth at the reference circle, mm.
    tip_change : float
        Tip diameter beyond that of the addendum, mm.
    bore : float
        Diameter, mm; 0: none.
    """

    teeth: int
    module: float
    face_width: float
    pressure_angle: float = 20.0
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    thinning: float = 0.0
    tip_change: float = 0.0
    bore: float = 0.0

    @property
    def alpha(self) -> float:
        return math.radians(self.pressure_angle)

    @property
    def reference_radius(self) -> float:
        return 0.5 * self.module * self.teeth

    @property
    def base_radius(self) -> float:
        return self.reference_radius * math.cos(self.alpha)

    @property
    def tip_radius(self) -> float:
        return self.reference_radius + self.module * (self.addendum + self.profile_shift) + 0.5 * self.tip_change

    @property
    def root_radius(self) -> float:
        return self.reference_radius - self.module * (self.dedendum - self.profile_shift)

    @property
    def reference_roll(self) -> float:
        """Roll length L at the reference circle."""
        return self.base_radius * math.tan(self.alpha)

    @property
    def tip_roll(self) -> float:
        return self.roll(self.tip_radius)

    @property
    def thickness(self) -> float:
        """Arc of a tooth at the reference circle."""
        return self.module * (0.5 * math.pi + 2.0 * self.profile_shift * math.tan(self.alpha)) - self.thinning

    @property
    def base_half_angle(self) -> float:
        """Half the angle of a tooth on the base circle."""
        return self.thickness / (2.0 * self.reference_radius) + math.tan(self.alpha) - self.alpha

    @property
    def pitch_angle(self) -> float:
        return 2.0 * math.pi / self.teeth

    def roll(self, radius: float) -> float:
        """Roll length of a radius; 0 within the base circle."""
        return math.sqrt(max(radius**2 - self.base_radius**2, 0.0))

    def half_angle(self, roll: Array | float) -> Array:
        """Half the angle of a tooth where its flank has the roll length `roll`."""
        xi = np.asarray(roll, dtype=np.float64) / self.base_radius
        return self.base_half_angle - (xi - np.arctan(xi))


def flank_point(gear: GearNumbers, tooth: Array, side: Array, roll: Array, deviation: Array) -> tuple[Array, Array]:
    """Points of flanks moved along their normals.

    Parameters
    ----------
    gear : GearNumbers
    tooth, side, roll, deviation : (n,) array
        Tooth from 0 counter-clockwise, side +1 left (counter-clockwise flank) or −1, roll length of the foot and
        distance from it along the outward normal, mm.

    Returns
    -------
    points, normals : (n, 2) float
        In the transverse plane, tooth 0 on +x.
    """
    tau = tooth * gear.pitch_angle + side * (gear.base_half_angle - roll / gear.base_radius)
    along = np.stack([np.cos(tau), np.sin(tau)], axis=-1)
    normal = np.stack([-np.sin(tau) * side, np.cos(tau) * side], axis=-1)
    return gear.base_radius * along + (roll + deviation)[..., None] * normal, normal

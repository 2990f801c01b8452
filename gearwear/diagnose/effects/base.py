"""What an effect is: a file with one class that says how the deviations change.

``deviation = basis(points, shape) @ amplitudes``. What is linear is an amplitude, in mm or rad inside; what is not (an
order, a wavelength, a start) is a shape value, and the effect offers a grid of them. Every sign and unit of the reported parameters
is fixed by the contract and stands in the effect's docstring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import FILLET, FLANK, SurfacePoints

Shape = tuple[float, ...]
"""Values of an effect's nonlinear parameters; () where it has none."""


class Kind(StrEnum):
    """Where an effect comes from; only WEAR counts as worn volume."""

    MEASUREMENT = "measurement"
    MOUNTING = "mounting"
    MANUFACTURE = "manufacture"
    WEAR = "wear"


@dataclass(frozen=True, slots=True)
class Estimate:
    """A reported parameter: value and standard deviation in `unit`; a list where there is one per tooth."""

    value: float | tuple[float, ...]
    std: float | tuple[float, ...]
    unit: str


@dataclass(frozen=True, slots=True)
class Context:
    """What an effect may need to know besides the points.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    surfaces : frozenset of int
        Surface codes the scan has seen.
    scan_axes : (3, 3) float
        The scan's own axes in the design frame, as columns.
    planar : bool
        True for a planar section.
    mate : (float, float) or None
        Gear ratio z2 / z1 and length C sin α' of the line of action (mm), where the design has a mate.
    """

    gear: Gear
    surfaces: frozenset[int]
    scan_axes: Floats
    planar: bool = False
    mate: tuple[float, float] | None = None

    def sliding(self, roll: Floats) -> Floats:
        """Specific sliding K1 = 1 − L2 / (u L1) at rolls L (mm); linear in L from the pitch point where there is no mate."""
        if self.mate is None:
            return np.asarray((roll - self.gear.reference_roll) / self.gear.reference_roll)
        ratio, line = self.mate
        return np.asarray(1.0 - (line - roll) / (ratio * roll))


@runtime_checkable
class Effect(Protocol):
    """What the search asks of an effect."""

    name: ClassVar[str]
    kind: ClassVar[Kind]
    source: ClassVar[str]
    parameters: ClassVar[tuple[str, ...]]
    """Names of the reported parameters, as in the contract."""
    group: ClassVar[str]
    """Identifiability group on flanks alone (reference: G1 … G7), "" where it has none."""
    tooth_specific: ClassVar[bool]
    """True where a left-out tooth cannot be predicted; it is then judged on left-out blocks along z."""

    def applies(self, context: Context) -> bool:
        """Whether this scan could show it at all."""
        ...

    def shapes(self, context: Context) -> list[Shape]:
        """Grid of shape values to try; ``[()]`` for a linear effect."""
        ...

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        """(n, p) deviation in mm per unit of each amplitude."""
        ...

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        """Whether sign and size are physically possible."""
        ...

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        """Amplitudes as the contract's parameters."""
        ...


@dataclass(frozen=True)
class LinearEffect:
    """An effect without shape, one reported parameter per amplitude.

    Subclasses set the class variables and write `basis`.
    """

    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = ()
    unit: ClassVar[str] = "um"
    per_unit: ClassVar[float] = 1e3
    """Reported unit per inner unit: 1e3 for mm to µm, 1e6 for a ratio to ppm."""
    lower: ClassVar[float] = -math.inf
    upper: ClassVar[float] = math.inf
    """Bounds of every amplitude, inner units."""

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [()]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(np.all((amplitudes >= self.lower) & (amplitudes <= self.upper)))

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        return {
            name: Estimate(float(a) * self.per_unit, float(s) * self.per_unit, self.unit)
            for name, a, s in zip(self.parameters, amplitudes, std, strict=True)
        }


def polar_estimate(amplitudes: Floats, covariance: Floats) -> tuple[float, float, float, float]:
    """Size, its std, phase and its std (rad) of a pair (a cos φ, −a sin φ), so that ``a cos(x + φ) = pair · (cos x, sin x)``."""
    a, b = float(amplitudes[0]), float(amplitudes[1])
    size = math.hypot(a, b)
    phase = math.atan2(-b, a)
    along = np.array([a, b]) / max(size, 1e-300)
    across = np.array([-along[1], along[0]])
    var_size, var_across = float(along @ covariance @ along), float(across @ covariance @ across)
    return size, math.sqrt(max(var_size, 0.0)), phase, math.sqrt(max(var_across, 0.0)) / max(size, 1e-300)


def radial(points: SurfacePoints) -> Floats:
    """n · e_r, (n,): deviation per mm of radial displacement."""
    r = np.hypot(points.position[:, 0], points.position[:, 1])
    return np.asarray((points.position[:, 0] * points.normal[:, 0] + points.position[:, 1] * points.normal[:, 1]) / r)


def turning(points: SurfacePoints) -> Floats:
    """(r × n)_z in mm, (n,): deviation per rad of rotation about the axis; s r_b on flanks."""
    return np.asarray(points.position[:, 0] * points.normal[:, 1] - points.position[:, 1] * points.normal[:, 0])


def polar_angle(points: SurfacePoints) -> Floats:
    """θ of the foot points, rad."""
    return np.asarray(np.arctan2(points.position[:, 1], points.position[:, 0]))


def on_flank(points: SurfacePoints) -> Bools:
    """Mask of flank points."""
    return np.asarray(points.surface == FLANK)


def on_side(points: SurfacePoints) -> Bools:
    """Mask of flank and fillet points."""
    return np.asarray((points.surface == FLANK) | (points.surface == FILLET))


def profile_coordinate(points: SurfacePoints, gear: Gear) -> Floats:
    """u: −1 at the form circle, +1 at the tip, linear in L; 0 off the flanks."""
    middle, half = 0.5 * (gear.tip_roll + gear.form_roll), 0.5 * (gear.tip_roll - gear.form_roll)
    return np.where(on_flank(points), (np.nan_to_num(points.roll) - middle) / half, 0.0)


def face_coordinate(points: SurfacePoints, gear: Gear) -> Floats:
    """ζ = z / b − ½."""
    return np.asarray(points.position[:, 2] / gear.face_width - 0.5)

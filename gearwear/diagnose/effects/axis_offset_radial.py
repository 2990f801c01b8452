"""Radial axis offset: the laser's zero lies off the table's axis, along the line of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, radial
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class AxisOffsetRadial(CatalogueEffect):
    """Every radius grows by d: δ = d (n · e_r), on flanks d L / r, on tips and roots d.

    Notes
    -----
    A radial beam and a table axis on the gear's axis are assumed. On flanks a thickness and a scale explain 99.9 % of it;
    tip : pitch : root go as 1 : 0.34 : 1.
    """

    name: ClassVar[str] = "axis_offset_radial"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "polar coordinates with a wrong zero of the radius"
    tells_apart: ClassVar[str] = (
        "Scan plain cylinders of two known diameters on the same table: an offset adds the same to both radii, a scale adds in proportion."
    )
    group: ClassVar[str] = "G2"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("offset_um"),)
    phrase: ClassVar[str] = "a laser zero {offset_um} off along the line of sight (every radius reads too large)"
    phrase_below: ClassVar[str] = "a laser zero {offset_um} off along the line of sight (every radius reads too small)"

    def applies(self, context: Context) -> bool:
        return context.turntable

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        # On surfaces that reach from root to tip it is nearly a scale: one that no calibrated instrument has is none of this either.
        return abs(float(amplitudes[0])) <= context.scale_limit * context.gear.tip_radius

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return radial(points)[:, None]

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        radius = np.maximum(np.hypot(position[:, 0], position[:, 1]), 1e-9)
        return np.asarray(position * np.array([1.0, 1.0, 0.0]) * (amplitudes[0] / radius)[:, None])


EFFECT = AxisOffsetRadial()

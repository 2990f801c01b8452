"""Lateral axis offset: the laser's zero lies off the table's axis, across the line of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, turned, turning
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class AxisOffsetLateral(CatalogueEffect):
    """θ grows by h / r: δ = h (n · e_θ), on flanks s h cos α_r, nothing radial.

    Notes
    -----
    99.6 % of it on flanks is a rotation, which the pose owns; what is left, about 0.13 h, grows from root to tip with opposite
    sign on the two sides.
    """

    name: ClassVar[str] = "axis_offset_lateral"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "polar coordinates with a line of sight that misses the axis"
    tells_apart: ClassVar[str] = (
        "Turn the part upside down and scan again: the scanner's offset keeps its sense about the table, a form of the flanks changes it."
    )
    group: ClassVar[str] = "G3"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("offset_um"),)
    phrase: ClassVar[str] = "a laser line that passes the table's axis by {offset_um}"

    def applies(self, context: Context) -> bool:
        return context.turntable

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        r = np.hypot(points.position[:, 0], points.position[:, 1])
        return np.asarray((turning(points) / np.maximum(r, 1e-9))[:, None])

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        return turned(position, amplitudes[0] / np.maximum(np.hypot(position[:, 0], position[:, 1]), 1e-9))


EFFECT = AxisOffsetLateral()

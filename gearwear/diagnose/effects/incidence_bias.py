"""Incidence bias: the range is wrong by more the more slanting the surface is to the beam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, radial
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class IncidenceBias(CatalogueEffect):
    """δ = b (1 − cos i) with cos i = |n · e_r|, for a radial beam: + reads too high where the surface slants.

    Notes
    -----
    On a slanting surface the spot is longer by 1 / cos i, and the centre of its image lies off by a share of what is added: a range error b
    (1 / cos i − 1) towards the sensor, which moves the surface by that times cos i along its normal. Tips, roots and
    bore (i = 0) read true; flanks have 1 − L / r: 0.91 b at the form circle of a 12-tooth pinion, 0.41 b at its tip, so that flanks alone show a
    thickness and a slope. End faces, which a radial beam does not see, are left out.
    Of a scan that was smoothed it is not sought: `smoothing` sinks flanks in nearly the same way, and is there for certain.
    """

    name: ClassVar[str] = "incidence_bias"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "own definition: range error in proportion to the lengthening of the spot on a slanting surface"
    tells_apart: ClassVar[str] = (
        "Scan one flank again with the sensor turned to look square at it: the bias goes with the angle, the flank's form stays."
    )
    group: ClassVar[str] = "G7"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("bias_um"),)
    phrase: ClassVar[str] = "a range bias of {bias_um} that grows with the angle of incidence"

    def applies(self, context: Context) -> bool:
        return context.turntable and not context.smoothed

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        end = (points.surface == END_LOW) | (points.surface == END_HIGH)
        return np.where(end, 0.0, 1.0 - np.abs(radial(points)))[:, None]


EFFECT = IncidenceBias()

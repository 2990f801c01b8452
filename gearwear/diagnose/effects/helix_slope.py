"""Helix slope: the flank runs out of lead by a straight line along the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, face_coordinate, on_flank, on_side, turning


@dataclass(frozen=True)
class HelixSlope(LinearEffect):
    """δ = s f ζ: both flanks screwed the same way; f is the rise over the face width.

    Notes
    -----
    The part that is equal on both flanks is `taper`. ISO 1328-1 signs the helix slope by hand and flank; here the screw's own sign
    is used, + when left flanks gain metal towards the upper end.
    """

    name: ClassVar[str] = "helix_slope"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 1328-1:2013, helix slope deviation f_Hβ"
    parameters: ClassVar[tuple[str, ...]] = ("slope_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]  # the tool that made the flank made the fillet too, or it did not (ground flanks)

    def applies(self, context: Context) -> bool:
        return not context.planar

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        moved = on_side(points) if shape[0] else on_flank(points)
        turn = turning(points) / context.gear.base_radius * face_coordinate(points, context.gear)
        return np.where(moved, turn, 0.0)[:, None]


EFFECT = HelixSlope()

"""Wobble: the teeth stand askew on the end faces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, END_HIGH, END_LOW, TIP, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, WaveEffect, face_coordinate
from gearwear.diagnose.parameter import Parameter, angular


@dataclass(frozen=True)
class Wobble(WaveEffect):
    """The toothing leans against its end faces about its middle: δ = 2ζ (n · a) − (2 / b) n_z (p · a), with a the swing of its upper end.

    Notes
    -----
    The amplitude is the swing at either end of the face, half the face width times the angle; the direction, from the design's +x,
    is where the upper end leans. The bore leans with the teeth it was made with, or stays with the ends: both are tried. Without
    end faces the tilt is part of the pose and not named.
    """

    name: ClassVar[str] = "wobble"
    kind: ClassVar[Kind] = Kind.MOUNTING
    source: ClassVar[str] = "small rotation of the teeth about a diameter at mid-face"
    tells_apart: ClassVar[str] = (
        "Put the gear on a mandrel and measure the axial runout of its end faces: faces that the scan located badly show none there."
    )
    group: ClassVar[str] = "G6"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amplitude_um", signed=False), angular("direction_deg"))
    turns: ClassVar[float] = -1.0
    phrase: ClassVar[str] = "a gear that wobbles by {amplitude_um} towards {direction_deg}"

    def applies(self, context: Context) -> bool:
        return not context.planar and bool({END_LOW, END_HIGH} & context.surfaces)

    def shapes(self, context: Context) -> list[Shape]:
        return [(1.0,), (0.0,)] if BORE in context.surfaces else [()]

    def largest(self, context: Context) -> float:
        return 0.05 * context.gear.face_width

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        leans = points.surface <= TIP
        if shape and shape[0]:
            leans = leans | (points.surface == BORE)
        height = 2.0 * face_coordinate(points, context.gear)
        lifted = points.position[:, :2] * (-2.0 / context.gear.face_width * points.normal[:, 2:])
        return np.where(leans[:, None], height[:, None] * points.normal[:, :2] + lifted, 0.0)


EFFECT = Wobble()

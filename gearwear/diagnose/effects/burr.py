"""Burr: metal pushed over the tip edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, length_bracket, on_flank
from gearwear.diagnose.parameter import Parameter, Role


@dataclass(frozen=True)
class Burr(CatalogueEffect):
    """δ = + h (1 − x/w)² within w of the tip corner on all flanks of one side, x the distance from it along the flank; h ≥ 0.

    Notes
    -----
    Metal is moved, not lost, and a burr is never wear: the search does not try it; a fit that asks for it by name may. In a scan it is
    left to the robust weights, which take single high cells at an edge for strays.
    """

    name: ClassVar[str] = "burr"
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "own definition; burrs: ISO 10825:1995, 3.5"
    tells_apart: ClassVar[str] = "Feel along the tip edge, or deburr and scan again: a burr is gone then."
    searched: ClassVar[bool] = False
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("height_um", signed=False),
        Parameter("width_mm", Role.PLACE, signed=False),
    )
    phrase: ClassVar[str] = "a burr {height_um} high"
    lower: ClassVar[float] = 0.0

    def shapes(self, context: Context) -> list[Shape]:
        return [(share * context.gear.transverse_module, side) for side in (1.0, -1.0) for share in (0.1, 0.2)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return length_bracket(shape[0])

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        below = gear.orientation * (gear.tip_roll**2 - np.nan_to_num(points.roll) ** 2) / (2.0 * gear.base_radius)
        near = np.maximum(1.0 - np.maximum(below, 0.0) / shape[0], 0.0)
        return np.where(on_flank(points) & (points.side == shape[1]), near**2, 0.0)[:, None]


EFFECT = Burr()

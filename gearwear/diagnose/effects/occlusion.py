"""Occlusion in the tooth space: light caught between the flanks makes the root read too high."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FILLET, ROOT, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, length_bracket, on_flank
from gearwear.diagnose.parameter import Parameter, Role


@dataclass(frozen=True)
class Occlusion(CatalogueEffect):
    """δ = + b exp(−(L − L_form) / l) on flanks; below the form circle b, or nothing, as a choice. Never negative.

    Notes
    -----
    Deep in the space one leg of the triangulation is cut off and light reflected from the opposite flank adds to the image (multipath): the
    range comes out short, mostly below L = 6 mm on the 12-tooth pinion. Root wear is the opposite sign, and so is a root relief.
    """

    name: ClassVar[str] = "occlusion"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "own definition: multipath in a groove, fading with height over the form circle"
    tells_apart: ClassVar[str] = (
        "Scan the roots again with the sensor tilted or under a matt coat: caught light changes with both, metal left standing does not."
    )
    averaged: ClassVar[str] = "roll"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("height_um", signed=False),
        Parameter("decay_mm", Role.PLACE, signed=False),
    )
    phrase: ClassVar[str] = "roots that read {height_um} too high, as light caught in the space makes them"
    lower: ClassVar[float] = 0.0

    def shapes(self, context: Context) -> list[Shape]:
        m = context.gear.transverse_module
        return [(share * m, roots) for roots in (1.0, 0.0) for share in (0.12, 0.25, 0.5)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return length_bracket(shape[0])

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        flank = on_flank(points)
        above = np.where(flank, context.gear.orientation * (np.nan_to_num(points.roll) - context.gear.form_roll), 0.0)
        low = (points.surface == FILLET) | (points.surface == ROOT)
        # A foot may lie a little below the form circle, where a point of the flank has its own radius above it.
        return np.where(flank, np.exp(-np.maximum(above, 0.0) / shape[0]), np.where(low, shape[1], 0.0))[:, None]


EFFECT = Occlusion()

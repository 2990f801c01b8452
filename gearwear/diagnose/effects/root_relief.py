"""Root relief: metal taken off towards the form circle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, of_transverse, on_flank, roll_bracket
from gearwear.diagnose.parameter import Parameter, Role


@dataclass(frozen=True)
class RootRelief(CatalogueEffect):
    """δ = −C (L_r − L) / (L_r − L_form) below the start L_r; the same on both flanks of every tooth.

    Notes
    -----
    Nothing is added at the start: above it the flank stays. The fillet is left as the tool made it.
    """

    name: ClassVar[str] = "root_relief"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition of root relief"
    tells_apart: ClassVar[str] = (
        "Measure the profile of an unworn tooth or of a coast flank on a gear tester: wear at the root is on loaded flanks only, a relief on all."
    )
    averaged: ClassVar[str] = "roll"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amount_um", signed=False),
        Parameter("start_mm", Role.PLACE, signed=False),
    )
    like_coast_wear: ClassVar[bool] = True
    phrase: ClassVar[str] = "root relief of {amount_um} below a roll length of {start_mm}"
    lower: ClassVar[float] = 0.0

    def shapes(self, context: Context) -> list[Shape]:
        gear = context.gear
        return [(gear.form_roll + share * (gear.tip_roll - gear.form_roll),) for share in (0.2, 0.3, 0.4, 0.5, 0.6)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return roll_bracket(shape[0], context.gear)

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        form = context.gear.form_roll
        share = np.fmax((shape[0] - points.roll) / (shape[0] - form), 0.0)  # nan is no number to `fmax`
        return np.where(on_flank(points), of_transverse(-share, context.gear), 0.0)[:, None]


EFFECT = RootRelief()

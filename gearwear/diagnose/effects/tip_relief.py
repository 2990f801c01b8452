"""Tip relief: metal taken off towards the tip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, ReliefEffect, Shape, of_transverse, on_flank, roll_bracket
from gearwear.diagnose.parameter import Parameter, Role, Spread


@dataclass(frozen=True)
class TipRelief(ReliefEffect):
    """δ = −C ((L − L_r) / (L_tip − L_r))ⁿ above the start L_r; the same on both flanks of every tooth.

    Notes
    -----
    n = 1, a straight relief, or n = 2, a parabola that leaves the involute without a knee. Nothing is added at the start: below it the flank
    stays. With a tip chamfer L_tip is where the involute ends.
    """

    name: ClassVar[str] = "tip_relief"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; tip relief C_αa of ISO 21771 and ISO 1328-1"
    tells_apart: ClassVar[str] = (
        "Look at tip lands and face edges: rounding by the spot is on every edge, a relief on flanks only, and on the side that was relieved."
    )
    averaged: ClassVar[str] = "roll"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amount_um", signed=False),
        Parameter("start_mm", Role.PLACE, signed=False),
        Parameter("exponent", Role.PLACE, signed=False, spread=Spread.NONE),
    )
    phrase: ClassVar[str] = "tip relief of {amount_um} from a roll length of {start_mm}"

    def shapes(self, context: Context) -> list[Shape]:
        gear = context.gear
        starts = [gear.form_roll + share * (gear.tip_roll - gear.form_roll) for share in (0.4, 0.5, 0.6, 0.7, 0.8, 0.9)]
        return [(start,) for start in starts] + [(start, 2.0) for start in starts]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return roll_bracket(shape[0], context.gear)

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        tip, start = context.gear.tip_roll, shape[0]
        share = np.fmax((points.roll - start) / (tip - start), 0.0) ** self.exponent(shape)  # nan is no number to `fmax`
        return np.where(on_flank(points), of_transverse(-share, context.gear), 0.0)[:, None]


EFFECT = TipRelief()

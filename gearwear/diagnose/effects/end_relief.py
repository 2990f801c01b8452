"""End relief: metal taken off towards both ends of the face; the middle stays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.design.twist import segments
from gearwear.diagnose.effects.base import Context, Kind, ReliefEffect, Shape, helix_place, side_cut
from gearwear.diagnose.parameter import Parameter, Role, Spread

LONGEST = {1.0: 0.25, 2.0: 0.34}
"""Length, in the face width, from which on a straight or parabolic relief does 95 % of what a crowning does."""
SHORTEST, LEAST_ROWS = 0.1, 2.5
"""Share of the face width, and rows of cells, over which a relief reaches at least: what falls off in less is an edge that was broken or smoothed."""


@dataclass(frozen=True)
class EndRelief(ReliefEffect):
    """δ = −C (1 − e / l)ⁿ within l of either end of the face, e the distance from it; the same on both flanks of every tooth.

    Notes
    -----
    n = 1, a straight relief, or n = 2, a parabola that leaves the flank without a knee; a longer one is a `helix_crowning`. Fillets follow their
    flanks, or do not. On a double helical gear each half is relieved by itself.
    """

    name: ClassVar[str] = "end_relief"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; end relief C_β of ISO 21771 and ISO 1328-1"
    tells_apart: ClassVar[str] = (
        "Measure the helix of an unworn tooth on a gear tester: a relief has its own length, crowning bends over the whole face."
    )
    averaged: ClassVar[str] = "z"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amount_um", signed=False),
        Parameter("length_mm", Role.PLACE, signed=False),
        Parameter("exponent", Role.PLACE, signed=False, spread=Spread.NONE),
    )
    phrase: ClassVar[str] = "ends of the flanks relieved by {amount_um} over {length_mm}"
    straight: ClassVar[int] = 2  # length, and whether the fillets follow

    def applies(self, context: Context) -> bool:
        return not context.planar

    def shapes(self, context: Context) -> list[Shape]:
        return [
            (share * _width(context), fillets, *([exponent] if exponent > 1.0 else []))
            for exponent, longest in LONGEST.items()
            for share in (0.13, 0.19, 0.25, 0.31)
            for fillets in (0.0, 1.0)
            if _shortest(context) <= share * _width(context) and share <= longest
        ]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        width, longest = _width(context), LONGEST[self.exponent(shape)]
        return [(max(shape[0] - 0.07 * width, _shortest(context)), min(shape[0] + 0.07 * width, longest * width))]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear, (length, fillets) = context.gear, shape[:2]
        inside = (0.5 - np.abs(helix_place(points, gear))) * _width(context)
        share = np.clip(1.0 - inside / length, 0.0, None) ** self.exponent(shape)
        return (-points.side * side_cut(points, gear, fillets) * share)[:, None]


def _width(context: Context) -> float:
    """Of the face, or of each half, mm."""
    low = segments(context.gear)[0]
    return low.high - low.low


def _shortest(context: Context) -> float:
    return max(SHORTEST * _width(context), LEAST_ROWS * context.row_height)


EFFECT = EndRelief()

"""Helix crowning: the flank bulges at mid-face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, helix_place, side_cut
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class HelixCrowning(CatalogueEffect):
    """δ = −c (2ζ)²: nothing at mid-face, −c at the two ends; + is a bulge. Fillets follow their flanks, or do not.

    On a double helical gear each half is crowned by itself.
    """

    name: ClassVar[str] = "helix_crowning"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; second order analysis: ISO 1328-1:2013, annex B"
    tells_apart: ClassVar[str] = (
        "Shift the part along the laser line and scan again: a bow of the scanner stays with the line, crowning goes with the part."
    )
    group: ClassVar[str] = "G7"
    averaged: ClassVar[str] = "z"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("crowning_um"),)
    phrase: ClassVar[str] = "flanks crowned lengthwise by {crowning_um}"
    phrase_below: ClassVar[str] = "flanks hollow lengthwise by {crowning_um}"

    def applies(self, context: Context) -> bool:
        return not context.planar

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def like_even_wear(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(amplitudes[0] < 0.0)  # a narrower mate leaves both ends

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        cut = points.side * side_cut(points, context.gear, shape[0])
        return (-cut * (2.0 * helix_place(points, context.gear)) ** 2)[:, None]


EFFECT = HelixCrowning()

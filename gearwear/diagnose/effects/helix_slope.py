"""Helix slope: the flank runs out of lead by a straight line along the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.design.twist import hand_at
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, helix_place, side_cut
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class HelixSlope(CatalogueEffect):
    """δ = s f ζ: both flanks screwed the same way; f is the rise over the face width, + where left flanks gain metal upwards.

    Notes
    -----
    The part that is equal on both flanks is `taper`. ISO 1328-1 signs the helix slope by hand and flank; here the screw's own sign
    is used; on a double helical gear, each half of which has its ζ for itself, that of the half at z = 0, and the other half is its mirror
    image: both angles too large, or both too small. Fillets follow their flanks, or do not: both are tried.
    """

    name: ClassVar[str] = "helix_slope"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 1328-1:2013, helix slope deviation f_Hβ"
    tells_apart: ClassVar[str] = (
        "Scan from the top down instead of from the bottom up: a drift of the angle with height changes its sense, a screw of the flanks stays."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("slope_um"),)
    phrase: ClassVar[str] = "a helix slope of {slope_um}"

    def applies(self, context: Context) -> bool:
        return not context.planar

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        mirrored = hand_at(context.gear, points.position[:, 2])
        return (mirrored * side_cut(points, context.gear, shape[0]) * helix_place(points, context.gear))[:, None]


EFFECT = HelixSlope()

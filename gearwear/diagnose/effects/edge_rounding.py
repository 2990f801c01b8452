"""Edge rounding: the laser spot averages across an edge."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FLANK, TIP, SurfacePoints
from gearwear.design.twist import from_end, normal_lean, section_angle
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, length_bracket
from gearwear.diagnose.parameter import Parameter, Role

EDGE_ROUNDING = "edge_rounding"
"""The effect that rounds all edges."""


@dataclass(frozen=True)
class EdgeRounding(CatalogueEffect):
    """δ = −a q (1 − 2x/w)² within half a spot width w of the tip corners (q = 1) and the face edges (q > 1), x from the edge.

    Notes
    -----
    A spot of width w shows the mean height over it. Across an edge that turns by κ, seen along the bisector, heights fall as |x| tan(κ/2), and
    their mean lies (tan(κ/2) / w) (w/2 − |x|)² below: a parabola that ends w/2 from the edge, in proportion to sin(κ/2) along the
    normal. `amount_um` a is its depth at the tip corner, where cos κ is n · e_r of the flank; at the face edges (κ = 90°) it
    is q = sin 45° / sin(κ/2) times as deep. All edges round alike, on both sides; a tip relief is on flanks only and spares lands and
    face edges. The rims of the end faces round too, but their cells are too coarse to see it. Where the spot is
    narrower than a cell, depth and width are told together only: a narrow deep rounding reads wider and shallower.
    """

    name: ClassVar[str] = EDGE_ROUNDING
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "own definition: moving average over the spot; horizon effect: Sensors 2024, 24(8):2410"
    tells_apart: ClassVar[str] = (
        "Scan again with a finer spot or from nearer: rounding by the spot shrinks with it, a chamfer or a relief does not."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amount_um", signed=False),
        Parameter("width_mm", Role.PLACE, signed=False),
    )
    phrase: ClassVar[str] = "edges rounded by the laser spot ({amount_um} over {width_mm})"
    lower: ClassVar[float] = 0.0

    def shapes(self, context: Context) -> list[Shape]:
        m = context.gear.transverse_module
        return [(0.1 * m,), (0.2 * m,), (0.4 * m,)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return length_bracket(shape[0])

    def as_made(self, context: Context) -> bool:
        """Of bevelled edges: no chamfer is cut to a tenth of a millimetre, and the land beside one that is longer looks rounded."""
        spec = context.gear.spec
        return max(spec.tip_chamfer, spec.tip_rounding, spec.end_edge) > 0.0

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        along = np.full(len(points), np.inf)  # distance from the tip corner
        flank, tip = points.surface == FLANK, points.surface == TIP
        way = gear.orientation
        tip_square = (gear.tip_radius + way * context.tip_shift) ** 2 - gear.base_radius**2  # of the roll at the corner as it is
        along[flank] = way * (tip_square - points.roll[flank] ** 2) / (2.0 * gear.base_radius)
        angle = section_angle(gear, *points.position[tip].T) - points.tooth[tip] * gear.pitch_angle
        angle = np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
        # Square to the tip corner, which is a helix.
        square = normal_lean(gear, np.array(gear.tip_radius))[0]
        along[tip] = square * gear.tip_radius * (gear.tip_half_angle - np.abs(angle))
        near = _parabola(along, shape[0])
        if not context.planar:
            z = points.position[:, 2]
            across = np.where(points.surface <= TIP, from_end(gear, z), np.inf)
            corner = math.acos(gear.tip_roll / gear.flank_end_radius)
            near = np.maximum(near, math.sqrt(0.5) / math.sin(0.5 * corner) * _parabola(across, shape[0]))
        return -near[:, None]


def _parabola(distance: Floats, width: float) -> Floats:
    return np.asarray(np.maximum(1.0 - 2.0 * np.maximum(distance, 0.0) / width, 0.0) ** 2)


EFFECT = EdgeRounding()

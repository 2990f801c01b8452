"""Sliding wear: loss in proportion to the sliding, none at the pitch point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape, from_form_on, on_sides
from gearwear.diagnose.effects.worn_depth import WornDepth
from gearwear.diagnose.parameter import Parameter

SLIDING_WEAR = "sliding_wear"
"""What may stand in place of effects where the scan does not tell whether sides are worn throughout."""


@dataclass(frozen=True)
class SlidingWear(WornDepth):
    """δ = −d |K(L)| / |K(L_form)| on all flanks of one side, d ≥ 0; the side is the shape value (+1 left, −1 right; 0 both, each by an
    amount of its own).

    Notes
    -----
    K is the specific sliding: by Archard's law with single point observation the depth of one meshing is k w |K|, whatever the
    curvature. Without a mate the sliding is known but for a factor, |1 − L_pitch / L|, and that is all that is needed here.
    """

    name: ClassVar[str] = SLIDING_WEAR
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "Archard; Andersson; Flodin & Andersson, Wear 1997, 2000"
    tells_apart: ClassVar[str] = (
        "Scan the mate: sliding wear is deepest at its dedendum too and spares its pitch line, errors of making or measuring do not pair."
    )
    averaged: ClassVar[str] = "roll"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("depth_um", signed=False),)
    phrase: ClassVar[str] = "wear that grows with sliding, {depth_um} at the form circle"
    lower: ClassVar[float] = 0.0

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        form = context.gear.form_roll
        roll = from_form_on(points.roll, context.gear)
        share = np.abs(context.sliding(roll)) / abs(float(context.sliding(np.array([form]))[0]))
        return on_sides(points, -share, shape[0])


EFFECT = SlidingWear()

"""Thickness variation: every tooth is thicker or thinner than the mean of all by an amount of its own."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Shape, side_cut
from gearwear.diagnose.effects.each_tooth import EachTooth
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class ThicknessVariation(EachTooth):
    """Arc s_k at the reference circle, + thicker, mean 0 over the teeth that are there: each side of tooth k turns by s_k / (2 r), on flanks δ = ½ s_k cos α.

    Notes
    -----
    With `pitch` left and right flanks have index deviations of their own, F_k ± s_k / 2, as those of any gear cut in two settings, or ground. The mean
    is a `tooth_thickness`.
    """

    name: ClassVar[str] = "thickness_variation"
    source: ClassVar[str] = "DIN 3960:1987, tooth thickness variation R_s; ISO 1328-1:2013, pitch of left and of right flanks"
    tells_apart: ClassVar[str] = (
        "Measure the gear before it runs, or spans over every few teeth now: teeth that wore evenly are thin on the side that drove, at the fillets too if they were cut so."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("thickness_um"),)
    phrase: ClassVar[str] = "teeth thicker and thinner than their mean, tooth by tooth, by {thickness_um}"

    def like_even_wear(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return context.fillets_told and shape == (0.0,)  # the fillets do not follow

    def deviation(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        half = 0.5 * math.cos(context.gear.transverse_pressure_angle)
        return np.asarray(half * points.side * side_cut(points, context.gear, shape[0]))


EFFECT = ThicknessVariation()

"""Pitch: every tooth stands off its place by an amount of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Shape, side_cut
from gearwear.diagnose.effects.each_tooth import EachTooth
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class Pitch(EachTooth):
    """Index deviation F_k, arc at the reference circle, + counter-clockwise, mean 0 over the teeth that are there: tooth k turns by F_k / r.

    Notes
    -----
    Left and right flanks go together: δ = s F_k cos α; where they do not, the tooth is thicker or thinner than others (`thickness_variation`). The mean is
    the pose's.
    """

    name: ClassVar[str] = "pitch"
    source: ClassVar[str] = "ISO 1328-1:2013, individual and cumulative pitch (index) deviation"
    tells_apart: ClassVar[str] = (
        "Turn the part on the table by a few teeth and scan again: pitch errors stay with their teeth, errors of the table do not."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("index_um"),)
    phrase: ClassVar[str] = "pitch errors, tooth by tooth, of {index_um}"

    def teeth(self, context: Context) -> list[int]:
        bent = {one.tooth for one in context.bent}  # where these stand their bend says
        return [tooth for tooth in super().teeth(context) if tooth not in bent]

    def deviation(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        return np.asarray(gear.base_radius / gear.reference_radius * side_cut(points, gear, shape[0]))


EFFECT = Pitch()

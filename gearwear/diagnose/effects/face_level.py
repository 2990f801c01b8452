"""Face level: where flanks that are worn where their mate ran stand beside it, as they were made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, Shape
from gearwear.diagnose.effects.free_levels import FreeLevels
from gearwear.diagnose.parameter import Parameter

FACE_LEVEL = "face_level"
"""The effect that leaves these levels free."""


@dataclass(frozen=True)
class FaceLevel(FreeLevels):
    """δ = a level of its own on all flanks of each side of which some stretch wore and the rest did not, + higher; and where it did not wear at both ends,
    a lead and a crowning of its own.

    Notes
    -----
    What the flanks were made like where they are worn, the strips beside it tell: how high, how far they lean, and by how they bend how crowned. Left to
    effects that are named where they gain enough, one would stand for the other.
    """

    name: ClassVar[str] = FACE_LEVEL
    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "free level of the flanks that no mate touched; none is assumed"
    tells_apart: ClassVar[str] = "Measure over pins beside the worn stretch."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("level_um"),)
    phrase: ClassVar[str] = "flanks {level_um} high beside where the mate ran"
    phrase_below: ClassVar[str] = "flanks {level_um} low beside where the mate ran"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return bool(context.faces)

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        columns = list[Floats]()
        for face in context.faces:
            own = ((points.surface == FLANK) & (points.side == int(face.side))).astype(np.float64)
            columns.append(own)
            if face.at_both_ends(context.gear):
                up = 2.0 * points.position[:, 2] / context.gear.face_width - 1.0
                columns += [own * up, own * up**2]
        return np.column_stack(columns)


EFFECT = FaceLevel()

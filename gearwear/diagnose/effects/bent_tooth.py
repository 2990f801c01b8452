"""A bent tooth: both flanks of one tooth moved the same way round the gear, the farther the nearer to the tip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, profile_coordinate, side_cut
from gearwear.diagnose.parameter import Parameter, Role, Spread

BENT_TOOTH = "bent_tooth"
"""The effect that moves the flanks of one tooth."""


@dataclass(frozen=True)
class BentTooth(CatalogueEffect):
    """δ = s d on the flanks of one tooth, d the parabola through what they moved by at the tip, in the middle of the roll and at the form circle; each of
    these changes evenly along the face; + counter-clockwise.

    Notes
    -----
    An overload that bends a tooth for good moves its metal and takes none off: one flank lies low by what the other stands proud, and the tooth is as thick
    as it was. Where the load lay at one end, that end bent more. A tooth that turns about its root moves at the form circle too; what it was off its place
    before is in that, and it has no index of its own (`pitch`). Which teeth are asked `bent_teeth` finds; the amounts are fitted with all else.
    """

    name: ClassVar[str] = BENT_TOOTH
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = (
        "own definition: rigid displacement of the flanks of one tooth, of second order in the roll length, of first along the face"
    )
    tells_apart: ClassVar[str] = (
        "Measure over pins or a span at that tooth: metal that was lost makes it thinner, a bend does not."
    )
    tooth_specific: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("tip_um"),
        Parameter("middle_um"),
        Parameter("foot_um"),
        Parameter("tip_lean_um"),
        Parameter("middle_lean_um"),
        Parameter("foot_lean_um"),
        Parameter("number", Role.PLACE, signed=False, spread=Spread.NONE),
    )
    phrase: ClassVar[str] = "tooth {number} bent counter-clockwise, by {tip_um} at its tip"
    phrase_below: ClassVar[str] = "tooth {number} bent clockwise, by {tip_um} at its tip"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return bool(context.bent)

    def shapes(self, context: Context) -> list[Shape]:
        return [(bent.tooth + 1.0,) for bent in context.bent]  # counted from 1, as teeth are told

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        up = 0.5 * (1.0 + profile_coordinate(points, context.gear))
        own = np.where(points.tooth == round(shape[0]) - 1, side_cut(points, context.gear, 0.0), 0.0)
        even = own[:, None] * np.column_stack([up * (2.0 * up - 1.0), 4.0 * up * (1.0 - up), (1.0 - up) * (1.0 - 2.0 * up)])
        along = np.zeros(len(points)) if context.planar else points.position[:, 2] / context.gear.face_width - 0.5
        return np.hstack([even, along[:, None] * even])

    def first_look(self, points: SurfacePoints, context: Context) -> Floats:
        """What the teeth bent as a first look has it do to the deviation of points, mm, (n,): so much is no wear, nor torn."""
        found = (self.basis(points, context, (bent.tooth + 1.0,)) @ np.array([*bent.moved, *bent.lean]) for bent in context.bent)
        return np.asarray(sum(found, np.zeros(len(points))), dtype=np.float64)


EFFECT = BentTooth()

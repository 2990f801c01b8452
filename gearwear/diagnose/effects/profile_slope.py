"""Profile slope: the flank rises or falls in a straight line from root to tip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import (
    CatalogueEffect,
    Context,
    Kind,
    Shape,
    of_transverse,
    on_flank,
    on_side,
    profile_coordinate,
    side_cut,
)
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class ProfileSlope(CatalogueEffect):
    """δ = ½ f u on left and right flanks, each with its own f: the rise from form circle to tip, + more metal at the tip.

    Notes
    -----
    A pressure angle error of −f / (L_α tan α) is the same thing. Whether the fillets go with the lower end of the flanks depends on the tool: a
    rack of another pressure angle has its tips elsewhere, a grinding wheel leaves the fillets alone; both are tried. Slopes that alternate
    round the gear are eccentricity.
    """

    name: ClassVar[str] = "profile_slope"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 1328-1:2013, profile slope deviation f_Hα"
    tells_apart: ClassVar[str] = (
        "Measure the profile of four teeth on a gear tester, or scan a cylinder of known diameter: a scanner's scale shows on the cylinder too."
    )
    group: ClassVar[str] = "G2"
    by_worn: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("left_um"), Parameter("right_um"))
    phrase: ClassVar[str] = "a profile slope of {left_um} on left and {right_um} on right flanks"

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear, fillets = context.gear, on_side(points) & ~on_flank(points)
        u = of_transverse(0.5 * profile_coordinate(points, gear), gear)
        u = np.where(fillets, -0.5 * np.abs(side_cut(points, gear, shape[0])), u)
        # The fillets of a side that wore go with the flanks of the other one, made by the same tool as far as anybody knows.
        others = [side for side in Side if side not in context.worn]
        told_by = np.where(fillets, int(others[0]), points.side) if len(others) == 1 else points.side
        if not others:
            u = np.where(fillets, 0.0, u)
        return np.column_stack([np.where(told_by > 0, u, 0.0), np.where(told_by < 0, u, 0.0)])


EFFECT = ProfileSlope()

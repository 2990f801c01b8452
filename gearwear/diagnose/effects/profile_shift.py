"""Profile shift: the tool stood further out or in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FILLET, ROOT, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, on_flank, radial
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class ProfileShift(CatalogueEffect):
    """The rack is displaced by x radially, + outward: δ = x sin α_n on flanks, x cos φ on fillets, x on roots, nothing on tips.

    Notes
    -----
    φ is the angle between the fillet's normal and the radius through the pitch point when it is cut: 0 at the bottom of the root, π/2 − α
    where the rack's tip arc meets its straight flank, in the rack's normal section. Tips are turned before cutting and stay. Flank : root goes as 0.34 : 1,
    against 1 : 1 for a coat.
    """

    name: ClassVar[str] = "profile_shift"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 21771:2007, profile shift; envelope of the displaced rack"
    tells_apart: ClassVar[str] = (
        "Measure the root diameter: a shift moves it, a thicker tooth does not, a coat moves the tips as well."
    )
    group: ClassVar[str] = "G1"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("shift_um"),)
    phrase: ClassVar[str] = "a profile shift {shift_um} above the drawn one"
    phrase_below: ClassVar[str] = "a profile shift {shift_um} below the drawn one"

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return abs(float(amplitudes[0])) < 0.5 * context.gear.transverse_module

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        result = np.zeros((len(points), 1))
        result[on_flank(points)] = math.sin(gear.normal_pressure_angle)
        result[points.surface == ROOT] = 1.0
        fillet = points.surface == FILLET
        if gear.spec.internal:  # by a cutter that is moved out: on the land 1, at the flank nearly as on the flank
            result[fillet, 0] = np.abs(radial(points))[fillet]
            return result
        x, y = points.position[fillet, 0], points.position[fillet, 1]
        result[fillet, 0] = np.cos(gear.fillet_phi(np.hypot(x, y)))
        return result


EFFECT = ProfileShift()

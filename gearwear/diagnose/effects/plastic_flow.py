"""Plastic flow: metal rolled away from the pitch line of the driver, towards that of the driven gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, length_bracket, on_flank
from gearwear.diagnose.parameter import Parameter, Role


@dataclass(frozen=True)
class PlasticFlow(CatalogueEffect):
    """δ = h exp(−½ (L − L_p)² / l²) on all flanks of one side: − a groove (driver), + a ridge (driven gear).

    Notes
    -----
    L_p is at the reference circle. Metal is moved, not lost: what the groove lacks stands at the tip as a burr, and a ridge is not wear. So
    the search never tries it; a fit that asks for it by name may.
    """

    name: ClassVar[str] = "plastic_flow"
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "own definition; plastic deformation by rolling: ISO 10825:1995, 3.2.1"
    tells_apart: ClassVar[str] = (
        "Scan the mate: a groove at the pitch line of the driver goes with a ridge on the driven gear, crowning errors do not pair."
    )
    searched: ClassVar[bool] = False
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("height_um"), Parameter("width_mm", Role.PLACE, signed=False))
    phrase: ClassVar[str] = "metal pushed along the flank by {height_um}"

    def shapes(self, context: Context) -> list[Shape]:
        return [(share * context.gear.transverse_module, side) for side in (1.0, -1.0) for share in (0.1, 0.2, 0.4)]

    def bracket(self, shape: Shape, context: Context) -> list[tuple[float, float]]:
        return length_bracket(shape[0])

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        x = (np.nan_to_num(points.roll) - context.gear.reference_roll) / shape[0]
        return np.where(on_flank(points) & (points.side == shape[1]), np.exp(-0.5 * x * x), 0.0)[:, None]


EFFECT = PlasticFlow()

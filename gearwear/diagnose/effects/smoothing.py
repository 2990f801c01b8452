"""Smoothing: each point was moved to the mean of its neighbours, which sinks what is round and fills what is hollow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import BORE, FLANK, ROOT, TIP, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter

LEAST_RADIUS = 0.25
"""Modules of radius of curvature below which a flank's mean is not followed: neighbours reach past its end there."""
WIDEST = 0.3
"""Modules of the radius a mean is taken over, at most: one that is wider leaves no fillets and no edges."""


@dataclass(frozen=True)
class Smoothing(CatalogueEffect):
    """δ = −s ρ₀ κ: by s where the flank crosses the reference circle, and in proportion to curvature κ elsewhere; + where a surface is hollow.

    Notes
    -----
    Over a disc of radius a about a point the surface lies κ x² / 2 below its tangent plane, on the mean a² κ / 8: a
    mean over neighbours puts the point there. An involute's radius of curvature is its length of roll L, and that of the helicoid across its
    straight lines L / cos β_b, so that a flank sinks in proportion to 1 / L and most at its root; where s at radius ρ₀ is known,
    a = √(8 s ρ₀). Ends are plane. Fillets are left out: their form is fitted to the scan as it is. What the mean does at edges is
    `edge_rounding`. Sought only where neighbouring points share their errors.
    """

    name: ClassVar[str] = "smoothing"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "own definition: mean of a curved surface over a disc, a² κ / 8"
    tells_apart: ClassVar[str] = (
        "Export the scan again without smoothing, or with less: what it sinks goes with the number of neighbours."
    )
    group: ClassVar[str] = "G7"
    usual: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("sag_um", signed=False),)
    phrase: ClassVar[str] = "smoothing of the scan, which sinks round surfaces (flanks by {sag_um} at the reference circle)"
    lower: ClassVar[float] = 0.0

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        gear = context.gear
        most = (WIDEST * gear.transverse_module) ** 2 / (8.0 * gear.reference_roll)
        return super().allowed(amplitudes, shape, context) and bool(np.all(amplitudes <= most))

    def applies(self, context: Context) -> bool:
        return context.smoothed

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        least = LEAST_RADIUS * gear.transverse_module
        radius = np.full(len(points), np.inf)  # times cos β_b, as lengths of roll are
        flank = points.surface == FLANK
        radius[flank] = gear.orientation * np.maximum(points.roll[flank], least)
        for code, way in ((TIP, gear.orientation), (ROOT, gear.orientation), (BORE, -gear.orientation)):
            on = points.surface == code
            radius[on] = way * np.hypot(*points.position[on, :2].T) * gear.base_helix_cosine
        return np.asarray(-gear.reference_roll / radius)[:, None]


EFFECT = Smoothing()

"""Sliding wear: loss in proportion to the sliding, none at the pitch point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, on_flank


@dataclass(frozen=True)
class SlidingWear:
    """δ = −d |K(L)| / |K(L_form)| on all flanks of one side, with K the specific sliding (Archard, single point observation).

    Notes
    -----
    Without a mate the sliding is taken as linear in L from the pitch point: |L − L_pitch|.
    """

    name: ClassVar[str] = "sliding_wear"
    kind: ClassVar[Kind] = Kind.WEAR
    source: ClassVar[str] = "Andersson; Flodin & Andersson, Wear 1997, 2000; reference D3"
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = ("depth_um",)

    def applies(self, context: Context) -> bool:
        return True

    def shapes(self, context: Context) -> list[Shape]:
        return [(1.0,), (-1.0,)]  # all left flanks, all right flanks

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return amplitudes[0] >= 0.0

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        return {"depth_um": Estimate(1e3 * float(amplitudes[0]), 1e3 * math.sqrt(max(float(covariance[0, 0]), 0.0)), "um")}

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        roll = np.maximum(np.nan_to_num(points.roll), gear.form_roll)
        share = np.abs(context.sliding(roll)) / abs(float(context.sliding(np.array([gear.form_roll]))[0]))
        return np.where(on_flank(points) & (points.side == shape[0]), -share, 0.0)[:, None]


EFFECT = SlidingWear()

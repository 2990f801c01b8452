"""Pitch: every tooth stands off its place by an amount of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Estimate, Kind, Shape, on_flank, on_side, turning


@dataclass(frozen=True)
class Pitch:
    """Index deviation F_k, arc at the reference circle, + counter-clockwise, mean 0: tooth k turns by F_k / r.

    Notes
    -----
    Left and right flanks go together: δ = s F_k cos α. The mean is the pose's. A left-out tooth cannot be predicted, so it is judged on
    left-out blocks along z.
    """

    name: ClassVar[str] = "pitch"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 1328-1:2013, individual and cumulative pitch"
    group: ClassVar[str] = ""
    tooth_specific: ClassVar[bool] = True
    parameters: ClassVar[tuple[str, ...]] = ("index_um",)

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]  # the tool that made the flank made the fillet too, or it did not (ground flanks)

    def applies(self, context: Context) -> bool:
        return True

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(np.all(np.abs(amplitudes) < 0.5))

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, Estimate]:
        spread = np.vstack([np.eye(len(amplitudes)), -np.ones(len(amplitudes))])
        index = spread @ amplitudes
        std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", spread, covariance, spread), 0.0))
        return {"index_um": Estimate(tuple((1e3 * index).tolist()), tuple((1e3 * std).tolist()), "um")}

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        moved = on_side(points) if shape[0] else on_flank(points)
        turn = np.where(moved, turning(points) / context.gear.reference_radius, 0.0)
        own = np.zeros((len(points), context.gear.teeth))
        own[np.arange(len(points)), points.tooth] = turn
        return own[:, :-1] - own[:, -1:]


EFFECT = Pitch()

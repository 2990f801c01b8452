"""Pitch: every tooth stands off its place by an amount of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, side_cut
from gearwear.diagnose.parameter import Parameter, ParameterEstimate


@dataclass(frozen=True)
class Pitch(CatalogueEffect):
    """Index deviation F_k, arc at the reference circle, + counter-clockwise, mean 0 over the teeth that are there: tooth k turns by F_k / r.

    Notes
    -----
    Left and right flanks go together: δ = s F_k cos α. The mean is the pose's, so the last tooth's is minus the sum of the others'. A
    tooth that is missing has none. A left-out tooth cannot be predicted: the effect is judged on left-out blocks along z. Fillets follow their flanks, or do not.
    """

    name: ClassVar[str] = "pitch"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "ISO 1328-1:2013, individual and cumulative pitch (index) deviation"
    tells_apart: ClassVar[str] = (
        "Turn the part on the table by a few teeth and scan again: pitch errors stay with their teeth, errors of the table do not."
    )
    tooth_specific: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("index_um"),)
    phrase: ClassVar[str] = "pitch errors, tooth by tooth, of {index_um}"

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(np.all(np.abs(amplitudes) < 0.5) and abs(amplitudes.sum()) < 0.5)

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        # Tooth by tooth, so that one whose amplitude is unknown (nan) leaves the others known.
        value, std = np.full((2, context.gear.teeth), np.nan)
        present = _present(context)
        value[present] = [*amplitudes, -amplitudes.sum()]
        std[present] = np.sqrt(np.maximum([*np.diag(covariance), covariance.sum()], 0.0))
        (index,) = self.parameters
        return {index.name: index.estimates(value, std)}

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        own = np.zeros((len(points), gear.teeth))
        arc = gear.base_radius / gear.reference_radius
        own[np.arange(len(points)), points.tooth] = arc * side_cut(points, gear, shape[0])
        *others, last = _present(context)
        return own[:, others] - own[:, [last]]


def _present(context: Context) -> list[int]:
    """Teeth that have a place: two of them at least, or all."""
    present = [tooth for tooth in range(context.gear.teeth) if tooth not in context.absent]
    return present if len(present) > 1 else list(range(context.gear.teeth))


EFFECT = Pitch()

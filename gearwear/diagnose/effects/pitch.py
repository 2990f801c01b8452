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
    """Index deviation F_k, arc at the reference circle, + counter-clockwise, mean 0: tooth k turns by F_k / r.

    Notes
    -----
    Left and right flanks go together: δ = s F_k cos α. The mean is the pose's, so the last tooth's is minus the sum of the others'. A
    left-out tooth cannot be predicted: the effect is judged on left-out blocks along z. Fillets follow their flanks, or do not.
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
        return bool(np.all(np.abs(self._index(amplitudes)) < 0.5))

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        # Tooth by tooth, so that one whose amplitude is unknown (nan) leaves the others known.
        std = np.sqrt(np.maximum([*np.diag(covariance), covariance.sum()], 0.0))
        (index,) = self.parameters
        return {index.name: index.estimates(self._index(amplitudes), std)}

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        gear = context.gear
        own = np.zeros((len(points), gear.teeth))
        arc = gear.base_radius / gear.reference_radius
        own[np.arange(len(points)), points.tooth] = arc * side_cut(points, gear, shape[0])
        return own[:, :-1] - own[:, -1:]

    @staticmethod
    def _index(amplitudes: Floats) -> Floats:
        """The last tooth's beside the others'."""
        return np.concatenate([amplitudes, -amplitudes.sum(axis=0, keepdims=True)])


EFFECT = Pitch()

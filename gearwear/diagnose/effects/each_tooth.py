"""Effects of which every tooth has an amount of its own, mean 0 over the teeth that are there: what the last has is minus the sum of the others'."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import ParameterEstimate

MOST = 0.5
"""mm; the largest amount of a tooth."""


class EachTooth(CatalogueEffect):
    """An amount of each tooth. A tooth that is missing has none. A left-out tooth cannot be predicted: the effect is judged on left-out blocks along z.

    Fillets follow their flanks, or do not.
    """

    kind: ClassVar[Kind] = Kind.MANUFACTURE
    tooth_specific: ClassVar[bool] = True

    def teeth(self, context: Context) -> list[int]:
        """Teeth that have an amount: two of them at least, or all."""
        present = [tooth for tooth in range(context.gear.teeth) if tooth not in context.absent]
        return present if len(present) > 1 else list(range(context.gear.teeth))

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,)]

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool(np.all(np.abs(amplitudes) < MOST) and abs(amplitudes.sum()) < MOST)

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        # Tooth by tooth, so that one whose amplitude is unknown (nan) leaves the others known.
        value, std = np.full((2, context.gear.teeth), np.nan)
        present = self.teeth(context)
        value[present] = [*amplitudes, -amplitudes.sum()]
        std[present] = np.sqrt(np.maximum([*np.diag(covariance), covariance.sum()], 0.0))
        (amount,) = self.parameters
        return {amount.name: amount.estimates(value, std)}

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        own = np.zeros((len(points), context.gear.teeth))
        own[np.arange(len(points)), points.tooth] = self.deviation(points, context, shape)
        *others, last = self.teeth(context)
        return own[:, others] - own[:, [last]]

    def amounts(self, amplitudes: Floats, context: Context) -> Floats:
        """Of each tooth, (teeth,), from the amplitudes; 0 of one that has none."""
        result = np.zeros(context.gear.teeth)
        result[self.teeth(context)] = [*amplitudes, -amplitudes.sum()]
        return result

    def deviation(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        """Of points (n,) for an amount of 1 on their tooth."""
        raise NotImplementedError

"""Effects that leave surfaces as they are: levels that no drawing tells."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Shape
from gearwear.diagnose.parameter import ParameterEstimate


class FreeLevels(CatalogueEffect):
    """Any number of levels, mm: each is told with its own deviation."""

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        std = np.sqrt(np.maximum(np.diag(covariance)[: len(amplitudes)], 0.0))
        (level,) = self.parameters
        return {level.name: level.estimates(amplitudes, std)}

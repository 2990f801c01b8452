"""Root form: fillets and bottom lands as they are, alike on all teeth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import FILLET, ROOT, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter, ParameterEstimate


@dataclass(frozen=True)
class RootForm(CatalogueEffect):
    """δ = a level of its own in every column of the fillets, both sides alike, and on bottom lands: + is metal left standing.

    Notes
    -----
    Drawings seldom tell how a root was cut. What is the same in all spaces is the tool's and no evidence; what differs from tooth to tooth,
    along z or between left and right still is.
    """

    name: ClassVar[str] = "root_form"
    kind: ClassVar[Kind] = Kind.FORM
    source: ClassVar[str] = "free profile that the spaces share; none is assumed"
    tells_apart: ClassVar[str] = "State the tool: its tip radius, protuberance and the grinding stock."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("level_um"),)
    phrase: ClassVar[str] = "roots of a form of their own, {level_um} off the drawn one"
    lower: ClassVar[float] = -2.0
    upper: ClassVar[float] = 2.0

    def applies(self, context: Context) -> bool:
        return bool(context.fillet_edges) and bool(context.surfaces & {FILLET, ROOT})

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        edges = np.asarray(context.fillet_edges)
        count = len(edges) - 1
        column = np.searchsorted(edges, np.hypot(points.position[:, 0], points.position[:, 1]), side="right") - 1
        column = np.where(points.surface == FILLET, np.clip(column, 0, count - 1), np.where(points.surface == ROOT, count, -1))
        told = [*range(count)] * (FILLET in context.surfaces) + [count] * (ROOT in context.surfaces)
        return np.asarray(column[:, None] == np.array(told), dtype=np.float64)

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        std = np.sqrt(np.maximum(np.diag(covariance)[: len(amplitudes)], 0.0))
        (level,) = self.parameters
        return {level.name: level.estimates(amplitudes, std)}


EFFECT = RootForm()

"""Scale along the axis: a z drive or a step that is too long."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import END_HIGH, END_LOW, SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class HeightScale(CatalogueEffect):
    """z measured = (1 + e) z: δ = e z n_z, seen by end faces, and by helical flanks as a helix slope; + is a face width that reads too large.

    Notes
    -----
    On flanks it is −s sin β_b e z: without end faces nothing tells it from a helix slope of −sin β_b e b along the normal.
    """

    name: ClassVar[str] = "height_scale"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "displacement e z along the axis dotted with the normal"
    tells_apart: ClassVar[str] = "Measure the face width with a micrometer: a face off its drawing looks the same in the scan."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("relative_ppm"),)
    phrase: ClassVar[str] = "heights that read {relative_ppm} too large"
    phrase_below: ClassVar[str] = "heights that read {relative_ppm} too small"

    def applies(self, context: Context) -> bool:
        return not context.planar and (context.gear.twist != 0.0 or context.surfaces >= {END_LOW, END_HIGH})

    def allowed(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return abs(float(amplitudes[0])) <= context.scale_limit

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((points.position[:, 2] * points.normal[:, 2])[:, None])

    def displacement(self, position: Floats, amplitudes: Floats, shape: Shape) -> Floats | None:
        return np.asarray(amplitudes[0] * position * np.array([0.0, 0.0, 1.0]))


EFFECT = HeightScale()

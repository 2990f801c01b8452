"""Lens distortion along the laser line: the range bends towards the ends of the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import Context, Kind, LinearEffect, Shape, face_coordinate, radial


@dataclass(frozen=True)
class LensDistortion(LinearEffect):
    """δ = c (2ζ)² (n · e_r): radial, nothing at mid-face, c at the two ends.

    Notes
    -----
    Of the polynomial in image coordinates (v, z) only c z² is in sight of a radial beam. Helix crowning looks alike on
    flanks and leaves tips and roots straight; rotate the part by 180° about x and scan again.
    """

    name: ClassVar[str] = "lens_distortion"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "reference E: lens distortion"
    group: ClassVar[str] = "G7"
    parameters: ClassVar[tuple[str, ...]] = ("bow_um",)
    lower: ClassVar[float] = -0.5
    upper: ClassVar[float] = 0.5

    def applies(self, context: Context) -> bool:
        return not context.planar

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((radial(points) * (2.0 * face_coordinate(points, context.gear)) ** 2)[:, None])


EFFECT = LensDistortion()

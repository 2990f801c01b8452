"""Lens distortion along the laser line: the range bends towards the ends of the face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, face_coordinate, radial
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class LensDistortion(CatalogueEffect):
    """Every radius grows by c (2ζ)²: δ = c (2ζ)² (n · e_r), nothing at mid-face, c at the two ends on tips and roots.

    Notes
    -----
    A straight laser line, parallel to the axis, is seen bent by a lens whose distortion is not taken out. Of the image polynomial this is
    the first term that a straight calibration (offset and scale) leaves along the line, for a radial beam and an image centre at
    mid-face; an image centre elsewhere adds a radial offset and a cone. Terms in the range itself (c v³) are not in it: over the
    depth of a tooth an offset and a scale take all but a small part of them.
    """

    name: ClassVar[str] = "lens_distortion"
    kind: ClassVar[Kind] = Kind.MEASUREMENT
    source: ClassVar[str] = "own definition: second-order term of the image polynomial along the laser line"
    tells_apart: ClassVar[str] = (
        "Shift the part along the laser line by a third of its face and scan again: the bow stays with the line, crowning goes with the part."
    )
    group: ClassVar[str] = "G7"
    averaged: ClassVar[str] = "z"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("bow_um"),)
    phrase: ClassVar[str] = "lens distortion that bows the scan by {bow_um}"

    def applies(self, context: Context) -> bool:
        return context.turntable and not context.planar

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return np.asarray((radial(points) * (2.0 * face_coordinate(points, context.gear)) ** 2)[:, None])


EFFECT = LensDistortion()

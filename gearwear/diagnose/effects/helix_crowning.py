"""Helix crowning: the flank bulges at mid-face."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, deviations, helix_place, side_cut
from gearwear.diagnose.parameter import Parameter, ParameterEstimate

OF_SIDES = 2.0
"""Last of a shape where left and right flanks have a crowning of their own."""


@dataclass(frozen=True)
class HelixCrowning(CatalogueEffect):
    """δ = −c (2ζ)²: nothing at mid-face, −c at the two ends; + is a bulge. Fillets follow their flanks, or do not.

    Notes
    -----
    All flanks have one c, or left and right flanks one of their own, as each side was cut; then their mean is told too. What a side worn throughout was
    crowned by no flank of it tells: as the other is. On a double helical gear each half is crowned by itself.
    """

    name: ClassVar[str] = "helix_crowning"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; second order analysis: ISO 1328-1:2013, annex B"
    tells_apart: ClassVar[str] = (
        "Shift the part along the laser line and scan again: a bow of the scanner stays with the line, crowning goes with the part."
    )
    group: ClassVar[str] = "G7"
    averaged: ClassVar[str] = "z"
    by_worn: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("crowning_um"), Parameter("left_um"), Parameter("right_um"))
    phrase: ClassVar[str] = "flanks crowned lengthwise by {crowning_um}"
    phrase_below: ClassVar[str] = "flanks hollow lengthwise by {crowning_um}"
    phrase_of_sides: ClassVar[str] = "flanks crowned lengthwise by {left_um} on the left and {right_um} on the right"

    def applies(self, context: Context) -> bool:
        return not context.planar

    def shapes(self, context: Context) -> list[Shape]:
        return [(0.0,), (1.0,), (0.0, OF_SIDES), (1.0, OF_SIDES)]

    def like_even_wear(self, amplitudes: Floats, shape: Shape, context: Context) -> bool:
        return bool((amplitudes < 0.0).any())  # a narrower mate leaves both ends

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        cut = points.side * side_cut(points, context.gear, shape[0])
        bulge = -cut * (2.0 * helix_place(points, context.gear)) ** 2
        if OF_SIDES not in shape:
            return bulge[:, None]
        sound = [int(side) for side in Side if side not in context.worn]
        told_by = np.full(len(bulge), sound[0]) if len(sound) == 1 else points.side
        return np.column_stack([np.where(told_by == int(side), bulge, 0.0) for side in Side])

    def estimates(self, amplitudes: Floats, covariance: Floats, shape: Shape, context: Context) -> dict[str, ParameterEstimate]:
        mean, *of_sides = self.parameters
        if OF_SIDES not in shape:
            return {mean.name: mean.estimate(float(amplitudes[0]), deviations(covariance, 1)[0])}
        variance = 0.25 * float(covariance[:2, :2].sum())
        each = zip(of_sides, amplitudes.tolist(), deviations(covariance, 2), strict=True)
        told = {mean.name: mean.estimate(float(amplitudes.mean()), math.sqrt(max(variance, 0.0)))}
        return told | {one.name: one.estimate(value, std) for one, value, std in each}


EFFECT = HelixCrowning()

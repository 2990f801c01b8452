"""Profile crowning: the flank bulges between root and tip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import CatalogueEffect, Context, Kind, Shape, of_transverse, profile_coordinate
from gearwear.diagnose.parameter import Parameter


@dataclass(frozen=True)
class ProfileCrowning(CatalogueEffect):
    """δ = −c u²: nothing at the middle of the profile, −c at form circle and tip; + is a bulge."""

    name: ClassVar[str] = "profile_crowning"
    kind: ClassVar[Kind] = Kind.MANUFACTURE
    source: ClassVar[str] = "own definition; second order analysis: ISO 1328-1:2013, annex B"
    tells_apart: ClassVar[str] = (
        "Scan from another direction or measure the profile on a gear tester: a bias of the scanner changes with its view, crowning does not."
    )
    group: ClassVar[str] = "G7"
    averaged: ClassVar[str] = "roll"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("crowning_um"),)
    phrase: ClassVar[str] = "profiles crowned by {crowning_um}"
    phrase_below: ClassVar[str] = "profiles hollow by {crowning_um}"

    def basis(self, points: SurfacePoints, context: Context, shape: Shape) -> Floats:
        return -of_transverse(profile_coordinate(points, context.gear) ** 2, context.gear)[:, None]


EFFECT = ProfileCrowning()

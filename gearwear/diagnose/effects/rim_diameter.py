"""Rim diameter: the outside of a ring is wider or narrower than drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.effects.bore_diameter import BodyDiameter


@dataclass(frozen=True)
class RimDiameter(BodyDiameter):
    """δ = ½ d on the outside of a ring only; d the difference in diameter, + wider."""

    name: ClassVar[str] = "rim_diameter"
    tells_apart: ClassVar[str] = "Measure the outside of the ring with a micrometer."
    phrase: ClassVar[str] = "an outside {diameter_um} wider than drawn"
    phrase_below: ClassVar[str] = "an outside {diameter_um} narrower than drawn"

    def applies(self, context: Context) -> bool:
        return context.gear.orientation < 0 and super().applies(context)


EFFECT = RimDiameter()

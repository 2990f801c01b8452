"""A shaft that is bent, or a gear askew on it: a misalignment that turns with the gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter, angular
from gearwear.running.effects.base import RoundEffect


@dataclass(frozen=True)
class BentShaft(RoundEffect):
    """First order of how far wear leans across the face; the direction is where it is deepest at z = b."""

    name: ClassVar[str] = "bent_shaft"
    phrase: ClassVar[str] = (
        "the lean of the wear across the face rises and falls by {amplitude_um} once round the gear, as with a bent shaft or a gear askew on it"
    )
    alternatives: ClassVar[tuple[str, ...]] = ("wobble",)
    tells_apart: ClassVar[str] = "The runout of both end faces of this gear on its own bearings."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amplitude_um", signed=False), angular("direction_deg"))
    leans: ClassVar[bool] = True


EFFECT = BentShaft()

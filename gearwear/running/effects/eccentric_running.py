"""A gear that ran out of centre: wear that rises and falls once round the gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter, angular
from gearwear.running.effects.base import RoundEffect


@dataclass(frozen=True)
class EccentricRunning(RoundEffect):
    """First order of the mean depth of the teeth; the direction is where wear is deepest."""

    name: ClassVar[str] = "eccentric_running"
    phrase: ClassVar[str] = "wear rises and falls by {amplitude_um} once round the gear, as on one that ran out of centre"
    alternatives: ClassVar[tuple[str, ...]] = ("pitch", "eccentricity")
    tells_apart: ClassVar[str] = "The runout of this gear on its own bearings."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amplitude_um", signed=False), angular("direction_deg"))


EFFECT = EccentricRunning()

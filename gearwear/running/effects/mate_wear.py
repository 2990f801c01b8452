"""A mate that wears too: what it loses lets the ends of the path of this gear carry on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter
from gearwear.running.conditions import Conditions
from gearwear.running.effects.base import RunEffect


@dataclass(frozen=True)
class MateWear(RunEffect):
    """The mate's wear coefficient over that of this gear; without the effect the mate is hard."""

    name: ClassVar[str] = "mate_wear"
    phrase: ClassVar[str] = "the mate wore too, its wear coefficient {rate} times this gear's"
    alternatives: ClassVar[tuple[str, ...]] = ()
    tells_apart: ClassVar[str] = "A scan of the mate."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("rate", signed=False),)
    step: ClassVar[float] = 0.5
    most: ClassVar[float] = 3.0
    doubt: ClassVar[float] = 0.7

    def applied(self, conditions: Conditions, size: float) -> Conditions:
        # The gap that is searched for is larger by what the mate takes of it, so that the two sizes can be searched for apart.
        shown = (conditions.misalignment - conditions.stated) / (1.0 + conditions.mate_rate)
        return replace(conditions, mate_rate=size, misalignment=conditions.stated + shown * (1.0 + size))

    def reported(self, conditions: Conditions) -> float:
        return conditions.mate_rate


EFFECT = MateWear()

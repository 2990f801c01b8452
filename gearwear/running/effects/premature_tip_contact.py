"""Premature tip contact: the mate's tips come in before their turn, take load and wear the lower end of this gear's flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter
from gearwear.running.conditions import Conditions
from gearwear.running.effects.base import RunEffect


@dataclass(frozen=True)
class PrematureTipContact(RunEffect):
    """How far a tip of the mate is ahead of the pair that carries already: the mate's base pitch less this gear's.

    Notes
    -----
    That teeth under load bend, so that the next tip comes in early, is in every run and not counted here. A relief is the other way round: it spares
    the lower end. A mate that wears too loses what it is ahead, and gives the lower end more load only as it wears itself.
    """

    name: ClassVar[str] = "premature_tip_contact"
    phrase: ClassVar[str] = "the mate's tips came in {amount_um} early, before the load had bent the teeth"
    alternatives: ClassVar[tuple[str, ...]] = ("profile_slope",)
    tells_apart: ClassVar[str] = "The base pitches of both gears, or their profile slopes from inspection."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amount_um", signed=False),)
    step: ClassVar[float] = 0.01
    most: ClassVar[float] = 0.06

    def applied(self, conditions: Conditions, size: float) -> Conditions:
        return replace(conditions, mate_ahead=size)

    def reported(self, conditions: Conditions) -> float:
        return conditions.mate_ahead


EFFECT = PrematureTipContact()

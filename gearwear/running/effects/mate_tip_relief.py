"""A relief at the tip of the mate that its drawing does not tell: it spares the lower end of this gear's flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter
from gearwear.errors import InputError
from gearwear.running.conditions import Conditions, Runs, relief_length
from gearwear.running.effects.base import RunEffect


@dataclass(frozen=True)
class MateTipRelief(RunEffect):
    """A long relief, linear from the highest point of single contact to the tip; missing at the tip."""

    name: ClassVar[str] = "mate_tip_relief"
    phrase: ClassVar[str] = "the mate has a tip relief of {amount_um}"
    alternatives: ClassVar[tuple[str, ...]] = ("root_relief",)
    tells_apart: ClassVar[str] = "A scan of the mate, or its drawing."
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("amount_um", signed=False),)
    step: ClassVar[float] = 0.01
    most: ClassVar[float] = 0.06

    def applies(self, runs: Runs) -> bool:
        try:
            relief_length(runs.mate, runs.map.gear, runs.centre_distance)
        except InputError:
            return False
        return runs.mate.spec.left.tip_relief == runs.mate.spec.right.tip_relief == 0.0

    def applied(self, conditions: Conditions, size: float) -> Conditions:
        return replace(conditions, mate_relief=size)

    def reported(self, conditions: Conditions) -> float:
        return conditions.mate_relief


EFFECT = MateTipRelief()

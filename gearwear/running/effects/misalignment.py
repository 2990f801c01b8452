"""Misalignment in mesh: flanks that stand askew to each other carry at one end of the face."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from gearwear.diagnose.parameter import Parameter
from gearwear.running.conditions import Conditions
from gearwear.running.effects.base import RunEffect


@dataclass(frozen=True)
class Misalignment(RunEffect):
    """A gap f (z / b − ½) in the plane of action before the load closes it; + opens towards z = b on the worn flanks.

    Its size is what there is beside the gap that the design states; reported is the whole.

    Notes
    -----
    The worn flanks tell how far they stood askew to their mates, never why: a bent shaft, a housing bored askew and a helix slope of either gear as
    made leave the same wear.
    """

    name: ClassVar[str] = "misalignment"
    phrase: ClassVar[str] = "the pair ran misaligned by {gap_um} over the face"
    alternatives: ClassVar[tuple[str, ...]] = ("helix_slope",)
    tells_apart: ClassVar[str] = (
        "A scan before wear shows this gear's own helix slope, and so do its coast flanks if both sides were finished in one setting; the mate's needs the mate."
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("gap_um"),)
    step: ClassVar[float] = 0.015
    least: ClassVar[float] = -0.3
    most: ClassVar[float] = 0.3

    def starts(self, usual: Conditions) -> tuple[int, ...]:
        # From flanks that carry at the wrong end, no step makes it better: the likeliest is no wear at all.
        return tuple({0, round(-usual.stated / self.step)})

    def applied(self, conditions: Conditions, size: float) -> Conditions:
        # What this gear's flanks wear off is what shows; a mate that wears takes its part of the gap.
        return replace(conditions, misalignment=conditions.stated + size * (1.0 + conditions.mate_rate))

    def reported(self, conditions: Conditions) -> float:
        return conditions.misalignment


EFFECT = Misalignment()

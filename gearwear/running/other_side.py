"""What the other side of the teeth says of how a pair ran."""

from __future__ import annotations

import math

from gearwear.running.effects import running_effects
from gearwear.running.effects.base import OtherSideEffect
from gearwear.running.found import Errors, FoundRunning
from gearwear.wear_law.fit import WearFit
from gearwear.wear_law.study import LEAST_EXPLAINED

SURE_STDS = 3.0
"""Standard deviations from which on sliding of the other side is a finding."""
LEAST_SHARE = 0.05
"""Least sliding there, as a share of that of the side that wore more."""


def on_the_other_side(worn: WearFit, other: WearFit | None) -> tuple[FoundRunning, ...]:
    """Effects that the other side shows: none, or the one of the catalogue.

    Parameters
    ----------
    worn : WearFit
        The law on the side that wore more.
    other : WearFit or None
        The law on the other one; None where it could not be fitted, as on flanks that are not worn.

    Returns
    -------
    tuple of FoundRunning

    Notes
    -----
    Judged where one pair carries alone: there depth is A |K| + B whatever the load sharing was, and A > 0 is sliding under load, which an even loss B
    does not have. The law must explain half of that side's wear as well.
    """
    if other is None:
        return ()
    more, less = worn.single_contact, other.single_contact
    known = all(map(math.isfinite, (more.sliding, less.sliding))) and more.sliding > 0.0 and less.sliding_std > 0.0
    if not known or not less.sliding > SURE_STDS * less.sliding_std or not other.explained[0] >= LEAST_EXPLAINED:
        return ()
    share = less.sliding / more.sliding
    if share < LEAST_SHARE:
        return ()
    std = share * math.hypot(less.sliding_std / less.sliding, more.sliding_std / more.sliding)
    gain = (less.sliding / less.sliding_std) ** 2
    whole = math.sqrt(float((other.depth**2).mean()))
    before, after = (
        Errors(all=rms, teeth=math.nan, face=math.nan, double_contact=math.nan) for rms in (whole, other.unexplained_depth)
    )
    return tuple(
        FoundRunning(
            effect=effect, parameters={parameter.name: parameter.estimate(share, std) for parameter in effect.parameters},
            alternatives=effect.alternatives, before=before, after=after, gain=gain, degrees=(1, math.inf),
            p_value=math.erfc(math.sqrt(0.5 * gain)),
        )
        for effect in running_effects()
        if isinstance(effect, OtherSideEffect)
    )  # fmt: skip

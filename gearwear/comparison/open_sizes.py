"""Within what limits the sizes of effects lie where the scan does not decide which sides are worn throughout: with other sides they are others."""

from __future__ import annotations

from collections.abc import Mapping

from gearwear.design.quantity import NORMAL_95
from gearwear.diagnose.found import FoundEffect, Loop
from gearwear.diagnose.parameter import ParameterEstimate, Role

ORDER = "order"
"""Parameter by which effects of one name are others: how often in a turn."""


def size_limits(loop: Loop, effect: FoundEffect) -> dict[str, tuple[float, float]]:
    """Of each size that a single number tells, by its name: the lowest and the highest that it is with any sides worn throughout, in its unit, with 1.96
    standard deviations. Only where that is more than its own; with sides with which the effect is not found it is none."""
    others = [_the_same(effect, other) for other in loop.others]
    limits = dict[str, tuple[float, float]]()
    for parameter in effect.candidate.effect.parameters:
        own = _interval(effect.parameters, parameter.name)
        if parameter.role is not Role.SIZE or own is None:
            continue
        else_ = [(0.0, 0.0) if other is None else _interval(other.parameters, parameter.name) or own for other in others]
        value = effect.parameters[parameter.name].value
        if any(not own[0] <= 0.5 * (low + high) <= own[1] for low, high in else_) and isinstance(value, float):
            limits[parameter.name] = min(own[0], *(low for low, _ in else_)), max(own[1], *(high for _, high in else_))
    return limits


def _the_same(effect: FoundEffect, loop: Loop) -> FoundEffect | None:
    """The effect of that name, and of its order where it has one, among those of another reading."""
    for other in loop.effects:
        if other.name == effect.name and other.parameters.get(ORDER) == effect.parameters.get(ORDER):
            return other
    return None


def _interval(parameters: Mapping[str, ParameterEstimate], name: str) -> tuple[float, float] | None:
    known = parameters.get(name)
    if known is None or isinstance(known.value, tuple) or isinstance(known.std, tuple) or not known.std >= 0.0:
        return None
    return known.value - NORMAL_95 * known.std, known.value + NORMAL_95 * known.std

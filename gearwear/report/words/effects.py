"""Effects of the catalogue as an engineer would say them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from gearwear.design.quantity import SPACE, listed, pretty_unit, significant
from gearwear.diagnose.effects import named_effects
from gearwear.diagnose.found import FoundEffect
from gearwear.diagnose.parameter import ParameterEstimate
from gearwear.report.words.numbers import effect_title, named, quantity
from gearwear.wear_law.teeth import FittedLaw


def found_words(effect: FoundEffect, limits: Mapping[str, tuple[float, float]] | None = None) -> str:
    """What an effect that was found is, with its numbers; in the place of some the limits between which they lie, by name and in their unit."""
    return effect_words(effect.name, effect.parameters, limits)


def fitted_words(law: FittedLaw) -> str:
    """What a wear law on the flanks of one side is, with its number."""
    return effect_words(law.name, {"depth_um": ParameterEstimate(1e3 * law.depth, 1e3 * law.std, "um")})


def effect_words(
    name: str, parameters: Mapping[str, ParameterEstimate], limits: Mapping[str, tuple[float, float]] | None = None
) -> str:
    """What an effect is, with its numbers, as an engineer would say it.

    Parameters
    ----------
    name : str
        One that is not in the catalogue is named as it is.
    parameters : mapping of str to ParameterEstimate
    limits : mapping of str to (float, float), or None
        Between what some of them lie, in their unit, told in their place.

    Returns
    -------
    str

    Examples
    --------
    >>> effect_words("scale", {"relative_ppm": ParameterEstimate(-120.0, 5.2, "ppm")})
    'a scan that is 120.0\\u202f±\\u202f5.2\\u202fppm too small'
    >>> effect_words("scale", {"relative_ppm": ParameterEstimate(-120.0, 5.2, "ppm")}, {"relative_ppm": (-160.0, -109.8)})
    'a scan that is 110 to 160\\u202fppm too small'
    """
    known, open_ = named_effects().get(name), limits or {}
    if known is not None and known.phrase_of_sides and len(parameters) == len(known.parameters):
        return known.phrase_of_sides.format(**{label: _told(item, open_.get(label)) for label, item in parameters.items()})
    told = () if known is None else known.parameters[:1] if known.phrase_of_sides else known.parameters
    if known is not None and all(parameter.name in parameters for parameter in told):
        key = known.parameters[0].name
        first = parameters[key]
        below = bool(known.phrase_below) and not isinstance(first.value, tuple) and first.value < 0.0
        shown = parameters
        if below and not isinstance(first.value, tuple):
            shown = {**parameters, key: replace(first, value=-first.value)}
            open_ = {**open_, **({key: (-open_[key][1], -open_[key][0])} if key in open_ else {})}
        phrase = known.phrase_below if below else known.phrase
        return (
            phrase.format(**{label: _told(item, open_.get(label)) for label, item in shown.items()})
            .replace(" 1 times ", " once ")
            .replace(" 2 times ", " twice ")
        )
    return effect_title(name) + (f" ({listed(named(parameters))})" if parameters else "")


def _told(estimate: ParameterEstimate, limits: tuple[float, float] | None) -> str:
    """A number with its ±, or the limits between which it lies."""
    if limits is None:
        return quantity(estimate)
    unit = pretty_unit(estimate.unit)
    return f"{significant(limits[0])} to {significant(limits[1])}" + (f"{SPACE}{unit}" if unit else "")

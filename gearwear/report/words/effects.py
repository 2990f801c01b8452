"""Effects of the catalogue as an engineer would say them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gearwear.design.quantity import listed
from gearwear.diagnose.effects import named_effects
from gearwear.report.figures.arrays import Report
from gearwear.report.words.numbers import effect_title, named, quantity


def effect_words(effect: Report) -> str:
    """What an effect is, with its numbers, as an engineer would say it.

    Parameters
    ----------
    effect : mapping
        ``name`` and ``parameters`` of the report. One that is not in the catalogue is named as it is.

    Returns
    -------
    str

    Examples
    --------
    >>> effect_words({"name": "scale", "parameters": {"relative_ppm": {"value": -120.0, "std": 5.0, "unit": "ppm"}}})
    'a scan that is 120\\u202f±\\u202f5\\u202fppm too small'
    """
    name, parameters = str(effect["name"]), effect.get("parameters") or {}
    known = named_effects().get(name)
    if known is not None:
        try:
            key = known.parameters[0].name
            below = bool(known.phrase_below) and _value(parameters[key]) < 0.0
            words = {one: quantity(item) for one, item in parameters.items()} | (
                {key: _magnitude(parameters[key])} if below else {}
            )
            return (known.phrase_below if below else known.phrase).format(**words)
        except (KeyError, TypeError):  # a number is missing: the name alone is still true
            return effect_title(name)
    numbers = listed(named(str(key), item) for key, item in parameters.items())
    return effect_title(name) + (f" ({numbers})" if numbers else "")


def _value(item: Any) -> float:
    return float(item["value"] if isinstance(item, Mapping) else item)


def _magnitude(item: Any) -> str:
    """A value without its sign, in words."""
    return quantity({**item, "value": abs(item["value"])} if isinstance(item, Mapping) else abs(item))

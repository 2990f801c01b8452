"""The catalogue: every module of this folder that has an `EFFECT`. Adding an effect is adding a file, its test and its row in the docs."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from gearwear.diagnose.effects.base import Effect


def catalogue() -> tuple[Effect, ...]:
    """All effects, by name of their module; the search tries those that are `searched`."""
    found = []
    for module in sorted(info.name for info in pkgutil.iter_modules(__path__)):
        effect = getattr(importlib.import_module(f"{__name__}.{module}"), "EFFECT", None)
        if effect is not None:
            found.append(effect)
    return tuple(found)


@cache
def named_effects() -> dict[str, Effect]:
    """The catalogue by the effects' names."""
    return {effect.name: effect for effect in catalogue()}

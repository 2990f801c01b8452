"""The catalogue: every module of this folder that has an `EFFECT`. Adding an effect is adding a file, its test and its row in the docs."""

from __future__ import annotations

import importlib
import pkgutil

from gearwear.diagnose.effects.base import Effect


def catalogue() -> tuple[Effect, ...]:
    """The effects that the search tries, by name of their module."""
    return tuple(effect for effect in complete_catalogue() if effect.searched)


def complete_catalogue() -> tuple[Effect, ...]:
    """All effects, also those that only a fit that asks for them by name may use (metal pushed up by wear)."""
    found = []
    for module in sorted(info.name for info in pkgutil.iter_modules(__path__)):
        effect = getattr(importlib.import_module(f"{__name__}.{module}"), "EFFECT", None)
        if effect is not None:
            found.append(effect)
    return tuple(found)

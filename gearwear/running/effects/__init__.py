"""The catalogue of running: every module of this folder that has an `EFFECT`. Adding an effect is adding a file, its test and its row in the docs."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from gearwear.running.effects.base import OtherSideEffect, RoundEffect, RunEffect


@cache
def running_effects() -> tuple[RunEffect | RoundEffect | OtherSideEffect, ...]:
    """All effects, by name of their module."""
    modules = (
        importlib.import_module(f"{__name__}.{name}") for name in sorted(info.name for info in pkgutil.iter_modules(__path__))
    )
    return tuple(module.EFFECT for module in modules if hasattr(module, "EFFECT"))

"""gearwear: from the scan of a worn spur gear to the metal that is gone, what it does to the meshing, and what caused the rest.

``import gearwear as gw`` loads nothing; the names below are loaded when they are first used (PEP 562).

>>> import gearwear as gw
>>> design = gw.read_design(gw.example("design.toml"))
>>> design.gears["pinion"].teeth, design.centre_distance
(12, 114.3)
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearwear.design.gear import Gear as Gear
    from gearwear.design.pair import Design as Design
    from gearwear.design.reading import read_design as read_design
    from gearwear.design.spec import GearSpec as GearSpec
    from gearwear.design.surface import locate as locate
    from gearwear.errors import InputError as InputError
    from gearwear.measuring import find_effects as find_effects
    from gearwear.measuring import register as register
    from gearwear.meshing.contact import mesh_contact as mesh_contact
    from gearwear.meshing.exact import exact_meshing as exact_meshing
    from gearwear.meshing.shafts import shaft_movement as shaft_movement
    from gearwear.meshing.wear_fit import fit_wear_law as fit_wear_law
    from gearwear.meshing.wear_forecast import cycles_left as cycles_left
    from gearwear.meshing.wear_forecast import forecast_wear as forecast_wear
    from gearwear.meshing_study import study_meshing as study_meshing
    from gearwear.report import figures as figures
    from gearwear.stages import as_scan as as_scan
    from gearwear.stages import compare as compare
    from gearwear.stages import example as example
    from gearwear.stages import find_wear as find_wear
    from gearwear.stages import inspect as inspect
    from gearwear.stages import propose_design as propose_design
    from gearwear.stages import read_scan as read_scan
    from gearwear.stages import write as write

__version__ = "0.1.0"

_HOME = {
    "Gear": "design.gear", "Design": "design.pair", "GearSpec": "design.spec", "InputError": "errors",
    "read_design": "design.reading", "locate": "design.surface", "register": "measuring", "find_effects": "measuring",
    "mesh_contact": "meshing.contact", "exact_meshing": "meshing.exact",
    "fit_wear_law": "meshing.wear_fit", "forecast_wear": "meshing.wear_forecast", "cycles_left": "meshing.wear_forecast",
    "shaft_movement": "meshing.shafts", "study_meshing": "meshing_study", "figures": "report",
    "as_scan": "stages", "compare": "stages", "example": "stages", "find_wear": "stages", "inspect": "stages",
    "propose_design": "stages", "read_scan": "stages", "write": "stages",
}  # fmt: skip

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = import_module(f"{__name__}.{_HOME[name]}")
    value = import_module(f"{home.__name__}.{name}") if name == "figures" else getattr(home, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})


class _Package(ModuleType):
    """`gearwear.compare` is the function, whether or not the command's module of that name has been imported."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in ("compare", "inspect") and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package

"""gearwear: from the scan of a worn gear to the metal that is gone, what it does to the meshing, and what caused the rest.

The gear is spur, helical, double helical or a ring. ``import gearwear as gw`` loads nothing; the names below are loaded when they are
first used (PEP 562).

>>> import gearwear as gw
>>> design = gw.read_design(gw.example("design.toml"))
>>> design.gears["pinion"].teeth, design.centre_distance
(12, 114.3)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearwear.api import as_columns as as_columns
    from gearwear.api import as_dict as as_dict
    from gearwear.api import as_scan as as_scan
    from gearwear.api import compare as compare
    from gearwear.api import example as example
    from gearwear.api import find_wear as find_wear
    from gearwear.api import inspect as inspect
    from gearwear.api import propose_design as propose_design
    from gearwear.api import read_scan as read_scan
    from gearwear.api import report_arrays as report_arrays
    from gearwear.api import write as write
    from gearwear.comparison.closing import find_effects as find_effects
    from gearwear.comparison.measured_gear import register as register
    from gearwear.design.files.toml import read_design as read_design
    from gearwear.design.gear import Gear as Gear
    from gearwear.design.load import LoadSpec as LoadSpec
    from gearwear.design.pair import Design as Design
    from gearwear.design.profiles import ToothProfiles as ToothProfiles
    from gearwear.design.profiles import nominal_profiles as nominal_profiles
    from gearwear.design.side import Side as Side
    from gearwear.design.spec import GearSpec as GearSpec
    from gearwear.design.surface import locate as locate
    from gearwear.errors import InputError as InputError
    from gearwear.inspection.settings import Settings as Settings
    from gearwear.loaded.study import study_load as study_load
    from gearwear.meshing.contact import mesh_contact as mesh_contact
    from gearwear.meshing.exact import exact_meshing as exact_meshing
    from gearwear.meshing.shafts import shaft_movement as shaft_movement
    from gearwear.meshing.study import study_meshing as study_meshing
    from gearwear.report import figures as figures
    from gearwear.wear_law.archard import LoadSharing as LoadSharing
    from gearwear.wear_law.fit import fit_wear_law as fit_wear_law
    from gearwear.wear_law.forecast import cycles_left as cycles_left
    from gearwear.wear_law.forecast import forecast_wear as forecast_wear
    from gearwear.wear_law.study import Ahead as Ahead

__version__ = "0.38.0"

_HOME = {
    "Gear": "design.gear", "Design": "design.pair", "GearSpec": "design.spec", "InputError": "errors",
    "read_design": "design.files.toml", "locate": "design.surface", "register": "comparison.measured_gear", "find_effects": "comparison.closing",
    "mesh_contact": "meshing.contact", "LoadSpec": "design.load", "study_load": "loaded.study", "exact_meshing": "meshing.exact",
    "fit_wear_law": "wear_law.fit", "forecast_wear": "wear_law.forecast", "cycles_left": "wear_law.forecast",
    "shaft_movement": "meshing.shafts", "study_meshing": "meshing.study", "figures": "report",
    "ToothProfiles": "design.profiles", "nominal_profiles": "design.profiles", "Settings": "inspection.settings", "LoadSharing": "wear_law.archard",
    "Ahead": "wear_law.study",
    "Side": "design.side", "as_scan": "api", "as_dict": "api", "as_columns": "api", "report_arrays": "api", "compare": "api", "example": "api", "find_wear": "api", "inspect": "api",
    "propose_design": "api", "read_scan": "api", "write": "api",
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
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})

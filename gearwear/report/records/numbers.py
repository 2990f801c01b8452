"""What every record is made of: value with standard deviation, value with U, numbers rounded, null where nothing was seen."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from gearwear.design.side import Side
from gearwear.diagnose.parameter import ParameterEstimate
from gearwear.inspection.estimate import Estimate

Json = dict[str, Any]


def value_std(value: float, std: float) -> Json:
    """A measured number and its standard deviation; the unit stands in the key above."""
    return {"value": value, "std": std}


def value_std_unit(value: float | list[float], std: float | list[float], unit: str) -> Json:
    """A parameter: its number or list of numbers, standard deviation and unit."""
    return {"value": value, "std": std, "unit": unit}


def parameters_record(parameters: Mapping[str, ParameterEstimate]) -> Json:
    """The parameters of an effect, by name."""
    return {name: value_std_unit(_listed(item.value), _listed(item.std), item.unit) for name, item in parameters.items()}


def _listed(value: float | tuple[float, ...]) -> float | list[float]:
    return list(value) if isinstance(value, tuple) else value


def per_flank(parts: dict[str, Estimate]) -> list[Json]:
    """A row per tooth and side."""
    shape = next(iter(parts.values())).value.shape
    return [
        {"tooth": tooth + 1, "flank": str(tuple(Side)[side])}
        | {name: estimate(part.at(tooth, side), 1e3, 2) for name, part in parts.items()}
        for tooth, side in np.ndindex(*shape)
    ]


def estimate(measured: Estimate, factor: float, digits: int) -> Json | None:
    """A deviation of an inspection with its U, and what noise may have added to it where that is not 0."""
    if not np.isfinite(measured.value):
        return None
    record: Json = {
        "value": rounded(float(measured.value), factor, digits),
        "expanded": rounded(float(measured.expanded), factor, digits),
    }
    if float(measured.noise) != 0.0:
        record["noise"] = rounded(float(measured.noise), factor, digits)
    return record


def rolls(places: tuple[float, float]) -> list[float | None]:
    """Roll lengths (mm) of two places along a profile (`inspection.ranges.profile_place`), root side first: on a ring it is the greater."""
    return lengths((abs(places[0]), abs(places[1])))


def lengths(pair: tuple[float, float]) -> list[float | None]:
    """Two heights or sizes, mm."""
    return [rounded(length, 1, 4) for length in pair]


def rounded(value: float, factor: float, digits: int) -> float | None:
    """`factor` × `value`, without −0; None where it was not seen."""
    return round(float(value) * factor, digits) + 0.0 if math.isfinite(value) else None

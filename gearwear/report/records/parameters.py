"""The parameters of an effect as plain numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gearwear.diagnose.parameter import ParameterEstimate

Json = dict[str, Any]


def parameters_record(parameters: Mapping[str, ParameterEstimate]) -> Json:
    """Value, standard deviation and unit of each parameter of an effect."""
    return {
        name: {"value": _listed(item.value), "std": _listed(item.std), "unit": item.unit} for name, item in parameters.items()
    }


def _listed(value: float | tuple[float, ...]) -> float | list[float]:
    return list(value) if isinstance(value, tuple) else value

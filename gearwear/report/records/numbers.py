"""Measured numbers as JSON: rounded, with U, null where nothing was seen."""

from __future__ import annotations

import math

import numpy as np

from gearwear.design.side import Side
from gearwear.inspection.estimate import Estimate

Record = dict[str, object]


def per_flank(parts: dict[str, Estimate]) -> list[Record]:
    """A row per tooth and side."""
    shape = next(iter(parts.values())).value.shape
    return [
        {"tooth": tooth + 1, "flank": str(tuple(Side)[side])}
        | {name: estimate(part.at(tooth, side), 1e3, 2) for name, part in parts.items()}
        for tooth, side in np.ndindex(*shape)
    ]


def estimate(one: Estimate, factor: float, digits: int) -> Record | None:
    if not np.isfinite(one.value):
        return None
    record: Record = {
        "value": rounded(float(one.value), factor, digits),
        "expanded": rounded(float(one.expanded), factor, digits),
    }
    if float(one.noise) != 0.0:
        record["noise"] = rounded(float(one.noise), factor, digits)
    return record


def rolls(places: tuple[float, float]) -> list[float | None]:
    """Roll lengths (mm) of two places along a profile (`inspection.ranges.profile_place`), root side first: on a ring it is the greater."""
    return [rounded(abs(place), 1, 4) for place in places]


def rounded(value: float, factor: float, digits: int) -> float | None:
    return round(float(value) * factor, digits) + 0.0 if math.isfinite(value) else None

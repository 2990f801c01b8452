"""Stated numbers within what they may be."""

from __future__ import annotations

import math

from gearwear.design.given import check_number
from gearwear.design.quantity import as_given
from gearwear.errors import InputError


def check_between(section: str, label: str, value: float, low: float, high: float, unit: str) -> None:
    """Refuse a number outside its range, or none at all, by section and key of the design; radians for degrees are pointed out."""
    check_number(f"[{section}] {label}", value, unit)
    if not low <= value <= high:  # refuses NaN too
        degrees = math.degrees(value)
        radians = (
            f"; {as_given(value)} radians would be {degrees:.3g} degrees" if unit == "degrees" and low <= degrees <= high else ""
        )
        raise InputError(f"[{section}] {label} = {as_given(value)} {unit}: must lie from {low:g} to {high:g}{radians}")

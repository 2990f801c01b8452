"""``[weighing]`` of a design file."""

from __future__ import annotations

from typing import Any

from gearwear.design.files.values import finite_number, quoted_word, shown_key, unknown
from gearwear.design.spec import shown
from gearwear.design.weighing import DENSITY, DENSITY_STD, WeighingSpec
from gearwear.errors import InputError

WEIGHING_KEYS = ("before_g", "after_g", "std_g", "material", "density_g_cm3", "density_std_percent")


def parse_weighing(table: dict[str, Any]) -> WeighingSpec:
    """Read ``[weighing]``.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value impossible.
    """
    for key in table:
        if key not in WEIGHING_KEYS:
            raise InputError(unknown(f"[weighing] {shown_key(key)}", key, WEIGHING_KEYS))
    for key in ("before_g", "after_g", "std_g"):
        if key not in table:
            raise InputError(f"[weighing] {key} is missing: g")
    if ("material" in table) == ("density_g_cm3" in table):
        given = "both given" if "material" in table else "both missing"
        raise InputError(f"[weighing] material and density_g_cm3 are {given}: one of them")
    if "material" in table:
        material = quoted_word("weighing", table, "material")
        if material not in DENSITY:
            raise InputError(unknown(f"[weighing] material = {shown(material)}", material, tuple(DENSITY)))
        density = DENSITY[material]
    else:
        density = finite_number("weighing", table, "density_g_cm3")
    before, after, std = (finite_number("weighing", table, key) for key in ("before_g", "after_g", "std_g"))
    share = finite_number("weighing", table, "density_std_percent") / 100.0 if "density_std_percent" in table else DENSITY_STD
    return WeighingSpec(before, after, std, density, share)

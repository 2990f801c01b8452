"""``[[datum.artefact]]`` of a design file."""

from __future__ import annotations

from typing import Any

from gearwear.design.files.values import finite_number, quoted_word, shown_key, unknown
from gearwear.design.spec import Artefact, shown
from gearwear.errors import InputError

ARTEFACT_KEYS = ("kind", "diameter_mm", "centre_mm", "std_um")
MOST_ARTEFACTS = 20


def parse_artefacts(tables: Any) -> tuple[Artefact, ...]:
    """Read the tables; µm here, mm inside.

    Raises
    ------
    InputError
        If they are none, a key is unknown or missing, or a value impossible.
    """
    if not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables) or len(tables) > MOST_ARTEFACTS:
        raise InputError(
            f"[datum] artefact = {shown(tables)}: up to {MOST_ARTEFACTS} tables, written [[datum.artefact]], would be right"
        )
    return tuple(_artefact(one) for one in tables)


def _artefact(table: dict[str, Any]) -> Artefact:
    for key in table:
        if key not in ARTEFACT_KEYS:
            raise InputError(unknown(f"[datum] artefact {shown_key(key)}", key, ARTEFACT_KEYS))
    for key in ARTEFACT_KEYS[:3]:
        if key not in table:
            raise InputError(f"[datum] artefact: {key} is missing")
    centre = table["centre_mm"]
    if not isinstance(centre, list) or len(centre) != 3:
        raise InputError(
            f"[datum] artefact centre_mm = {shown(centre)}: three numbers, such as [80.0, 0.0, 12.0], would be right"
        )
    x, y, z = (finite_number("datum", {"artefact centre_mm": value}, "artefact centre_mm") for value in centre)
    std = 1e-3 * finite_number("datum", table, "std_um") if "std_um" in table else 0.0
    return Artefact(quoted_word("datum", table, "kind"), finite_number("datum", table, "diameter_mm"), (x, y, z), std)

"""``[[datum.artefact]]`` and ``[[datum.band]]`` of a design file."""

from __future__ import annotations

from typing import Any

from gearwear.design.files.values import finite_number, quoted_word, shown_key, unknown
from gearwear.design.spec import Artefact, DatumBand, shown
from gearwear.errors import InputError

ARTEFACT_KEYS = ("kind", "diameter_mm", "centre_mm", "std_um")
BAND_KEYS = ("diameter_mm", "z_mm")
MOST_TABLES = 20


def parse_artefacts(tables: Any) -> tuple[Artefact, ...]:
    """Read the tables; µm here, mm inside.

    Raises
    ------
    InputError
        If they are none, a key is unknown or missing, or a value impossible.
    """
    return tuple(_artefact(one) for one in _tables("artefact", tables))


def parse_bands(tables: Any) -> tuple[DatumBand, ...]:
    """Read the bands; errors as `parse_artefacts`."""
    return tuple(_band(one) for one in _tables("band", tables))


def _band(table: dict[str, Any]) -> DatumBand:
    for key in table:
        if key not in BAND_KEYS:
            raise InputError(unknown(f"[datum] band {shown_key(key)}", key, BAND_KEYS))
    for key in BAND_KEYS:
        if key not in table:
            raise InputError(f"[datum] band: {key} is missing")
    ends = table["z_mm"]
    if not isinstance(ends, list) or len(ends) != 2:
        raise InputError(f"[datum] band z_mm = {shown(ends)}: two heights, such as [-20.0, -5.0], would be right")
    low, high = (finite_number("datum", {"band z_mm": value}, "band z_mm") for value in ends)
    return DatumBand(finite_number("datum", table, "diameter_mm"), low, high)


def _tables(what: str, tables: Any) -> list[dict[str, Any]]:
    if not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables) or len(tables) > MOST_TABLES:
        raise InputError(
            f"[datum] {what} = {shown(tables)}: up to {MOST_TABLES} tables, written [[datum.{what}]], would be right"
        )
    return tables


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

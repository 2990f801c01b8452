"""``[report]`` of a design file: what its reports say of the part and of who measured it."""

from __future__ import annotations

from dataclasses import fields
from datetime import date, datetime, time
from typing import Any

from gearwear.design.report_details import ReportDetails
from gearwear.design.spec import shown
from gearwear.errors import InputError

REPORT_KEYS = tuple(field.name for field in fields(ReportDetails))


def parse_report(table: dict[str, Any]) -> ReportDetails:
    """The details that a table gives; its keys are known.

    Raises
    ------
    InputError
        If a value is no text, date or whole number, or cannot be printed.
    """
    return ReportDetails(**{key: _text(key, value) for key, value in table.items()})


def _text(key: str, value: object) -> str:
    if isinstance(value, date | datetime | time):
        return value.isoformat()
    if isinstance(value, int) and not isinstance(value, bool):
        return shown(value)
    if not isinstance(value, str):
        raise InputError(f'[report] {key} = {shown(value)}: must be text, as {key} = "…"')
    return value.strip()

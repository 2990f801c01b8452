"""What became of a scan."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """Of a scan in the store."""

    DONE = "done"
    REFUSED = "refused"
    """Bad input: not tried again before the row or a file changes."""
    FAILED = "failed"
    """For any other reason: tried again by the next batch."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """A scan after its comparison.

    Parameters
    ----------
    key : str
    state : State
    report : bytes
        `report.json`; empty where there is none.
    table : bytes
        Its numbers as a Parquet file; empty where there are none.
    why : str
        Why not: one line, or of a failure more.
    """

    key: str
    state: State
    report: bytes = b""
    table: bytes = b""
    why: str = ""

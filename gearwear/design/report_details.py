"""What a report says of the part and of who measured it, as given: no number hangs on it."""

from __future__ import annotations

from dataclasses import dataclass, fields

from gearwear.errors import InputError

LONGEST_LINE, LONGEST_REMARKS = 200, 4000
"""Letters of a detail, and of the remarks."""
JOINERS = "\u200c\u200d"
"""Marks without width that some scripts are written with."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportDetails:
    """What stands at the head of a report; empty where it was not given.

    Parameters
    ----------
    part_number, serial, customer, operator, instrument, date : str
        A line each.
    remarks : str
        May have several lines.
    logo : str
        File of a picture, PNG or JPEG.

    Raises
    ------
    InputError
        If a text is too long or holds what cannot be printed.
    """

    part_number: str = ""
    serial: str = ""
    customer: str = ""
    operator: str = ""
    instrument: str = ""
    date: str = ""
    remarks: str = ""
    logo: str = ""

    def __post_init__(self) -> None:
        for name, text in ((field.name, getattr(self, field.name)) for field in fields(self)):
            if name == "logo":
                continue
            longest = LONGEST_REMARKS if name == "remarks" else LONGEST_LINE
            if len(text) > longest:
                raise InputError(f"[report] {name} has {len(text)} letters: at most {longest} would be right")
            lines = text.replace("\n", "").replace("\t", "") if name == "remarks" else text
            odd = next((letter for letter in lines if not (letter.isprintable() or letter in JOINERS)), None)
            if odd is not None:
                raise InputError(f"[report] {name} holds U+{ord(odd):04X}, which cannot be printed: plain text would be right")

    @property
    def told(self) -> list[tuple[str, str]]:
        """Names and texts of what was given; the logo is none."""
        pairs = [(field.name.replace("_", " "), getattr(self, field.name)) for field in fields(self) if field.name != "logo"]
        return [(name, text) for name, text in pairs if text]

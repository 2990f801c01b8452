"""The list of scans of a fleet: a CSV with a row for each, checked before any of them is read."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from difflib import get_close_matches
from pathlib import Path

from gearwear.design.files.toml import read_small
from gearwear.errors import InputError, readable

NEEDED = ("gear_id", "design", "scans")
OPTIONAL = ("inspected", "part", "units", "before", "cycles_run", "operator", "repeat")
RESERVED = ("key", "state", "quantity", "scope", "tooth", "flank", "value", "std", "low", "high", "converged")
"""Columns that the store adds itself."""
PARTS, UNITS = ("pinion", "gear"), ("mm", "cm", "m", "um", "in")
NEEDS = "a table (CSV) with the columns gear_id, design, scans, and any of inspected, part, units, before, cycles_run, operator, repeat"
BY_DAY = re.compile(r"(\d{1,2})\.(\d{1,2})\.(\d{4})(?:( \d{2}:\d{2}(?::\d{2})?))?")
"""A date as spreadsheets with a decimal comma write it: day, month, year, and a time. With slashes nobody knows which is the day."""
MOST_BYTES = 200_000_000
THOUSANDS = re.compile(r",\d{3}\b")
"""A comma before three digits may part thousands or be a decimal one: such a number is refused."""
MOST_CYCLES = 1e15
"""Revolutions; no gear comes near, and squares of what is far larger have no number."""
FIRST_YEAR, LAST_YEAR = 1900, 2200
"""Within which a scan is dated: what lies outside is a slip of the pen, and leaves the calendar no room for a forecast."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManifestRow:
    """A scan to be compared.

    Parameters
    ----------
    line : int
        Of the manifest, from 1.
    gear_id : str
        Which gear; the same in all of its inspections.
    design : str
        Design file, as the manifest writes it.
    scans, before : tuple of str
        Views of the gear, and of the same gear unworn, as the manifest writes them.
    inspected : datetime or None
        When it was scanned.
    part : {"pinion", "gear"} or None
        None: the one that fits.
    units : str
        Of the scans.
    cycles_run : float or None
        Mesh cycles of the gear so far: its own revolutions.
    operator, repeat : str
        Who scanned, and which of several scans of the same gear this is; may be empty.
    more : tuple of (str, str)
        Further columns and what stands in them.
    """

    line: int
    gear_id: str
    design: str
    scans: tuple[str, ...]
    inspected: datetime | None = None
    part: str | None = None
    units: str = "mm"
    before: tuple[str, ...] = ()
    cycles_run: float | None = None
    operator: str = ""
    repeat: str = ""
    more: tuple[tuple[str, str], ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """All that is read: the design first."""
        return (self.design, *self.scans, *self.before)

    @property
    def cells(self) -> dict[str, str]:
        """The row as text by column, written in one way whatever the manifest's: the same row, the same cells."""
        return {
            "gear_id": self.gear_id,
            "inspected": shown_time(self.inspected),
            "design": self.design,
            "scans": ";".join(self.scans),
            "part": self.part or "",
            "units": self.units,
            "before": ";".join(self.before),
            "cycles_run": "" if self.cycles_run is None else f"{self.cycles_run:.15g}",
            "operator": self.operator,
            "repeat": self.repeat,
            **dict(self.more),
        }


def shown_time(moment: datetime | None) -> str:
    """A date, with the time of day where there is one.

    >>> shown_time(datetime(2026, 3, 1)), shown_time(datetime(2026, 3, 1, 14, 30)), shown_time(None)
    ('2026-03-01', '2026-03-01T14:30:00', '')
    """
    if moment is None:
        return ""
    plain = moment.hour == moment.minute == moment.second == moment.microsecond == 0 and moment.tzinfo is None
    return moment.date().isoformat() if plain else moment.isoformat()


def read_manifest(path: Path) -> list[ManifestRow]:
    """Read the list of scans.

    Parameters
    ----------
    path : Path
        CSV with a line of column names, whose capitals and blanks do not count; the separator is a comma, a semicolon or a tabulator. Empty
        lines and lines that begin with # are skipped. Dates and numbers may be as spreadsheets with a decimal comma write them.

    Returns
    -------
    list of ManifestRow
        In the order of the file; paths as it writes them, relative ones are meant from its folder.

    Raises
    ------
    InputError
        With the line, if it is no such table, a value is not legal, or two rows are the same.
    """
    lines = _text(path).splitlines()
    rows = _records(path, lines)
    try:
        first, names = next(rows)
    except StopIteration:
        raise InputError(f"{path}: is empty; {NEEDS} is needed") from None
    names = [plain if (plain := _plain(name)) in (*NEEDED, *OPTIONAL) else name.strip() for name in names]
    _check_names(path, first, names)
    manifest: list[ManifestRow] = []
    lines_of: dict[tuple[tuple[str, str], ...], int] = {}
    for number, cells in rows:
        if len(cells) != len(names):
            raise InputError(f"{path}: line {number} has {len(cells)} cells and line {first} names {len(names)} columns")
        try:
            row = _row(number, dict(zip(names, (cell.strip() for cell in cells), strict=True)))
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from None
        same = tuple(row.cells.items())
        if same in lines_of:
            raise InputError(
                f"{path}: line {number} is the same as line {lines_of[same]}: a second scan of the same gear has its own `repeat`"
            )
        lines_of[same] = number
        manifest.append(row)
    if not manifest:
        raise InputError(f"{path}: has no row below its column names; a row for each scan is needed")
    return manifest


def _text(path: Path) -> str:
    data = read_small(path, NEEDS, MOST_BYTES, usual="")
    try:
        text = data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:  # nor has a file's name any
        raise InputError(f"{path}: is not text in UTF-8, which spreadsheets call CSV UTF-8; {NEEDS} is needed") from None
    return text


def _records(path: Path, lines: list[str]) -> Iterator[tuple[int, list[str]]]:
    """Number of the first line and cells of each row that says something."""
    lines = ["" if line.lstrip().startswith("#") else line for line in lines]
    head = next((line for line in lines if line.strip()), "")
    reader = csv.reader(lines, delimiter=max(",;\t", key=head.count), skipinitialspace=True, strict=True)
    begins = 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield begins, cells
            begins = reader.line_num + 1
    except csv.Error as error:
        raise InputError(f"{path}: line {begins} is no row of a table ({error}); {NEEDS} is needed") from None


def _plain(name: str) -> str:
    """A column's name without capitals, blanks and hyphens, which nobody means as another column.

    >>> _plain(" Cycles run ")
    'cycles_run'
    """
    return re.sub(r"\W+", "_", name.strip().lower())


def _check_names(path: Path, line: int, names: list[str]) -> None:
    for name in NEEDED:
        if name not in names:
            plain = {_plain(one): one for one in names}
            near = [plain[one] for one in get_close_matches(name, plain, 1)]
            meant = f" ({near[0]!r}?)" if near else ""
            raise InputError(f"{path}: line {line} names no column {name}{meant}; {NEEDS} is needed")
    for name in names:
        if names.count(name) > 1 or not name:
            raise InputError(
                f"{path}: line {line} names {name or 'nothing'!r} {names.count(name)} times; each column needs a name"
            )
        if name in RESERVED or name.startswith("limit_"):
            raise InputError(f"{path}: line {line}: the store writes a column {name!r} itself; another name would be right")


def _row(line: int, cells: dict[str, str]) -> ManifestRow:
    def one_of(name: str, known: tuple[str, ...]) -> str:
        value = cells.get(name, "").lower()
        if value and value not in known:
            raise InputError(f"{name} = {value[:40]!r}: {', '.join(known)} or nothing would be right")
        return value

    for name in NEEDED:
        if not cells[name]:
            raise InputError(f"{name} is empty")
    known = {*NEEDED, *OPTIONAL}
    scans = _files(cells["scans"])
    if not scans:
        raise InputError(f"scans = {cells['scans'][:40]!r}: at least one file is needed")
    return ManifestRow(
        line=line,
        gear_id=readable(cells["gear_id"]),
        design=cells["design"],
        scans=scans,
        inspected=read_moment(cells.get("inspected", "")),
        part=one_of("part", PARTS) or None,
        units=one_of("units", UNITS) or "mm",
        before=_files(cells.get("before", "")),
        cycles_run=_cycles(cells.get("cycles_run", "")),
        operator=cells.get("operator", ""),
        repeat=cells.get("repeat", ""),
        more=tuple((name, value) for name, value in cells.items() if name not in known),
    )


def _files(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(";") if part.strip())


def read_moment(text: str) -> datetime | None:
    """A date as a manifest writes it, with a time or without; None where nothing stands.

    >>> read_moment("2026-03-01T14:30") == read_moment("1.3.2026 14:30")
    True

    Raises
    ------
    InputError
        If it is none, has a zone, or lies outside `FIRST_YEAR` to `LAST_YEAR`.
    """
    if not text:
        return None
    by_day = BY_DAY.fullmatch(text)
    try:
        moment = datetime.fromisoformat("{2}-{1:0>2}-{0:0>2}{3}".format(*by_day.groups("")) if by_day else text)
    except ValueError:
        raise InputError(
            f"inspected = {text[:40]!r}: a date as 2026-03-01, or with a time as 2026-03-01T14:30, would be right"
        ) from None
    if moment.tzinfo is not None:
        raise InputError(f"inspected = {text[:40]!r}: local time without a zone would be right, all in the same")
    if not FIRST_YEAR <= moment.year <= LAST_YEAR:
        raise InputError(f"inspected = {text[:40]!r}: a year from {FIRST_YEAR} to {LAST_YEAR} would be right")
    return moment


def _cycles(text: str) -> float | None:
    if not text:
        return None
    try:
        cycles = float(text if THOUSANDS.search(text) else text.replace(",", "."))
    except ValueError:
        cycles = math.nan
    if not 0.0 <= cycles <= MOST_CYCLES:
        raise InputError(f"cycles_run = {text[:40]!r}: a number from 0 on, such as 2.5e6 or 2500000, would be right")
    return cycles

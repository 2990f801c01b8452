"""Under which name a scan lies in the store: from its row, what its files hold, the options and the version of the program."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from gearwear.design.files.toml import parse_design, parse_toml
from gearwear.errors import InputError
from gearwear.fleet.manifest import ManifestRow, shown_time

ABSENT = "absent"
"""Stands for the contents of a file that cannot be read."""
FRESH = 2.0
"""Seconds after a change within which the time of a file does not yet tell that it changed again."""
DIGITS = 16
"""Of the digest in a key: 64 bits."""


@dataclass(frozen=True, slots=True)
class Options:
    """What is asked of every scan, as far as it changes a result.

    Parameters
    ----------
    loop : bool
        Whether effects beyond registration are looked for.
    """

    loop: bool = True


def key_of(row: ManifestRow, contents: Sequence[str], options: Options, version: str) -> str:
    """The key of a scan: readable in front, unlike any other behind; without a dot, before which a name may be a device's on Windows.

    Parameters
    ----------
    row : ManifestRow
    contents : sequence of str
        Digests of its files, in the order of `ManifestRow.files`.
    options : Options
    version : str
        Of the program.
    """
    content = json.dumps([sorted(row.cells.items()), list(contents), asdict(options), version], ensure_ascii=True)
    name = re.sub(r"[^A-Za-z0-9_-]+", "-", "_".join(filter(None, (row.gear_id, shown_time(row.inspected))))).strip("-")[:60]
    return f"{name or 'scan'}_{hashlib.sha256(content.encode()).hexdigest()[:DIGITS]}"


class Digests:
    """Digests of files, each computed once as long as size and time of the file stay.

    Parameters
    ----------
    known : mapping or None
        Of earlier runs: path to (size, time of change in ns, digest); None: there were none.
    """

    def __init__(self, known: Mapping[str, tuple[int, int, str]] | None = None) -> None:
        self._earlier = dict(known or {})
        self._now: dict[str, tuple[int, int, str]] = {}

    def of(self, path: Path, digest: Callable[[Path], str]) -> str:
        """The digest of a file; `ABSENT` where it cannot be read."""
        name = str(path)
        try:
            status = path.stat()
            entry = self._now.get(name) or self._earlier.get(name)
            if entry is None or entry[:2] != (status.st_size, status.st_mtime_ns):
                entry = (status.st_size, status.st_mtime_ns, digest(path))
        except OSError:
            return ABSENT
        self._now[name] = entry
        return entry[2]

    def lasting(self) -> dict[str, tuple[int, int, str]]:
        """What may be kept for the next run: not of files that changed just now, they may change again within the same tick."""
        old = time.time_ns() - int(FRESH * 1e9)
        return {name: entry for name, entry in self._now.items() if entry[1] < old}


def contents_of(row: ManifestRow, folder: Path, digests: Digests) -> list[str]:
    """Digests of a row's files, the design's without its limits."""
    return [digests.of(folder / name, design_digest if i == 0 else file_digest) for i, name in enumerate(row.files)]


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes; OSError if it cannot be read."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def design_digest(path: Path) -> str:
    """SHA-256 of what a design says, ``[limits]`` left out: another limit judges a scan anew and measures nothing anew."""
    if path.suffix.lower() != ".toml":
        return file_digest(path)
    data = path.read_bytes()
    try:
        tables = parse_toml(data)
        parse_design(tables)
    except InputError:  # refused as it is: whatever is mended in it counts
        return hashlib.sha256(data).hexdigest()
    tables.pop("limits", None)
    return hashlib.sha256(json.dumps(tables, sort_keys=True, default=str).encode()).hexdigest()


def digests_text(entries: Mapping[str, tuple[int, int, str]]) -> str:
    """Digests as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for name in sorted(entries):
        writer.writerow([name, *entries[name]])
    return text.getvalue()


def parse_digests(text: str) -> dict[str, tuple[int, int, str]]:
    """Digests from CSV; lines that are none are passed over: they are only a saving of time."""
    digests = {}
    for cells in csv.reader(io.StringIO(text)):
        if len(cells) == 4 and cells[1].isdigit() and cells[2].isdigit():
            digests[cells[0]] = (int(cells[1]), int(cells[2]), cells[3])
    return digests

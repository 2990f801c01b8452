"""The folder of a fleet: a report and a table for each scan, each written at once or not at all.

::

    STORE/
      KEY.json, KEY.parquet   a scan that is done: its report, its numbers
      KEY.refused             bad input: the line that says why
      KEY.failed              what went wrong; tried again
      manifests/NAME.csv      each manifest as it was last run, with the keys of its rows and the limits of their designs
      digests.csv             of files that were read, so that they are not read again only to see that they are the same

A scan that is done has its `.json`, which comes last. There is no other index: what was killed leaves nothing that misleads.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from gearwear.design.limits import LIMIT_KEYS, MOST
from gearwear.errors import InputError
from gearwear.fleet.keys import Digests, digests_text, parse_digests
from gearwear.fleet.manifest import MOST_CYCLES, ManifestRow, read_moment
from gearwear.fleet.outcome import Outcome, State
from gearwear.report.files.locking import tried
from gearwear.report.files.writing import HIDDEN, check_folder, unwritable, write_data

SUFFIXES = {State.DONE: ".json", State.REFUSED: ".refused", State.FAILED: ".failed"}
"""The first counts where a batch that was killed left several of one scan."""
TABLE = ".parquet"
MANIFESTS, DIGESTS = "manifests", "digests.csv"


@dataclass(frozen=True, slots=True)
class Listed:
    """A row of a manifest as the store keeps it.

    Parameters
    ----------
    key : str
    cells : dict of str to str
        As `ManifestRow.cells`.
    limits : dict of str to float
        Limits of its design, by quantity.
    """

    key: str
    cells: dict[str, str]
    limits: dict[str, float]


@dataclass(frozen=True, slots=True)
class Store:
    """A fleet's folder.

    Parameters
    ----------
    folder : Path
    """

    folder: Path

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Be the only batch that writes here; what a killed one left half-written goes.

        Raises
        ------
        InputError
            If the folder cannot be written to, or another batch is at work in it.
        """
        try:
            check_folder(self.folder)
        except InputError as error:
            raise InputError(f"{error}") from None
        with ExitStack() as held:
            with self._writing():
                (self.folder / MANIFESTS).mkdir(parents=True, exist_ok=True)
                alone = held.enter_context(tried(self.folder))
                if alone is False:
                    raise InputError(f"{self.folder}: another batch is at work there; its end, or another folder, would be right")
                for folder in (self.folder, self.folder / MANIFESTS):
                    for remains in folder.glob(f"{HIDDEN}*"):
                        with suppress(OSError):
                            remains.unlink()
            yield

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Round writes to this folder alone: what fails beside them, as a scheduler does, is no fault of it."""
        try:
            yield
        except OSError as error:
            raise InputError(f"{unwritable(self.folder, error)}") from None

    def states(self) -> dict[str, State]:
        """State of every scan that has one, by key.

        Raises
        ------
        InputError
            If the folder cannot be read.
        """
        found: dict[str, set[str]] = {}
        try:
            with os.scandir(self.folder) as entries:
                for entry in entries:
                    stem, suffix = os.path.splitext(entry.name)
                    if suffix in SUFFIXES.values() and not stem.startswith(HIDDEN):
                        found.setdefault(stem, set()).add(suffix)
        except FileNotFoundError:
            pass
        except OSError as error:
            raise InputError(
                f"{self.folder}: cannot be read ({error.strerror or error}); the right to read it is needed"
            ) from None
        return {stem: next(state for state, suffix in SUFFIXES.items() if suffix in of_scan) for stem, of_scan in found.items()}

    def publish(self, outcome: Outcome) -> None:
        """Write what became of a scan; InputError if it cannot be written."""
        key = outcome.key
        with self._writing():
            if outcome.state is State.DONE:
                write_data(self.folder / f"{key}{TABLE}", outcome.table)
                write_data(self.folder / f"{key}{SUFFIXES[State.DONE]}", outcome.report)
            else:
                why = f"{outcome.why.rstrip()}\n".encode("utf-8", "backslashreplace")
                write_data(self.folder / f"{key}{SUFFIXES[outcome.state]}", why)
            for state, suffix in SUFFIXES.items():
                if state is not outcome.state and state is not State.DONE:
                    (self.folder / f"{key}{suffix}").unlink(missing_ok=True)

    def why(self, key: str, state: State) -> str:
        """The line that says why a scan was refused or failed; of a failure the last one."""
        lines = (self.folder / f"{key}{SUFFIXES[state]}").read_text(encoding="utf-8").strip().splitlines()
        return lines[-1] if lines else ""

    def tables(self, keys: Sequence[str]) -> list[Path]:
        """Tables of scans that are done."""
        return [self.folder / f"{key}{TABLE}" for key in keys]

    def digests(self) -> Digests:
        """What is known of files from earlier runs."""
        try:
            return Digests(parse_digests((self.folder / DIGESTS).read_text(encoding="utf-8", errors="surrogateescape")))
        except OSError:
            return Digests()

    def keep_digests(self, digests: Digests) -> None:
        """For the next run; InputError if they cannot be written."""
        with self._writing():
            write_data(self.folder / DIGESTS, digests_text(digests.lasting()).encode("utf-8", "surrogateescape"))

    def keep_manifest(self, name: str, rows: Sequence[tuple[ManifestRow, str, Mapping[str, float]]]) -> None:
        """Write a manifest with the key and the limits of each row, in place of the one of the same name.

        Parameters
        ----------
        name : str
            Of the manifest's file.
        rows : sequence of (ManifestRow, key, limits)

        Raises
        ------
        InputError
            If it cannot be written.
        """
        columns = list(dict.fromkeys(column for row, _, _ in rows for column in row.cells))
        text = io.StringIO()
        writer = csv.DictWriter(
            text, ["key", *columns, *(f"limit_{quantity}" for quantity in LIMIT_KEYS)], restval="", lineterminator="\n"
        )
        writer.writeheader()
        for row, key, limits in rows:
            writer.writerow(
                {"key": key, **row.cells, **{f"limit_{quantity}": f"{value:.15g}" for quantity, value in limits.items()}}
            )
        with self._writing():
            write_data(self._kept(name), text.getvalue().encode("utf-8", "surrogateescape"))

    def _kept(self, name: str) -> Path:
        """Where the manifest of a name is kept."""
        return self.folder / MANIFESTS / f"{Path(name).stem}.csv"

    def listed_in(self, name: str) -> list[Listed]:
        """The rows of the manifest of a name as it was last run; none where it was not, or is damaged."""
        try:
            return list(_listed(self._kept(name)))
        except InputError:
            return []

    def listed(self) -> list[Listed]:
        """The rows of all manifests, each key once.

        Raises
        ------
        InputError
            If there is no manifest: then this is no store; or if one is damaged.
        """
        files = sorted((self.folder / MANIFESTS).glob("*.csv"))
        if not files:
            raise InputError(f"{self.folder}: holds no fleet; the folder that gearwear batch wrote to would be right")
        return list({row.key: row for file in files for row in _listed(file)}.values())


def _listed(file: Path) -> Iterator[Listed]:
    """The rows of one kept manifest."""
    try:
        with file.open(encoding="utf-8", errors="surrogateescape", newline="") as stream:
            record = None
            for record in csv.DictReader(stream, restkey="", restval=""):
                if "" in record or not record.get("gear_id") or not record.get("key"):
                    raise ValueError("a row without key or gear_id, or longer than its head")
                limits = {name: value for name in LIMIT_KEYS if (value := _number(record.pop(f"limit_{name}", ""), MOST))}
                _number(record.get("cycles_run", ""), MOST_CYCLES)
                read_moment(record.get("inspected", ""))
                yield Listed(record.pop("key"), record, limits)
            if record is None:
                raise ValueError("no row")
    except (OSError, ValueError, csv.Error) as error:
        raise InputError(
            f"{file}: is no list that gearwear batch kept ({' '.join(str(error).split())[:200]}); the manifest run again would be right"
        ) from None


def _number(text: str, most: float) -> float:
    """A number from 0 on, 0 where nothing stands; ValueError where it is none."""
    value = float(text or 0.0)
    if not 0.0 <= value <= most:
        raise ValueError(f"{text} is no number from 0 to {most:g}")
    return value

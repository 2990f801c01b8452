"""A batch: which scans of a manifest still have to be compared, and their outcomes as they come."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path

import gearwear
from gearwear.design.files.toml import read_limits
from gearwear.fleet.keys import ABSENT, Options, contents_of, key_of
from gearwear.fleet.manifest import ManifestRow, read_manifest
from gearwear.fleet.outcome import Outcome, State
from gearwear.fleet.store import Store
from gearwear.fleet.task import Job

Crew = Callable[[Sequence[Job]], AbstractContextManager[Iterator[Outcome]]]
"""Given scans: their outcomes, as long as the context is open."""


@dataclass(frozen=True, slots=True)
class Tally:
    """How far a batch is.

    Parameters
    ----------
    total : int
        Scans in the manifest.
    done, refused, failed : int
        Of them, earlier ones included.
    to_do : int
        Scans that this batch had to compare.
    ended : int
        Of those, how many have an outcome.
    dropped : int
        Scans of an earlier list of the same name that are not in the manifest: trend and gauge do not see them any more.
    same : tuple of (ManifestRow, ManifestRow, str)
        Rows of different gears that list one scan, and its name in the second: files of the same contents.
    """

    total: int
    done: int = 0
    refused: int = 0
    failed: int = 0
    to_do: int = 0
    ended: int = 0
    dropped: int = 0
    same: tuple[tuple[ManifestRow, ManifestRow, str], ...] = ()

    def after(self, outcome: Outcome) -> Tally:
        """With one more."""
        name = str(outcome.state)
        return replace(self, **{name: getattr(self, name) + 1, "ended": self.ended + 1})


Tell = Callable[[Tally, ManifestRow | None, Outcome | None], None]
"""Told how far the batch is, first without an outcome, then with each."""


def run_batch(manifest: Path, store: Store, crew: Crew, options: Options, memory: float, tell: Tell) -> Tally:
    """Compare all scans of a manifest that the store does not hold yet.

    Parameters
    ----------
    manifest : Path
    store : Store
    crew : callable
        Who does the work; not called where there is none.
    options : Options
    memory : float
        Bytes that a scan may take.
    tell : callable

    Returns
    -------
    Tally

    Raises
    ------
    InputError
        If the manifest is wrong, the store cannot be written to, or the workers go away. What was done by then is in the store.
    """
    rows = read_manifest(manifest)
    with store.opened():
        folder, digests = manifest.absolute().parent, store.digests()
        contents = [contents_of(row, folder, digests) for row in rows]
        store.keep_digests(digests)
        keys = [key_of(row, held, options, gearwear.__version__) for row, held in zip(rows, contents, strict=True)]
        limits = {name: read_limits(folder / name).by_quantity() for name in {row.design for row in rows}}
        now = {_scan_of(row.cells) for row in rows}
        dropped = sum(_scan_of(listed.cells) not in now for listed in store.listed_in(manifest.name))
        store.keep_manifest(manifest.name, [(row, key, limits[row.design]) for row, key in zip(rows, keys, strict=True)])
        states = store.states()
        before = [states.get(key) for key in keys]
        jobs = [
            Job(key, row, str(folder), tuple(held), options, memory)
            for key, row, held, state in zip(keys, rows, contents, before, strict=True)
            if state in (None, State.FAILED)
        ]
        tally = Tally(
            len(rows),
            before.count(State.DONE),
            before.count(State.REFUSED),
            to_do=len(jobs),
            dropped=dropped,
            same=tuple(_same_scans(rows, contents)),
        )
        tell(tally, None, None)
        if jobs:
            row_of = {job.key: job.row for job in jobs}
            with crew(jobs) as outcomes:
                for outcome in outcomes:
                    store.publish(outcome)
                    tally = tally.after(outcome)
                    tell(tally, row_of[outcome.key], outcome)
    return tally


def _same_scans(rows: Sequence[ManifestRow], contents: Sequence[Sequence[str]]) -> Iterator[tuple[ManifestRow, ManifestRow, str]]:
    """Rows whose scan an earlier row of another gear has listed, each with the first that did; of two such scans of a row the first."""
    first: dict[str, ManifestRow] = {}
    for row, digests in zip(rows, contents, strict=True):
        scans = dict(zip(digests[1 : 1 + len(row.scans)], row.scans, strict=True))
        scans.pop(ABSENT, None)
        held = next((one for one in scans if one in first), None)
        if held is not None and first[held].gear_id != row.gear_id:
            yield first[held], row, scans[held]
        for one in scans:
            first.setdefault(one, row)


def _scan_of(cells: Mapping[str, str]) -> tuple[str, ...]:
    """What makes a row of a list the same scan in another one, whatever else of it was mended."""
    return tuple(cells.get(name, "") for name in ("gear_id", "inspected", "scans"))

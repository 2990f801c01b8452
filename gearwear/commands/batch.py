"""Many scans at once: ``gearwear batch FLEET.csv --out STORE``."""

from __future__ import annotations

import gc
import math
import sys
import time
from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import add_memory_argument
from gearwear.commands.progress import bar_behind, say_beside
from gearwear.errors import InputError
from gearwear.processors import processors

if TYPE_CHECKING:
    from gearwear.fleet.batch import Crew, Tally, Tell
    from gearwear.fleet.manifest import ManifestRow
    from gearwear.fleet.outcome import Outcome
    from gearwear.fleet.store import Listed, Store
    from gearwear.fleet.task import Job

DESCRIPTION = """\
Compare all scans of a fleet with their designs. FLEET.csv has a row for each scan, with
the columns gear_id, design and scans (several views with ; between), and any of
inspected (a date), part, units, before, cycles_run, operator and repeat; further
columns are kept. Paths are meant from the folder of FLEET.csv.

The store gets a report (JSON) and a table (Parquet) for each scan. What is in it is not
done again: the same command goes on where it was stopped, and does what is new. A scan
that is refused for its input is tried again once its row or files change, one that
failed for another reason with the next batch.

The work is done by as many processes as this machine has processors, or by the workers
of a Dask scheduler. Needs the extra: pip install 'gearwear[batch]'."""

SHOWN = 10
"""Lines on refused and failed scans at the end."""
NEAR = 0.7
"""How alike a further column's name is to that of one with a meaning from which on that is asked for (`difflib`)."""


def parser() -> Parser:
    """The command's arguments."""
    p = Parser("batch", "FLEET.csv", DESCRIPTION)
    p.add_argument("fleet", type=Path, metavar="FLEET.csv", help="the list of scans")
    p.add_argument(
        "--out", type=Path, default=Path("fleet-store"), metavar="STORE", help="folder of the results, default %(default)s"
    )
    p.add_argument(
        "--workers", type=int, metavar="N",
        help="processes on this machine, each with one thread; 0: none beside this one; left out: one a processor",
    )  # fmt: skip
    p.add_argument("--scheduler", metavar="ADDRESS", help="in place of --workers: a Dask scheduler, such as tcp://10.0.0.5:8786")
    add_memory_argument(p)
    p.add_argument(
        "--no-loop", action="store_true", help="do not look for effects of measurement and manufacture beyond registration"
    )
    p.add_argument("--quiet", action="store_true", help="print nothing but errors")
    p.add_argument("--verbose", action="store_true", help="print a line for every scan")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.fleet.batch import run_batch
    from gearwear.fleet.keys import Options
    from gearwear.fleet.store import Store
    from gearwear.memory import GB

    _check(arguments)
    gc.enable()  # the commands switch it off, and a batch goes on for hours
    memory, store = arguments.memory * GB, Store(arguments.out)
    with _progress(arguments.quiet, arguments.verbose) as tell:
        tally = run_batch(arguments.fleet, store, _crew(arguments, memory), Options(not arguments.no_loop), memory, tell)
    rows = list({row.key: row for row in store.listed_in(arguments.fleet.name)}.values())
    wrong = _without_result(rows, store)
    if arguments.quiet:
        sys.stderr.writelines(f"{text}\n" for text, _ in wrong)
    else:
        from gearwear.report.words.terminal import print_lines

        print_lines([*_summary(tally), *wrong, *_further_columns(rows), (f"Written to {store.folder}", "dim")])


def _check(arguments: Namespace) -> None:
    """Refuse options before anything is read."""
    if arguments.workers is not None and arguments.scheduler is not None:
        raise InputError("--workers and --scheduler both say who works: give one of them")
    if arguments.workers is not None and arguments.workers < 0:
        raise InputError(f"--workers {arguments.workers}: a number from 0 on would be right")


def _crew(arguments: Namespace, memory: float) -> Crew:
    """Who does the work."""

    @contextmanager
    def here(jobs: Sequence[Job]) -> Iterator[Iterator[Outcome]]:
        from gearwear.fleet.task import run

        yield map(run, jobs)

    @contextmanager
    def workers(jobs: Sequence[Job]) -> Iterator[Iterator[Outcome]]:
        from gearwear.fleet.cluster import dashboard, local_workers, outcomes, remote_workers

        number = min(arguments.workers or processors(), len(jobs))
        with remote_workers(arguments.scheduler) if arguments.scheduler else local_workers(number, memory) as client:
            address = dashboard(client)
            if address and not arguments.quiet:
                sys.stderr.write(f"dashboard: {address}\n")
            yield outcomes(client, jobs)

    return here if arguments.workers == 0 else workers


@contextmanager
def _progress(quiet: bool, verbose: bool) -> Iterator[Tell]:
    """Say how far the batch is, on standard error: a bar on a terminal, and a line a scan where asked for."""
    bar = None if quiet or not sys.stderr.isatty() else _bar()
    start = time.monotonic()

    def tell(tally: Tally, row: ManifestRow | None, outcome: Outcome | None) -> None:
        if bar is not None:
            description = f"{tally.done} done, {tally.refused} refused, {tally.failed} failed of {tally.total}"
            bar.update(bar.task_ids[0], description=description, completed=tally.ended, total=max(tally.to_do, 1))
        if verbose and not quiet and row is not None and outcome is not None:
            seconds = (tally.to_do - tally.ended) * (time.monotonic() - start) / tally.ended
            name = " ".join(filter(None, (row.gear_id, row.cells["inspected"], row.operator, row.repeat)))
            say_beside(bar, f"{tally.ended}/{tally.to_do} {outcome.state} {name}, about {_duration(seconds)} left")

    if bar is not None:
        bar.start()
    try:
        yield tell
    finally:
        if bar is not None:
            bar.stop()


def _bar() -> Any:
    from rich.progress import TextColumn

    return bar_behind(TextColumn("{task.description}"), total=1)


def _duration(seconds: float) -> str:
    """
    >>> _duration(40.2), _duration(250.0), _duration(9000.0)
    ('41 s', '4 min', '2.5 h')
    """
    if seconds < 90.0:
        return f"{math.ceil(seconds)} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def _summary(tally: Tally) -> list[tuple[str, str]]:
    """How many scans have a result, and what is odd about the list."""
    from gearwear.design.quantity import counted
    from gearwear.fleet.words import wrapped

    lines = [
        (f"{counted(tally.total, 'scan')}: {tally.done} done, {tally.refused} refused, {tally.failed} failed", "bold"),
        (f"{tally.ended} of them in this run, the others before" if tally.ended < tally.total else "", ""),
    ]
    if tally.dropped:
        more = f"! {tally.dropped} scans of the earlier list of this name are not in it, and are left out of trend and gauge; a list with a name of its own would keep them"
        lines += wrapped(more, "yellow", 2)
    for one, other, scan in tally.same[:SHOWN]:
        said = f"! lines {one.line} and {other.line} of the list, gears {one.gear_id} and {other.gear_id}, are the same scan: {scan} holds what that of line {one.line} does"
        lines += wrapped(said, "yellow", 2)
    if len(tally.same) > SHOWN:
        lines.append((f"! and {len(tally.same) - SHOWN} more rows that list the scan of another gear", "yellow"))
    return [line for line in lines if line[0]]


def _without_result(rows: Sequence[Listed], store: Store) -> list[tuple[str, str]]:
    """Why scans of this list were refused or failed; other lists of the store had their own batch."""
    from gearwear.fleet.outcome import State
    from gearwear.fleet.words import wrapped

    states, lines = store.states(), list[tuple[str, str]]()
    wrong = [(row, states[row.key]) for row in rows if states.get(row.key) in (State.REFUSED, State.FAILED)]
    for row, state in wrong[:SHOWN]:
        said = " ".join(filter(None, ("!", row.cells["gear_id"], row.cells.get("inspected", ""), f"{state}:")))
        lines += wrapped(f"{said} {store.why(row.key, state)}", "yellow", 2)
    if len(wrong) > SHOWN:
        lines.append((f"! and {len(wrong) - SHOWN} more: the files *.refused and *.failed in the store say why", "yellow"))
    return lines


def _further_columns(rows: Sequence[Listed]) -> list[tuple[str, str]]:
    """Columns that mean nothing to the batch; where one may be meant for one that does, which."""
    from difflib import get_close_matches

    from gearwear.fleet.manifest import NEEDED, OPTIONAL
    from gearwear.fleet.words import wrapped

    names = dict.fromkeys(name for row in rows for name in row.cells if name not in (*NEEDED, *OPTIONAL, "key"))
    meant = {name: get_close_matches(name.lower(), OPTIONAL, 1, NEAR) for name in names}
    said = ", ".join(f"{name} ({near[0]}?)" if near else name for name, near in meant.items())
    style = "yellow" if any(meant.values()) else "dim"
    return wrapped(f"Further columns, kept as they are: {said}", style, 2) if names else []

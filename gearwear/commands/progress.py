"""Progress on long work: the station at hand, and about how long is left; nothing where nobody watches."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Tell = Callable[[str], None]
"""Told the name of each station as it begins."""

PATIENCE = 1.0
"""Seconds before anything is shown."""

SHARES = {
    "reading": 0.02, "registration": 0.08, "closing the loop": 0.44, "scan before wear": 0.44, "wear": 0.05, "worn solid": 0.06,
    "meshing": 0.18, "thickness and inspection": 0.04, "report": 0.13,
}  # fmt: skip
"""About what each station takes of a usual run; only for the time left."""


@contextmanager
def stations(quiet: bool = False, verbose: bool = False) -> Iterator[Tell]:
    """Say what is going on while the body runs.

    Parameters
    ----------
    quiet : bool
        Show nothing.
    verbose : bool
        A line with its time for every station, also when piped.

    Yields
    ------
    callable
        To be told the name of each station when it begins.

    Notes
    -----
    On standard error only. The bar appears only on a terminal, once the work has taken `PATIENCE`, and goes when it ends.
    """
    bar = None if quiet or not sys.stderr.isatty() else _bar()
    begun: list[tuple[str, float]] = []

    def end() -> None:
        if verbose and not quiet and begun:
            name, start = begun[-1]
            say_beside(bar, f"{name:<20} {time.perf_counter() - start:7.2f} s")

    def tell(name: str) -> None:
        end()
        begun.append((name, time.perf_counter()))
        if bar is not None:
            bar.update(bar.task_ids[0], description=name, completed=sum(SHARES.get(done, 0.05) for done, _ in begun[:-1]))

    patience = threading.Timer(PATIENCE, bar.start if bar is not None else lambda: None)
    patience.daemon = True
    if bar is not None:
        patience.start()
    try:
        yield tell
        end()
    finally:
        if bar is not None:
            patience.cancel()
            patience.join()
            bar.stop()


def _bar() -> Any:
    from rich.progress import SpinnerColumn, TextColumn

    total = sum(share for name, share in SHARES.items() if name != "scan before wear")
    return bar_behind(SpinnerColumn(), TextColumn("{task.description:<18}"), total=total)


def bar_behind(*columns: Any, total: float) -> Any:
    """A bar of one task on standard error, with the time taken and about left, behind columns of the command's own."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    bar = Progress(
        *columns, BarColumn(bar_width=24), TimeElapsedColumn(), TextColumn("about"), TimeRemainingColumn(compact=True),
        TextColumn("left"), console=Console(stderr=True), transient=True,
    )  # fmt: skip
    bar.add_task("", total=total)
    return bar


def say_beside(bar: Any, line: str) -> None:
    """Write a line to standard error, above the bar where there is one."""
    if bar is None:
        sys.stderr.write(line + "\n")
    else:
        bar.console.print(line, highlight=False)

"""Independent calls on idle processors: forked processes, which begin with all that is in memory and pass back what they find.

Only inside `idle_processors`, which the commands say: a library does not fork the process of whoever imports it, and a worker of a fleet has
one processor. Elsewhere the calls are made one after the other. The results are the same to the last digit: nothing is shared but what they begin with.
"""

from __future__ import annotations

import math
import mmap
import multiprocessing
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from gearwear.arrays import Floats

T = TypeVar("T")

MOST = 4
"""Processes at most: the calls are few."""
TICKET = 2
"""Bytes of a call's number; a pipe holds more of them than there are calls."""

THREADS = "GEARWEAR_THREADS"
"""Environment variable; how many threads the loops of one call may have."""

_allowed: ContextVar[bool] = ContextVar("allowed", default=False)


@contextmanager
def idle_processors() -> Iterator[None]:
    """In the body `each` uses processors that are idle, where they can be forked to: Linux."""
    token = _allowed.set(sys.platform == "linux")
    try:
        yield
    finally:
        _allowed.reset(token)


def threads() -> int:
    """Threads for loops in which numpy releases the interpreter: what `THREADS` says, else one on each processor that the process may run on.

    They wait for each other a quarter of their time: where all processors have work, as with the workers of a fleet, one does more.
    """
    told = os.environ.get(THREADS, "")
    if told.isdecimal() and int(told) > 0:
        return int(told)
    return processors()


def processors() -> int:
    """Processors that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _within_reach() -> int:
    """This processor, and those that the process may run on and that nobody uses now: on one that is shared, a fork only costs."""
    if not _allowed.get():
        return 1
    running = int(Path("/proc/loadavg").read_text(encoding="ascii").split()[3].split("/")[0])  # this process is one of them
    return max(1, min(len(os.sched_getaffinity(0)) + 1 - running, MOST))


def each(calls: Sequence[Callable[[], T]]) -> list[T]:
    """Results of calls that do not depend on each other, in their order.

    Parameters
    ----------
    calls : sequence of callable
        Each may run in another process: what it changes is lost, and what it returns is pickled.
    """
    with _helped(calls, min(_within_reach(), len(calls)) - 1) as results:
        return results()


@contextmanager
def beside(calls: Sequence[Callable[[], T]]) -> Iterator[Callable[[], list[T]]]:
    """Begin calls on idle processors while the body does work of its own, on which they do not depend either.

    Parameters
    ----------
    calls : sequence of callable
        As those of `each`.

    Yields
    ------
    callable
        Makes the calls that no other processor has begun, and returns the results of all, in their order; to be called once.
    """
    with _helped(calls, min(_within_reach() - 1, len(calls))) as results:
        yield results


def room(*shape: int) -> Floats:
    """Zeros (…) that a call of `each` may fill in, whichever process makes it: many numbers are quicker written than passed back."""
    import numpy as np

    held = mmap.mmap(-1, max(8 * math.prod(shape), 1))
    return np.frombuffer(held, dtype=np.float64, count=math.prod(shape)).reshape(shape)


@contextmanager
def _helped(calls: Sequence[Callable[[], T]], number: int) -> Iterator[Callable[[], list[T]]]:
    """What `beside` yields, with so many processes besides this one; they end with the body."""
    if number < 1:
        yield lambda: [call() for call in calls]
        return
    fork = multiprocessing.get_context("fork")
    tickets, issue = os.pipe()
    os.write(issue, b"".join(i.to_bytes(TICKET) for i in range(len(calls))))
    os.close(issue)
    helpers = []
    for _ in range(number):
        ours, theirs = fork.Pipe(duplex=False)
        helper = fork.Process(target=_send, args=(calls, tickets, theirs), daemon=True)
        with suppress(OSError), warnings.catch_warnings():  # no memory for another: then with those there are
            # Python warns of threads: of linear algebra, which is ready for it, and of the progress bar, which a helper leaves alone.
            warnings.simplefilter("ignore", DeprecationWarning)
            helper.start()
            helpers.append((helper, ours))
        theirs.close()

    def results() -> list[T]:
        found = _drawn(calls, tickets)
        for _, ours in helpers:
            with suppress(EOFError):  # it ended without its results
                found |= ours.recv()
        return [found[i] if i in found else call() for i, call in enumerate(calls)]

    try:
        yield results
    finally:
        os.close(tickets)
        for helper, ours in helpers:
            helper.terminate()
            helper.join()
            ours.close()


def _drawn(calls: Sequence[Callable[[], T]], tickets: int) -> dict[int, T]:
    """Results of the calls whose numbers this process draws, until none is left."""
    token, results = _allowed.set(False), dict[int, T]()
    try:
        while ticket := os.read(tickets, TICKET):
            number = int.from_bytes(ticket)
            results[number] = calls[number]()
    finally:
        _allowed.reset(token)
    return results


def _send(calls: Sequence[Callable[[], T]], tickets: int, to: Connection) -> None:
    """What a helper does. It goes with its parent, which alone answers the keyboard, and makes once more the calls of one that fails."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(Exception):
        to.send(_drawn(calls, tickets))

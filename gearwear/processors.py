"""Independent calls on all processors: forked processes, which begin with all that is in memory and pass back what they find.

Only inside `all_processors`, which the commands say: a library does not fork the process of whoever imports it, and a worker of a fleet has
one processor. Elsewhere the calls are made one after the other. The results are the same to the last digit: nothing is shared but what they begin with.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from multiprocessing.connection import Connection
from typing import TypeVar

T = TypeVar("T")

MOST = 4
"""Processes at most: the calls are few."""

_allowed: ContextVar[int] = ContextVar("processors", default=1)


@contextmanager
def all_processors() -> Iterator[None]:
    """In the body `each` uses all processors that the process may run on, where they can be forked to: Linux."""
    token = _allowed.set(len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1)
    try:
        yield
    finally:
        _allowed.reset(token)


def each(calls: Sequence[Callable[[], T]]) -> list[T]:
    """Results of calls that do not depend on each other, in their order.

    Parameters
    ----------
    calls : sequence of callable
        Each may run in another process: what it changes is lost, and what it returns is pickled.
    """
    number = min(_allowed.get(), len(calls), MOST)
    if number < 2:
        return [call() for call in calls]
    fork = multiprocessing.get_context("fork")
    helpers = []
    for first in range(1, number):
        ours, theirs = fork.Pipe(duplex=False)
        helper = fork.Process(target=_send, args=(calls[first::number], theirs), daemon=True)
        helper.start()
        theirs.close()
        helpers.append((helper, ours))
    try:
        shares = [[call() for call in calls[::number]]]
        shares += [_received(calls[first::number], ours) for first, (_, ours) in enumerate(helpers, 1)]
        return [shares[i % number][i // number] for i in range(len(calls))]
    finally:
        for helper, _ in helpers:
            helper.terminate()
            helper.join()


def _send(calls: Sequence[Callable[[], T]], to: Connection) -> None:
    """What a helper does. It goes with its parent, which alone answers the keyboard."""
    _allowed.set(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        to.send([call() for call in calls])
    except Exception:
        to.close()


def _received(calls: Sequence[Callable[[], T]], source: Connection) -> list[T]:
    """A helper's results; where it ended without them the calls are made here, and raise here what they raise."""
    try:
        return list(source.recv())
    except EOFError:
        return [call() for call in calls]

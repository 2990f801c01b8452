"""One process at a time in a folder: a lock that the system takes away when the process ends, however it ends.

On Unix the folder itself is locked; Windows cannot, there a file in it is (`LOCK_FILE`), which goes with the last who needs it.
"""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]
    import msvcrt

LOCK_FILE = ".gearwear.lock"
PATIENCE, PAUSE = 60.0, 0.02
"""Seconds to wait for another run to publish its files, which takes some milliseconds, and between two looks."""
TAKEN = (errno.EACCES, errno.EAGAIN, errno.EDEADLK, errno.EWOULDBLOCK)
"""What a system says of a lock that another one holds; anything else: this file system has no locks."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Be alone in a folder while the body runs; others wait.

    Raises
    ------
    OSError
        If the folder is not there, or another run holds it for longer than `PATIENCE`.

    Notes
    -----
    On a file system without locks the body runs all the same.
    """
    until = time.monotonic() + PATIENCE
    while True:
        with tried(folder) as alone:
            if alone is not False:
                yield
                return
        if time.monotonic() > until:
            raise OSError(errno.EAGAIN, "another run is writing there")
        time.sleep(PAUSE)


@contextmanager
def tried(folder: Path) -> Iterator[bool | None]:
    """Lock a folder if nobody has; True if so, False if another one holds it, None on a file system without locks."""
    number = os.open(folder, os.O_RDONLY) if fcntl else os.open(folder / LOCK_FILE, os.O_RDWR | os.O_CREAT)
    try:
        try:
            _lock(number)
            alone: bool | None = True
        except OSError as error:
            alone = False if error.errno in TAKEN else None
        yield alone
    finally:
        if not fcntl and alone:
            msvcrt.locking(number, msvcrt.LK_UNLCK, 1)  # type: ignore[attr-defined]
        os.close(number)
        if not fcntl and alone:
            with suppress(OSError):  # another one has it open
                (folder / LOCK_FILE).unlink()


def _lock(number: int) -> Any:
    if fcntl:
        return fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return msvcrt.locking(number, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]

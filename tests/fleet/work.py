"""What the workers of the tests do in place of a comparison, told by the row's gear; importable by a process of its own."""

from __future__ import annotations

import os
import time

from gearwear.fleet.keys import Options
from gearwear.fleet.manifest import ManifestRow
from gearwear.fleet.outcome import Outcome, State
from gearwear.fleet.task import Job

LARGE = 1_500_000_000
"""Bytes that a greedy scan takes."""


def job(gear_id: str, memory: float = 4e9) -> Job:
    """A job that needs no file."""
    return Job(f"{gear_id}_key", ManifestRow(line=2, gear_id=gear_id, design="d", scans=("s",)), "/", (), Options(), memory)


def work(given: Job) -> Outcome:
    """Good scans are done; ``dies`` takes its process with it, ``greedy`` more memory than there is."""
    what = given.row.gear_id.rstrip("0123456789")
    if what == "dies":
        time.sleep(0.05)
        os._exit(1)
    if what == "greedy":
        held = bytearray(LARGE)
        for i in range(0, len(held), 4096):
            held[i] = 1
        time.sleep(20.0)  # the nanny looks ten times a second
    if what == "raises":
        raise RuntimeError("a library failed")
    return Outcome(given.key, State.DONE, given.key.encode(), b"table")

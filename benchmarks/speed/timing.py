"""What a call or a command costs: wall time, processor time, peak memory; measured in turn, so that a busy machine is busy for all."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Cost:
    """One measurement.

    Parameters
    ----------
    wall, cpu : float
        Seconds; `cpu` over all threads, user and system.
    peak : float
        Largest resident memory in MB (10⁶ bytes); nan for a call.
    """

    wall: float
    cpu: float
    peak: float = float("nan")

    def __add__(self, other: Cost) -> Cost:
        return Cost(self.wall + other.wall, self.cpu + other.cpu, max(self.peak, other.peak))


def timed(call: Callable[[], Any]) -> tuple[Any, Cost]:
    """The result of a call, and its cost."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = call()
    return result, Cost(time.perf_counter() - wall, time.process_time() - cpu)


def median(costs: Sequence[Cost]) -> Cost:
    """Median of each number."""
    return Cost(*(statistics.median(getattr(cost, name) for cost in costs) for name in ("wall", "cpu", "peak")))


def ratio(slow: Sequence[Cost], fast: Sequence[Cost]) -> tuple[float, float]:
    """How many times `fast` is as fast: the median over the pairs, of wall and of processor time."""
    pairs = list(zip(slow, fast, strict=True))
    return statistics.median(a.wall / b.wall for a, b in pairs), statistics.median(a.cpu / b.cpu for a, b in pairs)


def in_turn(rounds: int, calls: Mapping[str, Callable[[], Any]]) -> dict[str, list[Any]]:
    """Results of calls made in turn, A B A B …; all of them in every round."""
    results: dict[str, list[Any]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            results[name].append(call())
    return results


LAUNCHER = """
import json, os, sys, time
begun = time.perf_counter()
child = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=[(os.POSIX_SPAWN_DUP2, 2, 1)])
_, status, used = os.wait4(child, 0)
wall = time.perf_counter() - begun
print(json.dumps([os.waitstatus_to_exitcode(status), wall, used.ru_utime + used.ru_stime, used.ru_maxrss]))
"""
"""Starts a command and waits. A process of its own: a command's peak memory counts from its parent's, which must be small."""


def command(arguments: Sequence[str], **environment: str) -> tuple[str, Cost]:
    """What a command prints, and what it costs from start to end.

    Raises
    ------
    RuntimeError
        If it fails.
    """
    start = [sys.executable, "-I", "-S", "-c", LAUNCHER, *arguments]
    done = subprocess.run(start, capture_output=True, text=True, env=os.environ | environment, check=False)
    code, wall, cpu, peak = json.loads(done.stdout or "[1, 0, 0, 0]")
    if code != 0:
        raise RuntimeError(f"{' '.join(arguments)} ended with {code}: {done.stderr[-2000:]}")
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return done.stderr, Cost(wall, cpu, peak * unit / 1e6)

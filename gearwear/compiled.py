"""The one switch between NumPy, the default and the reference, and compiled loops of the same formulas: numba, by the extra `[fast]`.

Compiled are the two steps that every point of a scan goes through: `design.surface.locate` puts it on the design, `placing.cells.CellGrid.index` and
`placing.sums.CellSums` into a cell. Each looks here, so that a scan held in memory and a streamed one go the same way. Which way a call goes
depends on the number of its points alone, not on what the process did before: results are the same to the last digit in every worker.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib.util import find_spec
from typing import Any

from gearwear.arrays import Floats

SWITCH = "GEARWEAR_COMPILED"
"""Environment variable; 0 turns the compiled loops off."""
LEAST = 500_000
"""Points from which on a call is compiled: to import numba and load what it compiled before takes half a second, as much as is gained there."""
PART = 1 << 16
"""Points that a streamed chunk is divided into, where its loops are compiled: what is worked out of them stays in the cache."""

_whole: ContextVar[int] = ContextVar("_whole", default=0)


def available() -> bool:
    """Whether there are compiled loops: numba is installed, and nobody turned them off."""
    return os.environ.get(SWITCH, "1") != "0" and _installed()


@cache
def _installed() -> bool:
    return find_spec("numba") is not None


def pays(points: int) -> bool:
    """Whether a call with so many points, or the whole that it is a part of, is worth them."""
    return max(points, _whole.get()) >= LEAST and available()


@contextmanager
def parts_of(points: int) -> Iterator[None]:
    """In the body every call goes the way that one with so many points would: it is a part of that."""
    token = _whole.set(points)
    try:
        yield
    finally:
        _whole.reset(token)


def parts(points: Floats) -> Iterator[Floats]:
    """Points (n, 3) in parts of at most `PART` where they are worth compiled loops, else whole: numpy is quicker with many at once."""
    if not pays(len(points)):
        yield points
        return
    for start in range(0, len(points), PART):
        yield points[start : start + PART]


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function at its first call, or load it from numba's cache; where nothing can be written, compile it in every process.

    Of `fastmath` only that a product and a sum may become one operation, rounded once; no sum is reordered, and what is no number stays so. It lets other threads run, starts none, and survives a fork.
    Without numba the function stays as it is, and nobody calls it.
    """
    try:
        return _jit(function, cache=True)
    except RuntimeError:  # numba found no folder that it may write to
        return _jit(function)


def step(function: Callable[..., Any]) -> Any:
    """A part of a kernel: compiled with it, and called from nowhere else."""
    return _jit(function, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def formula(function: Callable[..., Any]) -> Any:
    """What a kernel does for a single point: compiled into its loop, without which that is no vector loop."""
    return _jit(function, forceinline=True)


def _jit(function: Callable[..., Any], **options: bool) -> Any:
    if not _installed():
        return function
    from numba import njit

    return njit(nogil=True, error_model="numpy", fastmath={"contract"}, **options)(function)

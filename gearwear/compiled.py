"""The one switch between NumPy, the default and the reference, and compiled loops of the same formulas: numba, by the extra `[fast]`.

Compiled are the two steps that every point of a scan goes through: `design.surface.locate` puts it on the design, `placing.cells.CellGrid.index` and
`placing.sums.CellSums` into a cell. Each looks here, so that a scan held in memory and a streamed one go the same way. Which way a call goes
depends on the number of its points alone, not on what the process did before: results are the same to the last digit in every worker.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

SWITCH = "GEARWEAR_COMPILED"
"""Environment variable; 0 turns the compiled loops off."""
LEAST = 200_000
"""Points from which on a call is compiled: to import numba and load what it compiled before takes half a second."""


def available() -> bool:
    """Whether there are compiled loops: numba is installed, and nobody turned them off."""
    return os.environ.get(SWITCH, "1") != "0" and find_spec("numba") is not None


def pays(points: int) -> bool:
    """Whether a call with so many points is worth them."""
    return points >= LEAST and available()


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function at its first call, or load it from numba's cache; where nothing can be written, compile it in every process.

    Without `fastmath`: every operation is rounded as written, no sum is reordered. It lets other threads run, starts none, and survives a fork.
    """
    from numba import njit

    try:
        return njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # numba found no folder that it may write to
        return njit(nogil=True, error_model="numpy")(function)


def formula(function: Callable[..., Any]) -> Any:
    """What a kernel does for a single point: compiled into its loop, without which that is no vector loop."""
    from numba import njit

    return njit(nogil=True, error_model="numpy", forceinline=True)(function)

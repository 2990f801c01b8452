"""One thread for linear algebra: the matrices here are narrow, and the threads of BLAS would mostly wait for each other."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """The function, with one thread for BLAS while it runs.

    Sums are then formed in one order, so that the result does not depend on the number of threads to the last digit. What the process
    had before is put back. Functions limited in this way may call each other.
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited


@cache
def _libraries(with_scipy: bool) -> ThreadpoolController:
    """What there is to limit: to look for it takes a millisecond and more, so it is done once, and again when scipy has brought its own."""
    return ThreadpoolController()

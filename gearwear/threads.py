"""One thread for linear algebra: the matrices here are narrow, and the threads of BLAS would mostly wait for each other."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

P = ParamSpec("P")
R = TypeVar("R")

_limited: ContextVar[bool] = ContextVar("limited", default=False)
"""Whether a function that is limited is running already: to ask the libraries again takes 5 ms a call."""


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """The function, with one thread for BLAS while it runs.

    Sums are then formed in one order, so that the result does not depend on the number of threads to the last digit. What the process
    had before is put back. Functions limited in this way may call each other.
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        if _limited.get():
            return function(*args, **kwargs)
        with threadpool_limits(limits=1, user_api="blas"):
            token = _limited.set(True)
            try:
                return function(*args, **kwargs)
            finally:
                _limited.reset(token)

    return limited

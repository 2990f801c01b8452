"""Calls on all processors: the same as one after the other, whatever becomes of a helper."""

from __future__ import annotations

import os
import sys
from functools import partial

import numpy as np
import pytest

from gearwear import processors
from gearwear.errors import InputError
from gearwear.processors import all_processors, each

on_linux = pytest.mark.skipif(sys.platform != "linux", reason="helpers are forked on Linux alone")


@pytest.fixture
def three(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 1, 2})


def pids(count: int) -> list[int]:
    return each([os.getpid] * count)


def test_a_library_forks_nothing() -> None:
    assert set(pids(5)) == {os.getpid()}


@on_linux
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
class TestHelpers:
    def test_as_many_as_processors_and_calls(self, three: None) -> None:
        with all_processors():
            assert [len(set(pids(count))) for count in (0, 1, 2, 3, 7)] == [0, 1, 2, 3, 3]
            assert os.getpid() in pids(7)
        assert set(pids(7)) == {os.getpid()}

    @pytest.mark.parametrize("count", [1, 2, 3, 4, 8])
    def test_results_are_in_the_order_of_the_calls(self, three: None, count: int) -> None:
        calls = [partial(np.full, 40_000, i) for i in range(count)]  # more than a pipe holds at once
        with all_processors():
            assert [result[0] for result in each(calls)] == list(range(count))

    def test_helpers_fork_no_further(self, three: None) -> None:
        with all_processors():
            assert all(len(set(inner)) == 1 for inner in each([partial(pids, 3)] * 3)[1:])

    def test_what_a_helper_raises_is_raised(self, three: None) -> None:
        def refuse() -> None:
            raise InputError("scan.ply: is empty")

        with all_processors(), pytest.raises(InputError, match=r"scan\.ply: is empty"):
            each([lambda: None, refuse, lambda: None])

    def test_a_helper_that_dies_costs_time_alone(self, three: None) -> None:
        here = os.getpid()

        def mortal(value: int) -> int:
            if os.getpid() != here:
                os._exit(9)
            return value

        with all_processors():
            assert each([partial(mortal, i) for i in range(6)]) == list(range(6))

    def test_no_helper_outlives_the_calls(self, three: None) -> None:
        with all_processors():
            before = set(pids(6)) - {os.getpid()}
        for pid in before:
            with pytest.raises(ProcessLookupError):
                os.kill(pid, 0)


def test_one_processor_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processors, "sys", type("Mac", (), {"platform": "darwin"}))
    with all_processors():
        assert set(pids(4)) == {os.getpid()}

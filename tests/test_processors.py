"""Calls on idle processors: the same as one after the other, whatever becomes of a helper."""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import gearwear as gw
from gearwear import processors
from gearwear.design import surface
from gearwear.design.profiles import nominal_profiles
from gearwear.errors import InputError
from gearwear.meshing import tooth_pair
from gearwear.meshing.contact import mesh_contact
from gearwear.processors import _within_reach, beside, each, idle_processors, room

on_linux = pytest.mark.skipif(sys.platform != "linux", reason="helpers are forked on Linux alone")


def with_processors(monkeypatch: pytest.MonkeyPatch, processors: int, running: int) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: set(range(processors)))
    monkeypatch.setattr(Path, "read_text", lambda path, encoding: f"0.20 0.18 0.12 {running}/80 11206\n")


@pytest.fixture
def three(monkeypatch: pytest.MonkeyPatch) -> None:
    with_processors(monkeypatch, 3, 1)


def pids(count: int) -> list[int]:
    return each([os.getpid] * count)


def test_a_library_forks_nothing() -> None:
    assert set(pids(5)) == {os.getpid()}


@on_linux
class TestHelpers:
    def test_what_they_write_into_a_room_is_there(self, three: None) -> None:
        written = room(4, 2)
        assert not written.any() and room(0, 3).shape == (0, 3)

        def write(at: int) -> int:
            written[at] = at, os.getpid()
            time.sleep(0.05)  # so that every helper has some
            return os.getpid()

        with idle_processors():
            by = each([partial(write, at) for at in range(4)])
        np.testing.assert_array_equal(written, np.column_stack([np.arange(4), by]))
        assert len(set(by)) > 1

    @pytest.mark.parametrize("count", [2, 3])
    def test_calls_run_at_the_same_time(self, three: None, count: int) -> None:
        together = multiprocessing.get_context("fork").Barrier(count, timeout=60)

        def meet() -> int:
            together.wait()  # each is held until all have come
            return os.getpid()

        with idle_processors():
            assert len(set(each([meet] * count))) == count

    def test_there_are_no_more_than_processors(self, three: None) -> None:
        with idle_processors():
            assert pids(0) == []
            assert pids(1) == [os.getpid()]
            assert len(set(pids(50))) <= 3
        assert set(pids(50)) == {os.getpid()}

    @pytest.mark.parametrize(("processors", "running", "most"), [(8, 1, 4), (8, 6, 3), (8, 8, 1), (2, 9, 1), (1, 1, 1)])
    def test_what_others_use_is_left_to_them(
        self, monkeypatch: pytest.MonkeyPatch, processors: int, running: int, most: int
    ) -> None:
        with_processors(monkeypatch, processors, running)
        with idle_processors():
            assert _within_reach() == most

    @pytest.mark.parametrize("count", [1, 2, 3, 4, 8])
    def test_results_are_in_the_order_of_the_calls(self, three: None, count: int) -> None:
        calls = [partial(np.full, 40_000, i) for i in range(count)]  # more than a pipe holds at once
        with idle_processors():
            assert [result[0] for result in each(calls)] == list(range(count))

    def test_helpers_fork_no_further(self, three: None) -> None:
        with idle_processors():
            assert all(len(set(inner)) == 1 for inner in each([partial(pids, 3)] * 3))

    def test_what_a_helper_raises_is_raised(self, three: None) -> None:
        def refuse() -> None:
            raise InputError("scan.ply: is empty")

        with idle_processors(), pytest.raises(InputError, match=r"scan\.ply: is empty"):
            each([lambda: None, refuse, lambda: None])

    def test_a_helper_that_dies_costs_time_alone(self, three: None) -> None:
        here = os.getpid()

        def mortal(value: int) -> int:
            if os.getpid() != here:
                os._exit(9)
            return value

        with idle_processors():
            assert each([partial(mortal, i) for i in range(6)]) == list(range(6))

    def test_without_memory_for_a_helper_the_calls_are_made_here(self, three: None, monkeypatch: pytest.MonkeyPatch) -> None:
        def refuse() -> int:
            raise OSError(12, "Cannot allocate memory")

        monkeypatch.setattr(os, "fork", refuse)
        with idle_processors():
            assert set(pids(5)) == {os.getpid()}

    def test_no_helper_outlives_the_calls(self, three: None) -> None:
        with idle_processors():
            before = set(pids(6)) - {os.getpid()}
        for pid in before:
            with pytest.raises(ProcessLookupError):
                os.kill(pid, 0)


@on_linux
class TestBeside:
    def test_calls_are_made_while_the_body_works(self, three: None) -> None:
        begun = multiprocessing.get_context("fork").Event()

        def say() -> int:
            begun.set()
            return os.getpid()

        with idle_processors(), beside([say]) as results:
            assert begun.wait(60)
            assert results() != [os.getpid()]

    def test_what_nobody_has_begun_is_made_here_and_all_is_in_order(self, three: None) -> None:
        hold = multiprocessing.get_context("fork").Barrier(3, timeout=60)

        def wait(value: int) -> tuple[int, int]:
            if value < 3:
                hold.wait()  # both helpers and this process have one each of the first three
            return value, os.getpid()

        with idle_processors(), beside([partial(wait, i) for i in range(5)]) as results:
            found = results()
        assert [value for value, _ in found] == list(range(5)) and os.getpid() in {pid for _, pid in found[:3]}

    def test_a_body_that_fails_ends_the_helpers(self, three: None) -> None:
        ours, theirs = multiprocessing.get_context("fork").Pipe()

        def stay() -> None:
            theirs.send(os.getpid())
            time.sleep(600)

        with idle_processors(), pytest.raises(InputError, match="no gear"), beside([stay]):
            assert ours.poll(60)
            raise InputError("no gear")
        with pytest.raises(ProcessLookupError):
            os.kill(ours.recv(), 0)


def test_without_helpers_calls_beside_are_made_when_they_are_asked_for() -> None:
    made = list[int]()
    with beside([partial(made.append, 1)]) as results:
        assert not made
        assert results() == [None]
    assert made == [1]


def test_one_processor_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processors, "sys", type("Mac", (), {"platform": "darwin"}))
    with idle_processors():
        assert set(pids(4)) == {os.getpid()}


def threads_started(monkeypatch: pytest.MonkeyPatch, told: str) -> tuple[list[int], bytes]:
    """How many threads a contact and a scan take where the environment says so, and the contact's curve."""
    started = list[int]()

    class Counted(ThreadPoolExecutor):
        def __init__(self, number: int) -> None:
            started.append(number)
            super().__init__(number)

    monkeypatch.setenv(processors.THREADS, told)
    monkeypatch.setattr(tooth_pair, "ThreadPoolExecutor", Counted)
    monkeypatch.setattr(surface, "ThreadPoolExecutor", Counted)
    pair = gw.read_design(gw.example())
    pinion, gear = (nominal_profiles(one, z=np.linspace(0.0, 15.0, 60)) for one in pair.gears.values())
    surface.locate(np.full((surface.CHUNK * surface.WORTH_THREADS, 3), [38.0, 0.0, 7.0]), pinion.gear)
    return started, mesh_contact(pinion, gear, pair.centre_distance, cycle="pitch").transmission_error.tobytes()


def test_threads_are_as_many_as_is_said_and_one_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    one, three = (threads_started(monkeypatch, told) for told in ("1", "3"))
    assert one[0] == [] and len(three[0]) > 1 and set(three[0]) == {3}
    assert one[1] == three[1]
    for nothing in ("", "0", "many", "-2"):
        monkeypatch.setenv(processors.THREADS, nothing)
        assert processors.threads() == len(os.sched_getaffinity(0))

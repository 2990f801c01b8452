"""Dask's workers: who dies on a scan takes that one along and no other, and the reports are the same whoever writes them."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys
import warnings
from contextlib import ExitStack, contextmanager
from functools import partial
from importlib.util import find_spec

import pytest

from gearwear import processors
from gearwear.errors import InputError
from gearwear.fleet.batch import run_batch
from gearwear.fleet.cluster import local_workers, outcomes
from gearwear.fleet.keys import Options
from gearwear.fleet.outcome import State
from gearwear.fleet.store import Store
from gearwear.fleet.task import run
from tests.commands.doors import ROOT
from tests.commands.doors import run as command
from tests.fleet.fleets import contents, sections
from tests.fleet.work import job, work

if find_spec("distributed") is None:  # loaded where it is used: every process that collects this file would take half a second
    pytest.skip("needs the extra batch", allow_module_level=True)

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),  # Dask's own sockets and loops
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    """Worker processes find the package and the tests as this process does."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


@pytest.mark.long
def test_who_dies_on_a_scan_takes_that_one_alone(monkeypatch):
    """Two processes of one thread; one scan ends its process each time, one takes more memory than a worker has, one raises."""
    monkeypatch.setenv(processors.THREADS, "3")
    jobs = [job(name, memory=8e8) for name in ("good1", "dies", "good2", "greedy", "good3", "raises", "good4", "good5")]
    with local_workers(2, 8e8) as client:
        assert list(client.run(processors.threads).values()) == [1, 1]
        found = {one.key: one for one in outcomes(client, jobs, work)}
    assert len(found) == len(jobs)
    assert {key for key, one in found.items() if one.state is State.DONE} == {f"good{i}_key" for i in range(1, 6)}
    assert all(found[f"good{i}_key"].report == f"good{i}_key".encode() for i in range(1, 6))
    wrong = {key: one for key, one in found.items() if one.state is State.FAILED}
    assert set(wrong) == {"dies_key", "greedy_key", "raises_key"}
    assert "the worker that took it died" in wrong["dies_key"].why
    assert "took more memory than a worker has, 0.8 GB" in wrong["greedy_key"].why
    assert wrong["raises_key"].why == "RuntimeError: a library failed"


@contextmanager
def threads(number):
    """A client whose workers are so many threads of this process."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import distributed

        with distributed.Client(
            processes=False, n_workers=number, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as client:
            yield client


@pytest.mark.parametrize("numbers", [(0, 2), pytest.param((0, 1, 2, 4), marks=pytest.mark.long)], ids=["two", "any"])
def test_reports_are_the_same_for_any_number_of_workers(tmp_path, numbers):
    """Workers as threads, which cost no start; processes below, and in benchmarks/fleet."""
    manifest, found = sections(tmp_path, 2), []
    for number in numbers:

        @contextmanager
        def crew(jobs, number=number):
            if not number:
                yield map(run, jobs)
                return
            with threads(number) as client:
                yield outcomes(client, jobs)

        tally = run_batch(manifest, Store(tmp_path / f"{number}"), crew, Options(), 4e9, lambda *told: None)
        assert (tally.done, tally.refused) == (2, 1)
        found.append(contents(tmp_path / f"{number}"))
    assert len(found[0]) == 5
    assert all(one == found[0] for one in found)


@contextmanager
def process(*arguments: str):
    """A part of a cluster as its user starts it; its standard error line by line."""
    command_line = [sys.executable, "-m", *arguments]
    with subprocess.Popen(
        command_line, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"}
    ) as started:
        try:
            yield started
        finally:
            started.terminate()
            started.wait(20)


@pytest.mark.long
def test_a_scheduler_and_two_workers_that_run_already(tmp_path):
    """As on a cluster: dask scheduler, two dask workers, and the command with the address."""
    manifest = sections(tmp_path)
    options = ("--no-dashboard", "--host", "127.0.0.1")
    with process("distributed.cli.dask_scheduler", *options, "--port", "0") as scheduler, ExitStack() as workers:
        lines = iter(partial(scheduler.stderr.readline), "")
        address = next(match[0] for line in lines if (match := re.search(r"tcp://[\d.:]+", line)))
        for name in ("one", "two"):
            folder = ("--local-directory", str(tmp_path / name))
            workers.enter_context(
                process("distributed.cli.dask_worker", address, *options, "--no-nanny", "--nthreads", "1", *folder)
            )
        said = command("batch", manifest, "--out", tmp_path / "store", "--scheduler", address)
    assert (said.status, said.err) == (0, "")
    assert said.out.startswith("3 scans: 2 done, 1 refused, 0 failed")
    command("batch", manifest, "--out", tmp_path / "here", "--workers", "0")
    assert contents(tmp_path / "store") == contents(tmp_path / "here")


def test_where_no_scheduler_answers(tmp_path, monkeypatch):
    monkeypatch.setattr("gearwear.fleet.cluster.ANSWER", 0.2)
    said = command("batch", sections(tmp_path, 1), "--out", tmp_path / "store", "--scheduler", "tcp://127.0.0.1:1")
    assert said.status == 2
    assert "scheduler = tcp://127.0.0.1:1: no Dask scheduler answers" in said.err
    assert said.err.count("\n") == 1


def refused(*arguments, **more):
    """What a scheduler does that is gone."""
    raise ConnectionRefusedError(errno.ECONNREFUSED, "Connection refused")


@pytest.mark.parametrize("call", ["nthreads", "submit"])
def test_a_scheduler_that_refuses_midway_is_told_as_such_and_not_as_a_full_disk(tmp_path, monkeypatch, call):
    @contextmanager
    def crew(jobs):
        with threads(1) as client, monkeypatch.context() as patched:
            patched.setattr(client, call, refused)
            yield outcomes(client, jobs)

    with pytest.raises(InputError) as caught:
        run_batch(sections(tmp_path, 1), Store(tmp_path / "store"), crew, Options(), 4e9, lambda *told: None)
    assert re.match(
        r"scheduler = \w+://\S+: the Dask scheduler is gone; what was done is in the store, and the same batch", str(caught.value)
    )


def test_a_scheduler_that_is_gone_before_it_says_its_workers(tmp_path, monkeypatch):
    class Client:
        def __init__(self, address, timeout): ...

        def __enter__(self):
            return self

        def __exit__(self, *error): ...

        get_versions = refused

    monkeypatch.setattr("distributed.Client", Client)
    said = command("batch", sections(tmp_path, 1), "--out", tmp_path / "store", "--scheduler", "tcp://10.0.0.5:8786")
    assert said.status == 2
    assert (
        f"scheduler = tcp://10.0.0.5:8786: no Dask scheduler answers ([Errno {errno.ECONNREFUSED}] Connection refused)"
        in said.err
    )
    assert said.err.count("\n") == 1


def test_workers_that_cannot_be_started(tmp_path, monkeypatch):
    monkeypatch.setattr("distributed.LocalCluster", refused)
    said = command("batch", sections(tmp_path, 1), "--out", tmp_path / "store", "--workers", "2")
    assert said.status == 2
    assert (
        f"workers = 2: cannot be started ([Errno {errno.ECONNREFUSED}] Connection refused); fewer, or 0 for none beside this process, would"
        in said.err
    )
    assert said.err.count("\n") == 1

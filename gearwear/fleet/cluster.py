"""Workers for the scans of a fleet: Dask's, on this machine or on a cluster that is there already."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING

import gearwear
from gearwear.errors import InputError
from gearwear.fleet.outcome import Outcome, State
from gearwear.fleet.tables import needs
from gearwear.fleet.task import Job, run
from gearwear.memory import GB
from gearwear.processors import THREADS

if TYPE_CHECKING:
    from distributed import Client

Work = Callable[[Job], Outcome]
ANSWER = 10.0
"""Seconds within which a scheduler must answer."""
OVER = "worker-restart-memory"
"""What a scheduler notes of a worker that was ended for its memory."""


@contextmanager
def local_workers(number: int, memory: float) -> Iterator[Client]:
    """Worker processes on this machine, each with one thread, ended with the block.

    Parameters
    ----------
    number : int
        At least 1.
    memory : float
        Bytes that each may take; one that takes more is ended, and its scan with it.

    Yields
    ------
    distributed.Client

    Raises
    ------
    InputError
        If Dask is not installed, or the processes cannot be started.
    """
    try:
        from dask import config
        from distributed import Client, LocalCluster
    except ImportError:
        raise needs("dask[distributed]") from None
    with ExitStack() as held:
        # Data is not what fills them.
        held.enter_context(config.set({f"distributed.worker.memory.{step}": False for step in ("target", "spill", "pause")}))
        try:
            cluster = held.enter_context(
                LocalCluster(
                    n_workers=number,
                    threads_per_worker=1,
                    env={THREADS: "1"},
                    processes=True,
                    memory_limit=int(memory),
                    scheduler_kwargs={"allowed_failures": 0},  # `outcomes` tries a scan whose worker died once more
                    dashboard_address=":0",
                    silence_logs=logging.CRITICAL,
                )
            )
            client = held.enter_context(Client(cluster))
        except OSError as error:
            raise InputError(
                f"workers = {number}: cannot be started ({_reason(error)}); fewer, or 0 for none beside this process, would be right"
            ) from None
        yield client


@contextmanager
def remote_workers(address: str) -> Iterator[Client]:
    """The workers of a scheduler that runs already.

    Parameters
    ----------
    address : str
        Such as ``tcp://10.0.0.5:8786``.

    Yields
    ------
    distributed.Client

    Raises
    ------
    InputError
        If Dask is not installed, nobody answers there, or a worker has another version of this package.
    """
    try:
        from distributed import Client
    except ImportError:
        raise needs("dask[distributed]") from None
    for name in ("distributed", "distributed.client"):  # Dask gives the client's a level of its own
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with ExitStack() as held:
        try:
            client = held.enter_context(Client(address, timeout=ANSWER))
            workers = client.get_versions(packages=["gearwear"])["workers"]
        except (OSError, ValueError) as error:
            raise InputError(
                f"scheduler = {address}: no Dask scheduler answers ({_reason(error)}); the address that dask scheduler printed, such as tcp://10.0.0.5:8786, would be right"
            ) from None
        for worker, about in workers.items():
            its_version = about["packages"].get("gearwear")
            if its_version != gearwear.__version__:
                raise InputError(
                    f"scheduler = {address}: worker {worker} has {f'gearwear {its_version}' if its_version else 'no gearwear'}; {gearwear.__version__} as here would be right"
                )
        yield client


def _reason(error: Exception) -> str:
    """What an error says, in one line."""
    return next(iter(str(error).splitlines()), type(error).__name__)[:200]


@contextmanager
def _answering(client: Client) -> Iterator[None]:
    """Round what is asked of a scheduler: one that refuses is told as gone."""
    try:
        yield
    except OSError:
        raise _gone(client) from None


def _gone(client: Client) -> InputError:
    """What is said of a scheduler that does not answer any more."""
    address = getattr(client.scheduler, "address", "")
    return InputError(
        f"scheduler = {address}: the Dask scheduler is gone; what was done is in the store, and the same batch goes on from there"
    )


def dashboard(client: Client) -> str:
    """Address of the page that shows the workers at work; "" where there is none: it is drawn by bokeh."""
    with _answering(client):
        serves = "dashboard" in client.scheduler_info().get("services", {}) and find_spec("bokeh") is not None
        return str(client.dashboard_link) if serves else ""


def outcomes(client: Client, jobs: Sequence[Job], work: Work = run) -> Iterator[Outcome]:
    """What becomes of scans, in the order in which they end.

    Parameters
    ----------
    client : distributed.Client
    jobs : sequence of Job
    work : callable
        What a worker does with each.

    Raises
    ------
    InputError
        If the scheduler goes away. What was yielded before is good.

    Notes
    -----
    No more scans are under way than the workers have threads. A worker that dies takes all of its scans with it, and which of them killed
    it cannot be seen. So they are tried once more at the end, each alone: then a scan whose worker dies has killed it.
    """
    suspects: list[Job] = []
    with _answering(client):  # what fails where an outcome goes to does not come back here
        for job, outcome in _sent(client, jobs, work, math.inf):
            if outcome is None:
                suspects.append(job)
            else:
                yield outcome
        for suspect in suspects:
            ended = len(client.get_events(OVER))
            for job, outcome in _sent(client, [suspect], work, 1):
                yield outcome or Outcome(job.key, State.FAILED, why=_died(job, len(client.get_events(OVER)) > ended))


def _sent(client: Client, jobs: Iterable[Job], work: Work, most: float) -> Iterator[tuple[Job, Outcome | None]]:
    """Each job with what became of it; None where its worker died. At most `most` are under way, and as many as there are threads."""
    from distributed import Future, KilledWorker, as_completed

    waiting, under_way = iter(jobs), dict[Future, Job]()
    finished = as_completed()

    def send() -> None:
        room = int(min(max(sum(client.nthreads().values()), 1), most)) - len(under_way)
        for job in islice(waiting, max(room, 0)):
            future = client.submit(work, job, pure=False, retries=0)
            under_way[future] = job
            finished.add(future)

    send()
    for future in finished:
        job = under_way.pop(future)
        if future.status in ("cancelled", "lost"):
            raise _gone(client)
        error = future.exception() if future.status == "error" else None
        if isinstance(error, KilledWorker):
            yield job, None
        elif error is not None:
            yield job, Outcome(job.key, State.FAILED, why=f"{type(error).__name__}: {error}")
        else:
            yield job, future.result()
        send()


def _died(job: Job, for_memory: bool) -> str:
    """Why a scan that was tried alone has lost its worker."""
    if for_memory:
        return f"took more memory than a worker has, {job.memory / GB:g} GB, and was ended; --memory with more would be right"
    return "the worker that took it died each time: it was killed, or a library failed"

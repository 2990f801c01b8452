"""A set of files is published as one, whatever happens meanwhile: errors, signals, kills, a full disk, another run."""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from gearwear.errors import InputError
from gearwear.report.files import locking
from gearwear.report.files.writing import output_folder, write_file
from gearwear.report.write import write_results
from tests.report.fake import real_results

NAMES = [f"{i}.txt" for i in range(8)]
ROOT = Path(__file__).resolve().parents[2]
FORK = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def publish(out: Path, stamp: str, names: list[str] = NAMES) -> None:
    with output_folder(out) as stage:
        for name in names:
            (stage / name).write_text(stamp)


def contents(out: Path) -> dict[str, str]:
    """All that is there, hidden files too."""
    return {path.name: path.read_text() if path.is_file() else "a folder" for path in out.iterdir()}


def in_a_process(body: Callable[[], None]) -> int:
    """How a process of its own ends: its exit status, or minus the signal."""
    child = os.fork()
    if child == 0:
        try:
            body()
        except BaseException:
            os._exit(1)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt(), RuntimeError()])
@pytest.mark.parametrize("at", range(2 * len(NAMES)))
def test_an_error_at_any_move_leaves_the_earlier_set(tmp_path, monkeypatch, at, error):
    publish(tmp_path, "old")
    real, calls = os.replace, iter(range(1000))

    def replace(a: Path, b: Path) -> None:
        if next(calls) == at:
            raise error
        real(a, b)

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises((InputError, KeyboardInterrupt, RuntimeError)):
        publish(tmp_path, "new", [*NAMES, "more.txt"])
    assert contents(tmp_path) == dict.fromkeys(NAMES, "old")


@FORK
@pytest.mark.parametrize("at", range(2 * len(NAMES) + 1))
def test_a_kill_at_any_move_leaves_one_set_or_the_other(tmp_path, monkeypatch, at):
    """What the next run finds is finished by it; a run that fails itself does so too."""
    publish(tmp_path, "old")
    real, calls = os.replace, iter(range(1000))

    def replace(a: Path, b: Path) -> None:
        if next(calls) == at:
            os.kill(os.getpid(), signal.SIGKILL)
        real(a, b)

    def body() -> None:
        os.replace = replace  # type: ignore[assignment]
        publish(tmp_path, "new", [*NAMES, "more.txt"])

    assert in_a_process(body) == -signal.SIGKILL
    with pytest.raises(ZeroDivisionError), output_folder(tmp_path):
        raise ZeroDivisionError
    assert contents(tmp_path) == dict.fromkeys([*NAMES, "more.txt"], "new")


@FORK
def test_a_run_that_was_killed_while_it_wrote_is_swept_and_one_that_runs_is_not(tmp_path):
    def body() -> None:
        with output_folder(tmp_path) as stage:
            (stage / "0.txt").write_text("half")
            os.kill(os.getpid(), signal.SIGKILL)

    assert in_a_process(body) == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    with output_folder(tmp_path) as alive:
        (alive / "0.txt").write_text("first")
        assert not left.exists()
        publish(tmp_path, "second")
        assert (alive / "0.txt").exists()
    assert contents(tmp_path) == {**dict.fromkeys(NAMES, "second"), "0.txt": "first"}


@FORK
def test_runs_into_one_folder_do_not_mix(tmp_path):
    """Five processes publish twenty sets each; whoever looks while it holds the folder sees one of them."""
    folder, begun = tmp_path / "out", [tmp_path / str(number) for number in range(5)]
    folder.mkdir()
    publish(folder, "begun")

    def body(number: int) -> Callable[[], None]:
        def run() -> None:
            begun[number].touch()
            for i in range(20):
                publish(folder, f"{number}.{i}")

        return run

    threads = [threading.Thread(target=in_a_process, args=(body(number),)) for number in range(5)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads) and not all(
        path.exists() for path in begun
    ):  # a process forked while the folder is held would hold it too
        time.sleep(0.002)
    seen = set()
    while any(thread.is_alive() for thread in threads):
        with locking.locked(folder):
            (stamp,) = {(folder / name).read_text() for name in NAMES}
        seen.add(stamp)
        time.sleep(0.002)
    for thread in threads:
        thread.join()
    assert len(seen) > 1
    assert len(set(contents(folder).values())) == 1


@FORK
@pytest.mark.parametrize("command", ["meshing", "models one.toml"])
@pytest.mark.parametrize("room", [0, 1, 1000, 30_000])
def test_no_room_for_a_file_of_more_than_so_many_bytes(tmp_path, command, room):
    """The system refuses every byte beyond; the earlier files stay as they were."""
    resource = pytest.importorskip("resource")
    import gearwear.brep.step  # noqa: F401 - what it loads makes files of its own
    from gearwear.cli import main

    (tmp_path / "one.toml").write_text("[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\n")
    out = tmp_path / "out"
    out.mkdir()
    earlier = {name: f"earlier {name}" for name in ("meshing.json", "meshing.csv", "gear.step", "mine.txt")}
    for name, text in earlier.items():
        (out / name).write_text(text)
    words = command.replace("one.toml", str(tmp_path / "one.toml")).split()
    reading, writing = os.pipe()

    def body() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        os.dup2(writing, 1)
        os.dup2(writing, 2)
        sys.stderr = os.fdopen(2, "w")
        sys.stdout = os.fdopen(1, "w")
        sys.dont_write_bytecode = True  # of a module that changed, cut off: no later run could load it
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
        status = main([*words, "--out", str(out)])
        sys.stderr.flush()
        os._exit(status)

    status = in_a_process(body)
    os.close(writing)
    with os.fdopen(reading) as stream:
        line = stream.read()
    assert status == 2
    assert line.count("\n") == 1 and "cannot be written" in line
    assert contents(out) == earlier


@pytest.mark.long
@FORK
def test_no_room_for_the_last_byte_of_any_file_of_a_comparison(tmp_path):
    """Each in turn is the one that does not fit; the page once, with the largest of all."""
    resource = pytest.importorskip("resource")
    results = real_results()
    results = replace(results, notes=(*results.notes, "x" * 1_000_000))  # the page is the largest then
    write_results(results, tmp_path / "whole")
    sizes = {path.name: path.stat().st_size for path in (tmp_path / "whole").iterdir()}
    out = tmp_path / "out"
    publish(out, "earlier", list(sizes))
    page = sizes.pop("report.html")

    def body(room: int) -> Callable[[], None]:
        def run() -> None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            sys.dont_write_bytecode = True  # of a module that changed, cut off: no later run could load it
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
            try:
                write_results(results, out, page=room == page - 1)
            except InputError as error:
                os._exit(2 if "cannot be written" in str(error) else 3)

        return run

    assert page > max(sizes.values())
    for room in sorted({0, 1, 1000, page - 1, *(size - 1 for size in sizes.values())}):
        assert in_a_process(body(room)) == 2, room
        assert contents(out) == dict.fromkeys([*sizes, "report.html"], "earlier")


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="a process is not asked to end there, it is ended")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT", "SIGHUP"])
def test_a_signal_cleans_up(tmp_path, name):
    """Sent once the run has begun to write."""
    number = getattr(signal, name)
    out = tmp_path / "new" / "out"
    child = subprocess.Popen(
        [sys.executable, "-m", "gearwear", "meshing", "--out", str(out)],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),  # under nohup it would inherit "ignored", and keep it
    )
    until = time.monotonic() + 60.0
    while not out.exists() and time.monotonic() < until:
        time.sleep(0.005)
    child.send_signal(number)
    _, told = child.communicate(timeout=60.0)
    assert (child.returncode, told) == (128 + number, "gearwear: stopped\n")
    assert list(tmp_path.iterdir()) == []


STOPPED_IN_TEXT = """
import os, signal
from gearwear.commands.arguments import Parser, answer
def command(_):
    exec(f"import os; os.kill({os.getpid()}, {int(signal.SIGTERM)})\\nfor i in range(10**7): pass")
raise SystemExit(answer(Parser("x", "", "x"), command, []))
"""
"""A command that is stopped while Python runs a text, as it does where classes are made."""


@pytest.mark.skipif(sys.platform == "win32", reason="a process is not asked to end there, it is ended")
def test_the_status_is_that_of_the_signal_wherever_it_comes(tmp_path):
    (tmp_path / "stopped.py").write_text(STOPPED_IN_TEXT)
    told = subprocess.run(
        [sys.executable, "-m", "stopped"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
    )
    assert (told.returncode, told.stderr) == (128 + signal.SIGTERM, "gearwear: stopped\n")


@pytest.mark.parametrize("call", ["mkdir", "open", "rename"])
@pytest.mark.parametrize("at", range(4))
def test_a_stop_at_any_call_of_the_system_leaves_nothing(tmp_path, monkeypatch, call, at):
    """Right behind the call, as a signal comes: before whoever made it knows that it was made."""
    name = "replace" if call == "rename" else call
    real, calls = getattr(os, name), iter(range(1000))

    def stopped(*arguments: object, **more: object) -> object:
        result = real(*arguments, **more)
        if next(calls) == at:
            raise KeyboardInterrupt
        return result

    monkeypatch.setattr(os, name, stopped)
    with contextlib.suppress(KeyboardInterrupt):
        publish(tmp_path / "new" / "out", "a")
    monkeypatch.undo()
    left = list(tmp_path.iterdir())
    assert not left or contents(tmp_path / "new" / "out") == dict.fromkeys(NAMES, "a")


def test_where_a_folder_cannot_be_locked_a_file_in_it_is(tmp_path, monkeypatch):
    """The branch for Windows, on locks that work like those of its C library: one byte of a file, by one opened file."""
    held: dict[int, tuple[int, int]] = {}

    def lock(number: int, mode: str, length: int) -> None:
        place = os.fstat(number).st_dev, os.fstat(number).st_ino
        assert length == 1
        if mode == "free":
            del held[number]
        elif place in held.values():
            raise OSError(errno.EACCES, "Permission denied")
        else:
            held[number] = place

    monkeypatch.setattr(locking, "fcntl", None)
    monkeypatch.setattr(locking, "msvcrt", SimpleNamespace(locking=lock, LK_NBLCK="take", LK_UNLCK="free"), raising=False)
    monkeypatch.setattr(locking, "PATIENCE", 0.1)
    publish(tmp_path, "first")
    (tmp_path / ".gearwear-left" / "new").mkdir(parents=True)
    with output_folder(tmp_path) as alive:
        (alive / "0.txt").write_text("last")
        publish(tmp_path, "second")
        assert alive.exists()
    assert contents(tmp_path) == {**dict.fromkeys(NAMES, "second"), "0.txt": "last"}
    with locking.locked(tmp_path), pytest.raises(InputError, match="another run is writing there"):
        publish(tmp_path, "never")
    assert not held
    assert not (tmp_path / locking.LOCK_FILE).exists()


def test_a_file_system_without_locks(tmp_path, monkeypatch):
    def refuse(number: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(locking, "_lock", refuse)
    (tmp_path / ".gearwear-other").mkdir()  # may be alive
    publish(tmp_path, "new")
    assert contents(tmp_path) == {**dict.fromkeys(NAMES, "new"), ".gearwear-other": "a folder"}


def test_a_single_file_is_as_it_was_or_as_it_should_be(tmp_path, monkeypatch):
    write_file(tmp_path / "below" / "a.toml", "first")
    (tmp_path / "below" / "a.toml").chmod(0o640)
    write_file(tmp_path / "below" / "a.toml", "second")
    assert (tmp_path / "below" / "a.toml").stat().st_mode & 0o777 == 0o640

    def full(a: Path, b: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space"):
        write_file(tmp_path / "below" / "a.toml", "third")
    assert contents(tmp_path / "below") == {"a.toml": "second"}

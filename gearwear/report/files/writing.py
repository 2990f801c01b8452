"""Writing a folder of results so that nothing is ever half-written."""

from __future__ import annotations

import csv
import errno
import json
import math
import os
import secrets
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from numbers import Real
from pathlib import Path
from typing import Any

from gearwear.errors import InputError
from gearwear.report.files.locking import locked, tried

HIDDEN, NEW, OLD, PUBLISHING = ".gearwear-", "new", "old", "publishing"
"""Beginning of a hidden folder's name, and in it: the files of this run, those they replace, and the mark of a set that is complete."""


def check_folder(out: Path) -> None:
    """Refuse a folder that cannot be written to, before long work and without making it.

    Raises
    ------
    InputError
        If it is a file, or lies where nothing can be made.
    """
    if "\0" in str(out):  # of no file that there is, and so no OSError
        raise InputError(f"{out}: no folder has a NUL in its name; one without would be right")
    try:
        if out.exists() and not out.is_dir():
            raise InputError(f"{out}: is a file; a folder is needed")
        existing = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
        if not existing.is_dir():
            raise InputError(f"{out}: cannot be written to, {existing} is a file; a folder is needed")
        if not os.access(existing, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "Permission denied")
    except OSError as error:
        raise unwritable(out, error) from None


def check_heights(said: str, heights: Sequence[object], width: float) -> None:
    """Refuse heights of section curves, as `said`, that are no numbers or lie off a face of `width`, mm.

    Raises
    ------
    InputError
        With the heights that the face has.
    """
    if not all(isinstance(z, Real) and 0.0 <= float(z) <= width for z in heights):  # refuses NaN too
        raise InputError(f"{said}: heights from 0 to {width:g} mm would be right, such as 0,{0.5 * width:g},{width:g}")


def unwritable(out: Path, error: OSError) -> InputError:
    """What to say of a folder that cannot be written to."""
    return InputError(f"{out}: cannot be written to ({error.strerror or error}); free space and the right to write are needed")


@contextmanager
def output_folder(out: Path) -> Iterator[Path]:
    """A hidden folder whose files move into `out` as one set when the block ends well, and vanish when it does not.

    Parameters
    ----------
    out : Path
        Made where it is missing, and taken away again when the block fails. Files of the same name are replaced, others stay.

    Yields
    ------
    Path
        Where to write.

    Raises
    ------
    InputError
        If the folder cannot be made or written to; then all of the earlier files are there as they were.

    Notes
    -----
    While the block runs the hidden folder is locked; one that is not belonged to a run that was killed, and the next run in `out` sweeps
    it. Files move while `out` is locked, so that two runs cannot mix theirs. If one of them cannot move, those before it move back; if the
    process is killed in between, the next run finishes the set, which is complete by then.
    """
    check_folder(out)
    new_folders = [folder for folder in (out, *out.parents) if not folder.exists()]
    hidden = out / _hidden_name()
    try:
        with ExitStack() as alive:
            _make_hidden(hidden, alive)
            yield hidden / NEW
            with locked(out):
                _publish(hidden, out)
        new_folders = []
    except OSError as error:
        raise unwritable(out, error) from None
    finally:
        shutil.rmtree(hidden, ignore_errors=True)
        for folder in new_folders:  # innermost first
            with suppress(OSError):  # another run has put something there
                folder.rmdir()


def _make_hidden(hidden: Path, alive: ExitStack) -> None:
    """Make a hidden folder, inside the one written to so that its files move in one step, and locked as long as `alive` is open."""
    out = hidden.parent
    for _ in range(10):
        out.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError), locked(out):  # a run that failed has just taken its folder away
            _sweep(out)
            hidden.mkdir(mode=0o700)
            alive.enter_context(tried(hidden))
            for part in (NEW, OLD):
                (hidden / part).mkdir()
            return
    raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))


def _sweep(out: Path) -> None:
    """Take away the hidden folders of runs that were killed; a set that was being published is finished."""
    for hidden in out.glob(f"{HIDDEN}*"):
        if not hidden.is_dir() or hidden.is_symlink():
            continue
        finished = False
        with suppress(OSError), tried(hidden) as dead:
            if dead and (hidden / PUBLISHING).exists():
                for file in (hidden / NEW).iterdir():
                    os.replace(file, out / file.name)
            finished = dead is True
        if finished:
            shutil.rmtree(hidden, ignore_errors=True)


def _publish(hidden: Path, out: Path) -> None:
    """Move a complete set into `out`: all of it, or nothing."""
    written = sorted((hidden / NEW).iterdir())
    for file in written:
        if (out / file.name).is_dir():
            raise IsADirectoryError(errno.EISDIR, f"{file.name} is a folder there")
    (hidden / PUBLISHING).touch()
    begun: list[Path] = []
    try:
        for file in written:
            begun.append(file)
            if os.path.lexists(out / file.name):
                os.replace(out / file.name, hidden / OLD / file.name)
            os.replace(file, out / file.name)
    except BaseException:
        for file in reversed(begun):
            if not file.exists():
                os.replace(out / file.name, file)
            if os.path.lexists(hidden / OLD / file.name):
                os.replace(hidden / OLD / file.name, out / file.name)
        raise
    finally:
        (hidden / PUBLISHING).unlink()


def write_file(path: Path, text: str) -> None:
    """Write a text at once: as it was or as it should be, whatever happens in between; alike on every system.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    write_data(path, text.encode())


def write_data(path: Path, data: bytes) -> None:
    """The same of bytes, in a folder that is there; they are on the disk before anything has the file's name."""
    if path.exists() and not path.is_file():  # a device or a pipe has no earlier contents
        path.write_bytes(data)
        return
    new = path.with_name(_hidden_name())
    try:
        with open(new, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, new)
        os.replace(new, path)
    except BaseException:
        with suppress(OSError):
            new.unlink()
        raise


def _hidden_name() -> str:
    """A name of its own, known before anything has it: so a signal at any moment leaves nothing."""
    return f"{HIDDEN}{secrets.token_hex(8)}"


def write_csv(path: Path, head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Write a table as CSV, alike on every system."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows(rows)


def write_json(path: Path, report: Mapping[str, Any]) -> None:
    """Write a report as JSON; what is not a finite number becomes null, as JSON has no other."""
    path.write_bytes(json_text(report).encode())


def json_text(report: Mapping[str, Any]) -> str:
    """The text that `write_json` writes."""
    return json.dumps(finite(report), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """`value` with numpy's types as Python's own and non-finite numbers as None.

    >>> import numpy as np
    >>> finite({"a": np.float64("nan"), "b": np.arange(2), 3: np.True_, "d": (1.5, None)})
    {'a': None, 'b': [0, 1], '3': True, 'd': [1.5, None]}
    """
    if isinstance(value, Mapping):
        return {str(key): finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    if hasattr(value, "tolist") and not isinstance(value, str | bytes):
        return finite(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value

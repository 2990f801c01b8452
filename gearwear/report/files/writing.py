"""Writing a folder of results so that nothing is ever half-written."""

from __future__ import annotations

import errno
import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gearwear.errors import InputError


def check_folder(out: Path) -> None:
    """Refuse a folder that cannot be written to, before long work and without making it.

    Raises
    ------
    InputError
        If it is a file, or lies where nothing can be made.
    """
    try:
        if out.exists() and not out.is_dir():
            raise InputError(f"--out {out}: is a file; a folder is needed")
        there = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
        if not there.is_dir():
            raise InputError(f"--out {out}: cannot be written to, {there} is a file; a folder is needed")
        if not os.access(there, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "Permission denied")
    except OSError as error:
        raise _unwritable(out, error) from None


def _unwritable(out: Path, error: OSError) -> InputError:
    return InputError(
        f"--out {out}: cannot be written to ({error.strerror or error}); free space and the right to write are needed"
    )


@contextmanager
def output_folder(out: Path) -> Iterator[Path]:
    """A temporary folder whose files move into `out` when the block ends well, and vanish when it does not.

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
        If the folder cannot be made or written to.
    """
    check_folder(out)
    made = [folder for folder in (out, *out.parents) if not folder.exists()]
    stage = None
    try:
        out.mkdir(parents=True, exist_ok=True)
        # Inside `out`: the same file system, so that each file moves in one step.
        stage = Path(tempfile.mkdtemp(prefix=".gearwear-", dir=out))
        yield stage
        written = sorted(stage.iterdir())
        for file in written:
            if (out / file.name).is_dir():
                raise IsADirectoryError(errno.EISDIR, f"{file.name} is a folder there")
        for file in written:
            os.replace(file, out / file.name)
        made = []
    except OSError as error:
        raise _unwritable(out, error) from None
    finally:
        if stage is not None:
            shutil.rmtree(stage, ignore_errors=True)
        for folder in made:  # innermost first
            if folder.is_dir() and not any(folder.iterdir()):
                folder.rmdir()


def write_json(path: Path, report: Mapping[str, Any]) -> None:
    """Write a report as JSON; what is not a finite number becomes null, as JSON has no other."""
    path.write_text(json.dumps(finite(report), indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")


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

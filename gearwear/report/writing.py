"""Writing a folder of results so that nothing is ever half-written."""

from __future__ import annotations

import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gearwear.errors import InputError


@contextmanager
def staged(out: Path) -> Iterator[Path]:
    """A temporary folder whose files move into `out` when the block ends well, and vanish when it does not.

    Parameters
    ----------
    out : Path
        Made where it is missing. Files of the same name are replaced, others stay.

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=".gearwear-", dir=out))
    except OSError as error:
        raise InputError(f"--out {out}: cannot be written to ({error.strerror}); a folder that can would be right") from None
    try:
        yield stage
        for file in sorted(stage.iterdir()):
            os.replace(file, out / file.name)
    except OSError as error:
        raise InputError(
            f"--out {out}: cannot be written to ({error.strerror}); free space and the right to write are needed"
        ) from None
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def dump_json(path: Path, report: dict[str, Any]) -> None:
    """Write a report as JSON; what is not a finite number becomes null, as JSON has no other."""
    path.write_text(json.dumps(finite(report), indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")


def finite(value: Any) -> Any:
    """`value` with numpy scalars as Python's own and non-finite numbers as None."""
    if isinstance(value, dict):
        return {str(key): finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    if hasattr(value, "tolist") and not isinstance(value, str | bytes):
        return finite(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value

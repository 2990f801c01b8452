"""STEP files: millimetres, named products, the same bytes every time, never half of one."""

from __future__ import annotations

import os
import re
from itertools import count
from pathlib import Path

from build123d import Shape, Unit, export_step
from OCP.TopoDS import TopoDS_Shape

TIMESTAMP = "2000-01-01T00:00:00"
"""What the header says in place of the hour, so that equal models are equal files."""

OCCURRENCE = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()'\d+'")


def write_step(shape: Shape[TopoDS_Shape], path: Path) -> None:
    """Write a solid or an assembly as STEP (AP214).

    Parameters
    ----------
    shape : build123d.Shape
        Its labels, and those of its children, become the product names.
    path : Path
        File to write; it is replaced in one step, and left alone if writing fails.

    Raises
    ------
    OSError
        If the file cannot be written.

    Notes
    -----
    Curves in the parameter planes of the faces are left out: every reader makes them again from the exact edges,
    and the file halves.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        part.touch()  # first by hand: the kernel does not say why it cannot write
        try:
            export_step(shape, part, unit=Unit.MM, write_pcurves=False, timestamp=TIMESTAMP)
        except RuntimeError as error:
            raise OSError(f"the STEP writer failed: {error}") from None
        part.write_bytes(_renumbered(part.read_bytes()))
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _renumbered(text: bytes) -> bytes:
    """Occurrences in an assembly numbered from 1: the kernel counts them from the start of the process."""
    number = count(1)
    return OCCURRENCE.sub(lambda occurrence: occurrence[1] + f"'{next(number)}'".encode(), text)

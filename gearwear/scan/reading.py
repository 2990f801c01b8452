"""From files to clean scans: which reader, which unit, and one line for whatever goes wrong."""

from __future__ import annotations

import gzip
import hashlib
import warnings
import zlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import cast

import numpy as np

from gearwear.errors import InputError, NotEnoughMemory, check_kind, printable, readable
from gearwear.memory import allowed, check_memory
from gearwear.scan.clean import clean
from gearwear.scan.contents import Contents
from gearwear.scan.e57 import read_e57
from gearwear.scan.glb import read_glb
from gearwear.scan.las import read_las
from gearwear.scan.obj import read_obj, read_off
from gearwear.scan.parsing import MOST_UNPACKED
from gearwear.scan.pcd import read_pcd
from gearwear.scan.pieces import in_mm
from gearwear.scan.ply import read_ply
from gearwear.scan.stl import read_stl
from gearwear.scan.streaming import streamed
from gearwear.scan.text import read_text
from gearwear.scan.threemf import read_3mf
from gearwear.scan.types import Scan, ScanKind
from gearwear.scan.units import factor

READERS: dict[str, Callable[[bytes], Contents]] = {
    ".ply": read_ply,
    **dict.fromkeys((".xyz", ".asc", ".txt", ".pts", ".csv"), read_text),
    ".pcd": read_pcd,
    ".e57": read_e57,
    **dict.fromkeys((".las", ".laz"), read_las),
    ".stl": read_stl,
    ".obj": read_obj,
    ".off": read_off,
    ".3mf": read_3mf,
    ".glb": read_glb,
}
"""Reader by the end of the file's name."""


def read_scan(paths: Sequence[str | PathLike[str] | Scan], units: str = "mm", stream: bool | None = False) -> list[Scan]:
    """Read the views of one gear, each in its own axes.

    Parameters
    ----------
    paths : sequence of path or Scan
        One file per view, or what was read of it.
    units : str
        "mm", "cm", "m", "um" or "in"; a `Scan` is in mm.
    stream : bool or None
        Whether to hold only a sample of the points in memory (`Scan.chunks`); None: where there are many (`streaming.STREAM_FROM`). Views of
        one gear are not streamed.

    Returns
    -------
    list of Scan
        In the order given; `view` is the place in it. They are merged after registration, not here.

    Raises
    ------
    InputError
        As `read_one`; also if there is no file, or a section stands beside other scans.
    """
    if not paths:
        raise InputError("no scan is given: at least one file would be right")
    if len(paths) > 1 and stream:
        raise InputError(f"{len(paths)} views of one gear are not streamed: one scan, or all read as a whole, would be right")
    if len(paths) == 1:
        return [read_one(paths[0], units, stream)]
    scans = [replace(scan, view=np.full_like(scan.view, i)) for i, scan in enumerate(_all(paths, units))]
    sections = [scan for scan in scans if scan.planar]
    if sections and len(sections) < len(scans):
        raise InputError(f"{sections[0].files[0]} is a planar section and another scan is not: views of one kind would be right")
    check_different(scans)
    return scans


def check_different(scans: Sequence[Scan], others: Sequence[Scan] = (), what: str = "each view once would be right") -> None:
    """Refuse a file, or points without one, that was given twice: as two views of one gear its points would count double and every ± would be too small,
    and as the scan before wear as well nothing would have changed.

    Parameters
    ----------
    scans : sequence of Scan
        No two of them may hold the same bytes.
    others : sequence of Scan
        Nor one of these and one of `scans`.
    what : str
        What would be right.

    Raises
    ------
    InputError
        If two do; it names both.
    """
    seen: dict[str, str] = {}
    for scan in [*scans, *others]:
        name = scan.files[0]
        for digest in scan.sha256 or (hashlib.sha256(scan.points.tobytes()).hexdigest(),):
            if digest in seen:
                raise InputError(f"{name}: is {'given twice' if seen[digest] == name else f'the same as {seen[digest]}'}: {what}")
            seen[digest] = name


def _all(paths: Sequence[str | PathLike[str] | Scan], units: str) -> list[Scan]:
    if len(paths) > 127:
        raise InputError(f"{len(paths)} scans are given: at most 127 views of one gear would be right")
    return [read_one(path, units) for path in paths]


def read_one(path: str | PathLike[str] | Scan, units: str = "mm", stream: bool | None = False) -> Scan:
    """Read and clean one file.

    Parameters
    ----------
    path : path or Scan
        The end of its name says the format (`READERS`); it may be compressed by gzip. A `Scan` is returned as it is.
    units : str
        Unit of the coordinates. A 3MF states its own, which "mm" leaves as it is and any other name overrules.
    stream : bool or None
        As `read_scan`.

    Returns
    -------
    Scan
        In mm.

    Raises
    ------
    InputError
        Whatever is wrong with the file, in one line that begins with its name. No other exception comes out.
    """
    scale = factor(units)
    if isinstance(path, Scan):
        return path
    check_kind(path, str | PathLike, "scan", "a file, or what gw.read_scan or gw.as_scan returns,")
    try:
        large = streamed(Path(path), units, scale, stream)
        if large is not None:
            return large
        contents, digest = _contents(Path(path))
        if contents.units is not None and units == "mm":
            units, scale = contents.units, factor(contents.units)
        points = contents.points if scale == 1.0 else in_mm(contents.points, scale)
        cleaned, kind = clean(replace(contents, points=points))
    except NotEnoughMemory as error:
        raise NotEnoughMemory(f"{path}: {printable(str(error))}") from None
    except InputError as error:
        raise InputError(f"{path}: {printable(str(error))}") from None
    return Scan(
        points=np.ascontiguousarray(cleaned.points), normals=cleaned.normals, triangles=cleaned.triangles, kind=cast(ScanKind, kind),
        files=(readable(path),), rejected=cleaned.rejected, view=np.zeros(len(cleaned.points), np.int8), units=units, sha256=(digest,),
    )  # fmt: skip


def _contents(path: Path) -> tuple[Contents, str]:
    """What the reader for this name finds, every failure of a reader or of its package turned into one line; and the file's SHA-256."""
    data, suffix, digest = _bytes(path)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return READERS[suffix](data), digest
    except (InputError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic in a compiled reader is no Exception
        reason = next(iter(str(error).strip().splitlines()), "no reason given")[:120]
        raise InputError(
            f"cannot be read as {suffix[1:].upper()} ({type(error).__name__}: {reason}): a complete, undamaged file would be right"
        ) from None


def _bytes(path: Path) -> tuple[bytes, str, str]:
    """The file, unpacked, the end of its name without ".gz", and the SHA-256 of the file as it lies there."""
    suffixes = [suffix.lower() for suffix in path.suffixes]
    packed = suffixes[-1:] == [".gz"]
    suffix = (suffixes[:-1] if packed else suffixes)[-1:]
    try:
        if path.is_dir():
            raise InputError("is a folder: a file would be right")
        if not path.exists():
            raise InputError("no such file: the path of a scan would be right")
    except OSError as error:  # a name that is too long, a folder that may not be looked into
        raise InputError(f"cannot be opened ({error.strerror}): a readable file would be right") from None
    if not suffix or suffix[0] not in READERS:
        raise InputError(
            f"the name does not end in a format that is known: {' '.join(READERS)} would be right, with .gz if compressed"
        )
    try:
        if not path.is_file():
            raise InputError("is no file but a device or a pipe: a file would be right")
        check_memory(other=path.stat().st_size)
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be opened ({error.strerror}): a readable file would be right") from None
    if not data:
        raise InputError("is empty: a file with points would be right")
    digest = hashlib.sha256(data).hexdigest()
    return (_unpack(data) if data[:2] == b"\x1f\x8b" or packed else data), suffix[0], digest


def _unpack(data: bytes) -> bytes:
    """Undo gzip, up to a size that a scan can have."""
    most = min(MOST_UNPACKED * len(data), allowed())
    try:
        with gzip.GzipFile(fileobj=BytesIO(data)) as file:
            plain = file.read(most + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"is no complete gzip file ({error}): a complete one would be right") from None
    if len(plain) > most:
        check_memory(other=len(plain))
        raise InputError(f"unpacks to more than {MOST_UNPACKED} times its size: no scan is as repetitive")
    if not plain:
        raise InputError("is empty once unpacked: a file with points would be right")
    return plain

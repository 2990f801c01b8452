"""A scan too large to be held in memory: its chunks, and a sample of it that is held."""

from __future__ import annotations

import hashlib
import os
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.errors import InputError, readable
from gearwear.memory import POINT, allowed, check_memory
from gearwear.scan.clean import FARTHEST, clean
from gearwear.scan.contents import Contents
from gearwear.scan.e57 import e57_pieces
from gearwear.scan.las import las_pieces
from gearwear.scan.pcd import pcd_pieces
from gearwear.scan.pieces import PIECE, Chunks, Pieces, in_mm
from gearwear.scan.ply import ply_pieces
from gearwear.scan.text import text_pieces
from gearwear.scan.types import Scan
from gearwear.scan.unique import first_of_each

IN_PIECES: dict[str, Callable[[Path], Pieces | None]] = {
    ".ply": ply_pieces,
    **dict.fromkeys((".xyz", ".asc", ".txt", ".pts", ".csv"), text_pieces),
    ".pcd": pcd_pieces,
    ".e57": e57_pieces,
    **dict.fromkeys((".las", ".laz"), las_pieces),
}
"""Readers that go through a file piece by piece, by the end of its name; None for what they can only read as a whole."""
STREAM_FROM = 5_000_000
"""Points from which on a scan is streamed where nothing else is said."""
SAMPLE = 400_000
"""Points of the sample: what the pose, the root and all that looks at single points rest on."""
LEAST_BYTES = 2
"""Bytes that a point takes at least in a file; a packed LAZ comes nearest to it."""
NOT_IN_PIECES = "cannot be streamed: PLY of points alone, text of x, y and z, LAS, LAZ, E57, uncompressed PCD, none of them packed by gzip, would be right"


def streamed(path: Path, units: str, scale: float, wanted: bool | None) -> Scan | None:
    """A file's sample, with the chunks of all of it; None where it is to be read as a whole.

    Parameters
    ----------
    path : Path
    units : str
        Their name, and
    scale : float
        millimetres per unit.
    wanted : bool or None
        Whether to stream it; None: from `STREAM_FROM` points on, and where the whole needs more memory than is allowed.

    Raises
    ------
    InputError
        If the file is damaged, or cannot be streamed and is to be.
    """
    pieces = _pieces_of(path, wanted)
    if pieces is None:
        return None
    check_memory(other=POINT * (min(SAMPLE, pieces.count) + PIECE))
    return _surveyed(path, Pieces(pieces.count, lambda: _guarded(path, pieces)), units, scale)


def check_held(paths: Sequence[Path], wanted: bool | None, what: str) -> None:
    """Refuse `what` of a scan that will be streamed."""
    if len(paths) == 1 and _pieces_of(paths[0], wanted) is not None:
        raise InputError(
            f"{paths[0]}: {what} is not offered for a streamed scan: parquet, or a scan of fewer points, would be right"
        )


def _pieces_of(path: Path, wanted: bool | None) -> Pieces | None:
    """The pieces of a file that is to be streamed."""
    there = os.path.isfile(path)  # Path.is_file raises where a name is too long
    if wanted is False or not there or not (wanted or path.stat().st_size >= LEAST_BYTES * _whole()):
        return None
    read = IN_PIECES.get(path.suffix.lower())
    with _one_line(path.suffix):
        pieces = None if read is None else read(path)
    if pieces is None and wanted:
        raise InputError(NOT_IN_PIECES)
    return pieces if pieces is not None and (wanted or pieces.count >= _whole()) else None


def _whole() -> int:
    """Points from which on a scan is not read as a whole: fewer take less memory than a sample with its chunks."""
    return min(STREAM_FROM, max(allowed() // POINT, SAMPLE + PIECE) + 1)


class _one_line:
    """Whatever goes wrong in a reader or its package ends in one line."""

    def __init__(self, suffix: str) -> None:
        self._kind = suffix[1:].upper()

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if error is None or isinstance(error, InputError | KeyboardInterrupt | SystemExit | GeneratorExit):
            return
        reason = next(iter(str(error).strip().splitlines()), "no reason given")[:120]
        raise InputError(
            f"cannot be read as {self._kind} ({type(error).__name__}: {reason}): a complete, undamaged file would be right"
        ) from None


def _guarded(path: Path, pieces: Pieces) -> Iterator[Contents]:
    """The pieces, whatever goes wrong in one line."""
    reading = pieces.read()
    while True:
        with _one_line(path.suffix), warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            piece = next(reading, None)
        if piece is None:
            return
        yield piece


def _surveyed(path: Path, pieces: Pieces, units: str, scale: float) -> Scan:
    """The first time through a file: what is no measurement is found and counted, and a sample is drawn."""
    rejected: dict[str, int] = {}
    kept: list[np.ndarray | None] = []
    sample: list[Floats] = []
    picks = _picks(pieces.count)
    start = total = 0
    for piece in pieces.read():
        points = in_mm(piece.points, scale)
        keep, reasons = _clean(points)
        for reason, count in (piece.rejected | reasons).items():
            rejected[reason] = rejected.get(reason, 0) + count
        kept.append(None if keep.all() else np.packbits(keep))
        total += int(keep.sum())
        stop = start + len(points)
        here = picks[np.searchsorted(picks, start) : np.searchsorted(picks, stop)] - start
        sample.append(points[here[keep[here]]])
        start = stop
    held = Contents(np.concatenate([np.empty((0, 3)), *sample]))
    thinned, kind = clean(held)
    if kind == "section":
        raise InputError("is a planar section, which is not streamed: reading it as a whole would be right")
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    return Scan(
        points=np.ascontiguousarray(thinned.points), normals=None, triangles=None, kind="cloud", files=(readable(path),),
        rejected={reason: count for reason, count in rejected.items() if count}, view=np.zeros(len(thinned.points), np.int8),
        units=units, sha256=(digest,), chunks=Chunks(readable(path), pieces, tuple(kept), total, scale),
    )  # fmt: skip


def _picks(count: int) -> np.ndarray:
    """Which points of a file make up the sample, rising: one at random out of each of `SAMPLE` equal stretches of it."""
    if count <= SAMPLE:
        return np.arange(count)
    place = np.arange(SAMPLE) + np.random.default_rng(0).random(SAMPLE)
    return np.asarray((place * (count / SAMPLE)).astype(np.int64))


def _clean(points: Floats) -> tuple[Bools, dict[str, int]]:
    """(k,) points that are measurements, and how many are not, by reason: not finite, or repeated within the chunk."""
    with np.errstate(invalid="ignore"):
        keep: Bools = np.all(np.abs(points) <= FARTHEST, axis=1)
    finite = np.flatnonzero(keep)
    first, _ = first_of_each(points[finite])
    reasons = {"non_finite": len(points) - len(finite), "duplicate": len(finite) - len(first)}
    if reasons["duplicate"]:
        keep[:] = False
        keep[finite[first]] = True
    return keep, reasons

"""Points that are read piece by piece: a file that is larger than the memory it may take, gone through as often as is wanted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import parse_numbers, short_by

PIECE = 1 << 18
"""Points read at a time: what is worked out of them takes about a hundred megabytes."""
TEXT_PIECE = 1 << 22
"""Bytes of text read at a time: about as many points."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """The points of a file, nothing cleaned, in the file's own unit.

    Parameters
    ----------
    count : int
        Points in it, those included that the file itself marks as no good.
    read : callable
        Begins anew each time: pieces of about `PIECE` points, in the order of the file, without normals and triangles. A file that is found
        to be damaged on the way ends in an `InputError`.
    """

    count: int
    read: Callable[[], Iterator[Contents]]


@dataclass(frozen=True, slots=True, repr=False)
class Chunks:
    """The clean points of a scan, chunk by chunk, in mm; they can be gone through any number of times.

    Parameters
    ----------
    name : str
        Of the file.
    pieces : Pieces
        What it holds.
    kept : tuple of (k,) uint8 or None
        For each piece which of its points are kept, eight to a byte; None: all.
    count : int
        Points that come out.
    scale : float
        mm per unit of the file.
    """

    name: str
    pieces: Pieces
    kept: tuple[np.ndarray | None, ...]
    count: int
    scale: float

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[Floats]:
        reading = self.pieces.read()
        for kept in self.kept:
            points = self._next(reading)
            yield points if kept is None else points[np.unpackbits(kept, count=len(points)).astype(bool)]

    def scaled(self, factor: float) -> Chunks:
        """The same points, all lengths multiplied."""
        return replace(self, scale=self.scale * factor)

    def _next(self, reading: Iterator[Contents]) -> Floats:
        try:
            piece = next(reading, None)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        if piece is None:
            raise InputError(f"{self.name}: has changed while it was read: a file that stays as it is would be right")
        return in_mm(piece.points, self.scale)


def in_mm(points: Floats, scale: float) -> Floats:
    """Points times mm per unit; what is no number in the file, or too large for one in mm, goes through without a warning."""
    with np.errstate(all="ignore"):
        return points * scale


def rows_of(path: Path, start: int, count: int, row: np.dtype[np.void], places: Sequence[str]) -> Iterator[Contents]:
    """Three fields of `count` binary rows of a file, from byte `start` on."""
    with path.open("rb") as file:
        file.seek(start)
        for done in range(0, count, PIECE):
            wanted = min(PIECE, count - done)
            data = file.read(wanted * row.itemsize)
            if len(data) < wanted * row.itemsize:
                raise short_by("points", count, done + len(data) // row.itemsize)
            rows = np.frombuffer(data, row)
            points = np.empty((wanted, 3))
            for i, place in enumerate(places):
                points[:, i] = rows[place]
            yield Contents(points)


def numbers_of(path: Path, start: int, count: int, width: int, places: Sequence[int]) -> Iterator[Contents]:
    """Three columns of `count` rows of `width` numbers each, written as text from byte `start` on, whatever the lines."""
    done, tail, carried = 0, b"", np.empty(0)
    with path.open("rb") as file:
        file.seek(start)
        while True:
            block = file.read(TEXT_PIECE)
            text = tail + block
            cut = text.rfind(b"\n") + 1 if block else len(text)
            tail = text[cut:]
            if len(tail) > TEXT_PIECE:
                raise InputError(f"a line is longer than {TEXT_PIECE:,} bytes: a row of numbers in each would be right")
            try:
                numbers = np.concatenate([carried, parse_numbers(text[:cut])])
            except ValueError:
                raise InputError("something after the header is no number: numbers and nothing else would be right") from None
            rows = len(numbers) // width
            if rows:
                yield Contents(numbers[: rows * width].reshape(rows, width)[:, places])
            done, carried = done + rows, numbers[rows * width :]
            if done > count or not block:
                break
    if done != count or len(carried):
        raise short_by("points", count, done)


def join(pieces: Pieces) -> Contents:
    """All pieces as one."""
    every = list(pieces.read())
    rejected: dict[str, int] = {}
    for piece in every:
        for reason, count in piece.rejected.items():
            rejected[reason] = rejected.get(reason, 0) + count
    return Contents(np.concatenate([np.empty((0, 3)), *(piece.points for piece in every)]), rejected=rejected)

"""Points from plain text: XYZ, ASC, TXT, PTS, CSV.

The first lines decide what the columns are; the rest is read in blocks, each at once where it is
nothing but numbers, line by line where it is not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, takewhile
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.quantity import counted
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import parse_numbers, short_by, tokens_per_line
from gearwear.scan.pieces import TEXT_PIECE, Pieces

BLOCK = 1 << 23
"""Bytes worked on at a time."""
ROWS = 60
"""Bytes that a byte of a block takes at most while it is worked on line by line."""
LOOK = 1000
"""Lines in which the first numbers must come."""
LOOK_BYTES, LONGEST_LINE = 1 << 20, 1 << 14
"""Bytes in which the first numbers must come, and of a line of numbers; one of a scan has some hundred."""
NUMERIC = b"0123456789+-.eE \t\r\nNnAaIiFf"
"""Bytes of a block that may be read at once (nan and inf are numbers)."""
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
COMMENT = (b"#", b"//", b";", b"!", b"%", b"*")
NOT_A_NUMBER = {b"null", b"none", b"n/a", b"na", b"-", b"#n/a"}
DECIMAL_COMMA = re.compile(rb"[+-]?\d*,\d+([eE][+-]?\d+)?|[+-]?\d+([eE][+-]?\d+)?")

WHOLE = re.compile(rb"[+-]?\d+")


@dataclass(frozen=True, slots=True)
class Layout:
    """How the lines of one file are to be read.

    Parameters
    ----------
    table : bytes
        256 bytes that turn delimiters into spaces (and a decimal comma into a point).
    width : int
        Columns in every line.
    columns : tuple of int
        Where x, y and, but for a section, z are.
    promised : int or None
        Count line before the points.
    first_line : int
        1-based line of the first point.
    offset : int
        Where in the file it starts.
    """

    table: bytes
    width: int
    columns: tuple[int, ...]
    promised: int | None
    first_line: int
    offset: int


def read_text(data: bytes) -> Contents:
    """Read points from text; two columns are a planar section at z = 0.

    Parameters
    ----------
    data : bytes
        The file. Columns may be parted by blanks, tabs, commas or semicolons; decimals by a point, or by a comma
        where commas do not part columns. Header lines, comment lines and a count line are skipped.

    Returns
    -------
    Contents
        Points that read "nan", "null" or the like are in it as nan.

    Raises
    ------
    InputError
        If a line does not fit; it names the line.
    """
    check_memory(other=3 * len(data))
    data = _as_ascii(data)
    layout = _look(data)
    check_memory(points=data.count(b"\n"), other=len(data) + ROWS * min(BLOCK, len(data)))
    blocks = []
    line = layout.first_line
    end = data[-LONGEST_LINE:]
    last = data.count(b"\n") + 1 - end[len(end.rstrip()) :].count(b"\n")
    for block in _blocks(data, layout.offset):
        blocks.append(_read_block(block, layout, line, last))
        line += block.count(b"\n")
    xyz = np.concatenate(blocks)
    if layout.promised is not None and len(xyz) != layout.promised:
        raise short_by("points", layout.promised, len(xyz))
    if len(layout.columns) == 2:
        xyz = np.column_stack([xyz, np.zeros(len(xyz))])
    return Contents(xyz)


def text_pieces(path: Path) -> Pieces | None:
    """The points of a text, piece by piece; None for a planar section, UTF-16, and lines ended by carriage returns alone.

    Parameters and errors as `read_text`.
    """
    with path.open("rb") as file:
        head = file.read(LOOK_BYTES + LONGEST_LINE + 2)
        mark = len(BYTE_ORDER_MARK) if head.startswith(BYTE_ORDER_MARK) else 0
        if head[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\n" not in head:
            return None
        layout = _look(_as_ascii(head))
        if len(layout.columns) == 2:
            return None
        file.seek(0)
        lines = sum(block.count(b"\n") for block in iter(lambda: file.read(BLOCK), b""))
        file.seek(-min(LONGEST_LINE, file.tell()), 2)
        end = file.read()
    last = lines + 1 - end[len(end.rstrip()) :].count(b"\n")
    return Pieces(max(last - layout.first_line + 1, 0), lambda: _pieces(path, layout, mark + layout.offset, last))


def _pieces(path: Path, layout: Layout, start: int, last: int) -> Iterator[Contents]:
    """The points of each block of a file from byte `start` on; `last` is its last line."""
    line, total = layout.first_line, 0
    with path.open("rb") as file:
        file.seek(start)
        while block := file.read(TEXT_PIECE):
            if not block.endswith(b"\n"):
                rest = file.readline(LONGEST_LINE + 2)
                if len(rest) > LONGEST_LINE and not rest.endswith(b"\n"):
                    raise _too_long()
                block += rest
            if b"\0" in block:
                raise _binary()
            points = _read_block(block, layout, line, last)
            line += block.count(b"\n")
            total += len(points)
            yield Contents(points)
    if layout.promised is not None and total != layout.promised:
        raise short_by("points", layout.promised, total)


def _as_ascii(data: bytes) -> bytes:
    """The text without byte order mark, UTF-16 undone, lines ended by newlines."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        data = data.decode("utf-16", errors="replace").encode()
    data = data.removeprefix(BYTE_ORDER_MARK)
    if b"\0" in data:
        raise _binary()
    return data if b"\n" in data else data.replace(b"\r", b"\n")


def _blocks(data: bytes, start: int) -> Iterator[bytes]:
    """The file from `start` in pieces of whole lines."""
    while start < len(data):
        stop = data.find(b"\n", start + BLOCK) + 1 or len(data)
        if stop - start > BLOCK + LONGEST_LINE:
            raise _too_long()
        yield data[start:stop]
        start = stop


def _binary() -> InputError:
    return InputError("holds zero bytes, so it is binary, not text: columns of numbers would be right")


def _too_long(number: int = 0) -> InputError:
    where = f"line {number:,}" if number else "a line"
    return InputError(f"{where} is longer than {LONGEST_LINE:,} bytes: x, y and z and a few columns beside them would be right")


def _lines(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Offset and text of each line; of what is longer than a line of numbers, the beginning."""
    start = 0
    while start < len(data):
        stop = data.find(b"\n", start) + 1 or len(data)
        yield start, data[start : min(stop, start + LONGEST_LINE + 2)].strip()
        start = stop


def _look(data: bytes) -> Layout:
    """Decide the layout from the first lines."""
    header, promised = b"", None
    lines = list(takewhile(lambda line: line[0] <= LOOK_BYTES, islice(_lines(data), LOOK)))
    table = _delimiters([text for _, text in lines])
    for number, (offset, text) in enumerate(lines, start=1):
        values = None if text.startswith(COMMENT) else _values(text, table)
        if values and len(text) > LONGEST_LINE:
            raise _too_long(number)
        if not values:
            header = text or header
            continue
        if len(values) == 1:
            if promised is not None or not _is_count(values):
                raise InputError(f"line {number} has 1 column: x, y and z would be right (x and y for a planar section)")
            promised = int(values[0])
            continue
        sample = (_values(text, table) for _, text in lines[number - 1 :])
        first = [row[0] for row in sample if row and len(row) == len(values)]
        if _split_decimals([text for _, text in lines[number - 1 :]]):
            raise InputError(
                f"line {number}: {text[:40].decode('ascii', errors='replace')!r} has commas as decimal signs and between the columns too: blanks, tabs or semicolons between them,"
                " or points as decimal signs, would be right"
            )
        columns = _columns(header, len(values), first)
        return Layout(table, len(values), columns, promised, number, offset)
    raise InputError(
        f"no line of numbers in its first {len(lines):,} lines: columns x, y, z would be right (x, y for a planar section)"
    )


def _delimiters(lines: list[bytes]) -> bytes:
    """Translation of delimiters to spaces; a comma is a decimal comma where something else parts the columns."""
    rows = [line for line in lines if line and not line.translate(None, NUMERIC + b",;")]
    comma = any(b"," in row for row in rows)
    for row in rows:
        words = row.replace(b";", b" ").split()
        comma &= (len(words) > 1 or b"," not in row) and all(DECIMAL_COMMA.fullmatch(word) for word in words)
    if comma:
        return bytes.maketrans(b",;", b". ")
    return bytes.maketrans(b",;", b"  ")


def _split_decimals(lines: list[bytes]) -> bool:
    """Whether commas part numbers from their own decimals: whole numbers in pairs, of which the second has no sign and, as decimals do and whole
    numbers do not, now and then begins with a nought."""
    rows = [line.split(b",") for line in lines if line and not line.startswith(COMMENT)]
    if not rows or len(rows[0]) not in (4, 6):
        return False
    noughts = False
    for row in rows:
        second = [word.strip() for word in row[1::2]]
        if (
            len(row) != len(rows[0])
            or not all(WHOLE.fullmatch(word.strip()) for word in row)
            or not all(map(bytes.isdigit, second))
        ):
            return False
        noughts |= any(len(word) > 1 and word.startswith(b"0") for word in second)
    return noughts


def _values(text: bytes, table: bytes) -> list[float] | None:
    """The numbers of one line; None if one of its words is none."""
    values = []
    for word in text.translate(table).replace(b'"', b" ").split():
        try:
            values.append(float(word) if b"_" not in word else float("x"))
        except ValueError:
            lower = word.lower()
            if lower not in NOT_A_NUMBER and b"nan(" not in lower and b"#" not in lower:
                return None
            values.append(np.nan)
    return values


def _is_count(values: list[float]) -> bool:
    """Whether a line is a single whole number, as the count of points before them is."""
    return len(values) == 1 and 0.0 <= values[0] < 1e15 and values[0].is_integer()


def _columns(header: bytes, width: int, first: list[float]) -> tuple[int, ...]:
    """Which of `width` columns are x, y (and z): by the names in the header, else the first, after a running number in `first`."""
    header = re.sub(rb"[\[(][^\[\]()]*[])]", b"", header)  # units
    header = header.translate(None, b"\"'").strip(b"#/;!%* \t")
    for parted in (rb"[,;\t]", rb"[\s,;]+"):  # by delimiters alone first: names may hold blanks
        names = [re.sub(rb"[^a-z].*", b"", word.strip().lower()) for word in re.split(parted, header) if word.strip()]
        if len(names) == width and names.count(b"x") == 1 and names.count(b"y") == 1:
            return tuple(names.index(axis) for axis in (b"x", b"y", b"z") if axis in names)
    skip = 0
    if width > 2 and len(first) > 2:
        skip = int(first[0] in (0.0, 1.0) and bool((np.diff(first) == 1.0).all()))
    return tuple(range(skip, min(skip + 3, width)))


def _read_block(block: bytes, layout: Layout, first_line: int, last_line: int) -> Floats:
    """The points of one block, (k, 2 or 3); lines are counted from 1, the last one of the file is where it may be cut off."""
    plain = block.translate(layout.table)
    if not plain.translate(None, NUMERIC):
        try:
            numbers = parse_numbers(plain)
        except ValueError:
            pass
        else:
            words = tokens_per_line(plain)
            if len(numbers) == len(words) * layout.width and (words == layout.width).all():
                return numbers.reshape(-1, layout.width)[:, layout.columns]
    rows = []
    for number, line in enumerate(block.split(b"\n"), start=first_line):
        text = line.strip()
        if not text or text.startswith(COMMENT):
            continue
        if len(text) > LONGEST_LINE:
            raise _too_long(number)
        values = _values(text, layout.table)
        cut = ": it is the last line, the file may be cut off; the whole file would be right" if number == last_line else ""
        if values is None:
            if not any(48 <= letter <= 57 for letter in text):
                continue  # a heading between the points: a point has digits
            shown = text[:40].decode("ascii", errors="replace")
            raise InputError(f"line {number:,}: {shown!r} are not {layout.width} numbers{cut}")
        if len(values) < layout.width and cut:
            raise InputError(
                f"line {number:,} has {counted(len(values), 'column')}, line {layout.first_line:,} has {layout.width}{cut}"
            )
        if _is_count(values):
            raise InputError(f"line {number:,} has 1 column like the count of a further cloud: one cloud per file would be right")
        if len(values) != layout.width:
            raise InputError(
                f"line {number:,} has {counted(len(values), 'column')}, line {layout.first_line:,} has {layout.width}: as many in every line would be right"
            )
        rows.append(values)
    return np.array(rows, np.float64).reshape(-1, layout.width)[:, layout.columns]

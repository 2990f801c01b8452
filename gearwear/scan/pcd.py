"""Points from PCD (Point Cloud Library): ascii, binary and binary_compressed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import check_count, parse_numbers, short_by
from gearwear.scan.pieces import Pieces, numbers_of, rows_of

TYPES = {"I": "i", "U": "u", "F": "f"}
MOST_FIELDS = 10_000
LONGEST_HEADER = 1 << 20
LZF_MOST = 88
"""Bytes that a byte of LZF can become: 264 of three."""


def read_pcd(data: bytes) -> Contents:
    """Read the fields x, y, z and, where there are any, normal_x, normal_y, normal_z.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    Contents

    Raises
    ------
    InputError
        If it is no PCD, is cut off, or its header does not fit what follows.
    """
    header, start = _header(data)
    row, count = _row(header), _count(header)
    body = data[start:]
    match header["DATA"]:
        case ["ascii"]:
            columns = _ascii(body, row, count)
        case ["binary"]:
            check_count("points", count, row.itemsize, len(body))
            check_memory(points=count)
            rows = np.frombuffer(body, row, count)
            columns = {name: rows[name] for name in row.names or ()}
        case ["binary_compressed"]:
            columns = _compressed(body, row, count)
        case other:
            raise InputError(
                f"DATA {' '.join(other)[:40]!r} of the PCD header: ascii, binary or binary_compressed would be right"
            )
    points = _stack(columns, count, "x", "y", "z")
    if points is None:
        raise InputError("the PCD header has no FIELDS x, y and z: such fields would be right")
    return Contents(points, _stack(columns, count, "normal_x", "normal_y", "normal_z"))


def pcd_pieces(path: Path) -> Pieces | None:
    """The points of a PCD, piece by piece; None for binary_compressed, and coordinates that are lists.

    Parameters and errors as `read_pcd`.
    """
    with path.open("rb") as file:
        header, start = _header(file.read(LONGEST_HEADER))
        size = file.seek(0, 2)
    if header["DATA"] not in (["ascii"], ["binary"]):
        return None
    row, count = _row(header), _count(header)
    names = row.names or ()
    if any(axis not in names or row[axis].shape for axis in "xyz"):
        return None
    if header["DATA"] == ["ascii"]:
        widths = [int(np.prod(row[name].shape)) for name in names]
        check_count("points", count, 2 * sum(widths), size - start + 1)
        columns = [sum(widths[: names.index(axis)]) for axis in "xyz"]
        return Pieces(count, lambda: numbers_of(path, start, count, sum(widths), columns))
    check_count("points", count, row.itemsize, size - start)
    return Pieces(count, lambda: rows_of(path, start, count, row, "xyz"))


def _stack(columns: dict[str, Floats], count: int, *names: str) -> Floats | None:
    if any(name not in columns or columns[name].ndim > 1 for name in names):
        return None
    stacked = np.empty((count, 3))
    for i, name in enumerate(names):
        stacked[:, i] = columns[name]
    return stacked


def _header(data: bytes) -> tuple[dict[str, list[str]], int]:
    """The header's entries, and where the points start."""
    entries: dict[str, list[str]] = {}
    start = 0
    while "DATA" not in entries:
        stop = data.find(b"\n", start, start + 1_000_000) + 1
        if not stop or len(entries) > 100:
            raise InputError('does not start with a PCD header ("FIELDS" … "DATA"): a PCD file would be right')
        words = data[start:stop].split(b"#")[0].decode("ascii", errors="replace").split()
        if words:
            entries[words[0].upper()] = words[1:]
        start = stop
    return entries, start


def _count(header: dict[str, list[str]]) -> int:
    """The number of points; POINTS, else WIDTH × HEIGHT."""
    sizes = [header.get(key, [""])[0] if header.get(key) else "" for key in ("POINTS", "WIDTH", "HEIGHT")]
    if not all(size.isdecimal() and len(size) < 16 for size in sizes if size) or not (sizes[0] or (sizes[1] and sizes[2])):
        raise InputError(f"POINTS, WIDTH, HEIGHT of the PCD header are {sizes}: whole numbers would be right")
    count = int(sizes[0] or int(sizes[1]) * int(sizes[2]))
    if sizes[1] and sizes[2] and int(sizes[1]) * int(sizes[2]) != count:
        raise InputError(
            f"the PCD header says POINTS {count:,} and {sizes[1]} × {sizes[2]}: the same number twice would be right"
        )
    return count


def _row(header: dict[str, list[str]]) -> np.dtype[np.void]:
    """One point as the header describes it; fields of one name keep the first."""
    names = header.get("FIELDS", [])
    sizes, kinds = header.get("SIZE", []), header.get("TYPE", [])
    counts = header.get("COUNT", ["1"] * len(names))
    if not names or len({len(names), len(sizes), len(kinds), len(counts)}) > 1 or len(names) > MOST_FIELDS:
        raise InputError("FIELDS, SIZE, TYPE and COUNT of the PCD header differ in length: one entry per field would be right")
    row: list[tuple[str, str, tuple[int, ...]]] = []
    seen: set[str] = set()
    for i, (name, size, kind, count) in enumerate(zip(names, sizes, kinds, counts, strict=True)):
        if kind not in TYPES or size not in ("1", "2", "4", "8") or (kind == "F" and size == "1") or not count.isdecimal():
            raise InputError(
                f"field {name[:20]!r} of the PCD header has TYPE {kind[:9]} SIZE {size[:9]} COUNT {count[:9]}: I, U or F, 1, 2, 4 or 8 bytes would be right"
            )
        if not 0 < int(count[:9]) <= MOST_FIELDS:
            raise InputError(f"field {name[:20]!r} of the PCD header has COUNT {count[:20]}: 1 for coordinates would be right")
        row.append(
            (f"_{i}" if name in seen or name == "_" else name, f"<{TYPES[kind]}{size}", (int(count),) if count != "1" else ())
        )
        seen.add(name)
    return np.dtype(row)


def _ascii(body: bytes, row: np.dtype[np.void], count: int) -> dict[str, Floats]:
    width = sum(int(np.prod(row[name].shape)) for name in row.names or ())
    check_count("points", count, 2 * width, len(body) + 1)
    check_memory(points=count, other=5 * len(body))
    try:
        numbers = parse_numbers(body)
    except ValueError:
        raise InputError("something after the PCD header is no number: numbers and nothing else would be right") from None
    if len(numbers) != count * width:
        raise short_by("points", count, len(numbers) // width)
    table = numbers.reshape(count, width)
    columns, at = {}, 0
    for name in row.names or ():
        wide = int(np.prod(row[name].shape))
        columns[name] = table[:, at] if wide == 1 else table[:, at : at + wide]
        at += wide
    return columns


def _compressed(body: bytes, row: np.dtype[np.void], count: int) -> dict[str, Floats]:
    """Fields one after the other, compressed as a whole by LZF."""
    check_count("bytes of sizes", 8, 1, len(body))
    packed, size = (int(value) for value in np.frombuffer(body, "<u4", 2))
    check_count("compressed bytes", packed, 1, len(body) - 8)
    if size != count * row.itemsize:
        raise short_by("points", count, size // row.itemsize)
    check_count("bytes", size, 1, LZF_MOST * packed)
    check_memory(points=count, other=size)
    plain = unpack_lzf(body[8 : 8 + packed], size)
    columns, at = {}, 0
    for name in row.names or ():
        kind = row[name]
        columns[name] = np.frombuffer(plain, kind, count, at)
        at += count * kind.itemsize
    return columns


def unpack_lzf(packed: bytes, size: int) -> bytes:
    """Undo LZF (M. Lehmann's LibLZF): runs of literals and copies of what came before.

    Parameters
    ----------
    packed : bytes
        Compressed.
    size : int
        Bytes that must come out.

    Returns
    -------
    bytes

    Raises
    ------
    InputError
        If it does not come out at `size`.

    Examples
    --------
    >>> unpack_lzf(bytes([0, 65, 0x80, 0]), 7)
    b'AAAAAAA'
    """
    out = bytearray()
    at, end = 0, len(packed)
    try:
        while at < end and len(out) <= size:
            control = packed[at]
            at += 1
            if control < 32:
                out += packed[at : at + control + 1]
                at += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += packed[at]
                at += 1
            length += 2
            back = ((control & 31) << 8) + packed[at] + 1
            at += 1
            first = len(out) - back
            if first < 0:
                break
            if back >= length:
                out += out[first : first + length]
            else:  # the copy runs into itself: a repeated pattern
                out += (out[first:] * (length // back + 1))[:length]
    except IndexError:
        pass
    if at != end or len(out) != size:
        raise InputError(f"the compressed points unpack to {len(out):,} bytes and {size:,} were promised: the file is damaged")
    return bytes(out)

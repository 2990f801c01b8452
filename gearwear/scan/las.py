"""Points from LAS and LAZ: read by laspy, imported only when such a file comes."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.errors import InputError
from gearwear.memory import allowed, check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import MOST_UNPACKED, check_count, not_installed, short_by
from gearwear.scan.pieces import PIECE, Pieces

RECORD_HEAD, EXTENDED_RECORD_HEAD, HEADER = 54, 60, 375
"""Least bytes of a variable length record of the header, and of one after the points; bytes of the longest header."""

UNPACK = """
import io, sys, laspy
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, 2 * (int(sys.argv[1]),))
except (ImportError, ValueError, OSError):
    pass  # not on every system; the counts of the header were checked
out = io.BytesIO()
laspy.read(io.BytesIO(sys.stdin.buffer.read())).write(out, do_compress=False)
sys.stdout.buffer.write(out.getvalue())
"""
UNPACK_PIECES = """
import sys, laspy, numpy
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, 2 * (int(sys.argv[1]),))
except (ImportError, ValueError, OSError):
    pass  # not on every system
out = sys.stdout.buffer
total = 0
with laspy.open(sys.argv[2]) as file:
    for cloud in file.chunk_iterator(int(sys.argv[3])):
        points = numpy.column_stack([numpy.asarray(cloud.x), numpy.asarray(cloud.y), numpy.asarray(cloud.z)]).astype("<f8")
        total += len(points)
        out.write(numpy.int64(len(points)).tobytes() + points.tobytes() + numpy.asarray(cloud.withheld, bool).tobytes())
    if total == file.header.point_count:
        out.write(numpy.int64(-1).tobytes())
"""
"""The same, piece by piece: number of points, coordinates, which are withheld; −1 at the end."""
BESIDE = 2_000_000_000
"""Bytes of addresses that Python, numpy and the threads of lazrs take up without using them."""
SLOWEST = 50_000
"""Bytes of LAZ per second, beyond a minute, after which unpacking has hung."""


def read_las(data: bytes) -> Contents:
    """Read the points of a LAS or LAZ; those flagged as withheld are left out and counted.

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
        If laspy (with lazrs for LAZ) is missing or the file is damaged.
    """
    try:
        import laspy
    except ImportError:
        raise not_installed("LAS", "laspy") from None
    _check_header(data, len(data))
    if data[104] & 0xC0:  # the bits that mark a LAZ
        data = _unpack(data)
    with laspy.open(BytesIO(data), closefd=False) as file:
        header = file.header
        check_count("points", header.point_count, header.point_format.size, max(len(data) - header.offset_to_point_data, 0))
        check_memory(points=header.point_count, other=2 * len(data))
        cloud = file.read()
    points = np.column_stack([np.asarray(cloud.x), np.asarray(cloud.y), np.asarray(cloud.z)]).astype(np.float64)
    withheld = np.asarray(cloud.withheld, bool)
    return _without(points, withheld)


def las_pieces(path: Path) -> Pieces:
    """The points of a LAS or LAZ, piece by piece; parameters and errors as `read_las`."""
    try:
        import laspy
    except ImportError:
        raise not_installed("LAS", "laspy") from None
    with path.open("rb") as file:
        head = file.read(HEADER)
        size = file.seek(0, 2)
    _check_header(head, size)
    if head[104] & 0xC0:
        points, _ = _packed_counts(head, size)
        return Pieces(points, lambda: _unpacked_pieces(path))
    with laspy.open(path) as opened:
        count, start, row = opened.header.point_count, opened.header.offset_to_point_data, opened.header.point_format.size
    check_count("points", count, row, max(size - start, 0))
    return Pieces(count, lambda: _laspy_pieces(path, count))


def _laspy_pieces(path: Path, count: int) -> Iterator[Contents]:
    import laspy

    total = 0
    with laspy.open(path) as file:
        for cloud in file.chunk_iterator(PIECE):
            points = np.column_stack([np.asarray(cloud.x), np.asarray(cloud.y), np.asarray(cloud.z)]).astype(np.float64)
            withheld = np.asarray(cloud.withheld, bool)
            total += len(points)
            yield _without(points, withheld)
    if total < count:
        raise short_by("points", count, total)


def _unpacked_pieces(path: Path) -> Iterator[Contents]:
    """The pieces of a LAZ, from a process of its own."""
    command = [sys.executable, "-c", UNPACK_PIECES, str(allowed() + BESIDE), str(path), str(PIECE)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as child:
        assert child.stdout is not None
        try:
            while True:
                size = np.frombuffer(child.stdout.read(8), "<i8")
                if not len(size):
                    raise _damaged()
                if size[0] < 0:
                    return
                data = child.stdout.read(25 * int(size[0]))
                if len(data) < 25 * int(size[0]):
                    raise _damaged()
                points = np.frombuffer(data, "<f8", 3 * int(size[0])).reshape(-1, 3)
                yield _without(points, np.frombuffer(data, bool, int(size[0]), points.nbytes))
        finally:
            child.kill()


def _without(points: Floats, withheld: Bools) -> Contents:
    return Contents(points[~withheld], rejected={"invalid": int(withheld.sum())} if withheld.any() else {})


def _damaged() -> InputError:
    return InputError("the compressed points of the LAZ are damaged: a complete, undamaged file would be right")


def _check_header(data: bytes, size: int) -> None:
    """Refuse what is no LAS, and counts of records that laspy would go through one by one."""
    if data[:4] != b"LASF" or len(data) < 227:
        raise InputError('does not start with a LAS header ("LASF"): a LAS or LAZ file would be right')
    check_count("header records", int.from_bytes(data[100:104], "little"), RECORD_HEAD, size)
    if data[25] >= 4 and len(data) > 247:
        check_count("extended records", int.from_bytes(data[243:247], "little"), EXTENDED_RECORD_HEAD, size)


def _unpack(data: bytes) -> bytes:
    """LAZ to LAS, in a process of its own: on a damaged file lazrs ends the process it runs in."""
    points, size = _packed_counts(data, len(data))
    check_memory(points=points, other=3 * points * size)
    try:
        child = subprocess.run(
            [sys.executable, "-c", UNPACK, str(allowed() + BESIDE)],
            input=data, capture_output=True, check=True, timeout=60 + len(data) / SLOWEST,
        )  # fmt: skip
    except subprocess.SubprocessError:
        raise _damaged() from None
    return child.stdout


def _packed_counts(head: bytes, held: int) -> tuple[int, int]:
    """Points of a LAZ of `held` bytes, and bytes that each has once unpacked."""
    if find_spec("lazrs") is None:
        raise not_installed("LAZ", "lazrs")
    points = max(int.from_bytes(head[107:111], "little"), int.from_bytes(head[247:255], "little") if head[25] >= 4 else 0)
    size = max(int.from_bytes(head[105:107], "little"), 1)
    check_count("points", points, size, MOST_UNPACKED * held)
    return points, size

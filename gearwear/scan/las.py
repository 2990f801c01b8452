"""Points from LAS and LAZ: read by laspy, imported only when such a file comes."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from io import BytesIO

import numpy as np

from gearwear.errors import InputError
from gearwear.memory import allowed, check_memory
from gearwear.scan.parsing import MOST_UNPACKED, check_count, not_installed
from gearwear.scan.types import Contents

RECORD_HEAD, EXTENDED_RECORD_HEAD = 54, 60
"""Least bytes of a variable length record of the header, and of one after the points."""

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
    _check_header(data)
    if data[104] & 0xC0:  # the bits that mark a LAZ
        data = _unpack(data)
    with laspy.open(BytesIO(data), closefd=False) as file:
        header = file.header
        check_count("points", header.point_count, header.point_format.size, max(len(data) - header.offset_to_point_data, 0))
        check_memory(points=header.point_count, other=2 * len(data))
        cloud = file.read()
    points = np.column_stack([np.asarray(cloud.x), np.asarray(cloud.y), np.asarray(cloud.z)]).astype(np.float64)
    withheld = np.asarray(cloud.withheld, bool)
    return Contents(points[~withheld], rejected={"invalid": int(withheld.sum())} if withheld.any() else {})


def _check_header(data: bytes) -> None:
    """Refuse what is no LAS, and counts of records that laspy would go through one by one."""
    if data[:4] != b"LASF" or len(data) < 227:
        raise InputError('does not start with a LAS header ("LASF"): a LAS or LAZ file would be right')
    check_count("header records", int.from_bytes(data[100:104], "little"), RECORD_HEAD, len(data))
    if data[25] >= 4 and len(data) > 247:
        check_count("extended records", int.from_bytes(data[243:247], "little"), EXTENDED_RECORD_HEAD, len(data))


def _unpack(data: bytes) -> bytes:
    """LAZ to LAS, in a process of its own: on a damaged file lazrs ends the process it runs in."""
    if find_spec("lazrs") is None:
        raise not_installed("LAZ", "lazrs")
    points = max(int.from_bytes(data[107:111], "little"), int.from_bytes(data[247:255], "little") if data[25] >= 4 else 0)
    size = max(int.from_bytes(data[105:107], "little"), 1)
    check_count("points", points, size, MOST_UNPACKED * len(data))
    check_memory(points=points, other=3 * points * size)
    try:
        child = subprocess.run(
            [sys.executable, "-c", UNPACK, str(allowed() + BESIDE)],
            input=data, capture_output=True, check=True, timeout=60 + len(data) / SLOWEST,
        )  # fmt: skip
    except subprocess.SubprocessError:
        raise InputError("the compressed points of the LAZ are damaged: a complete, undamaged file would be right") from None
    return child.stdout

"""Triangles from STL, ASCII and binary; the normals in the file are not used."""

from __future__ import annotations

import re

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import check_count, parse_numbers, short_by

HEAD, RECORD = 84, 50
LEAST_LINES = 5
"""Lines of a triangle in words: the head of the loop may stand beside that of the facet."""
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VERTEX = re.compile(rb"^[ \t]*vertex[ \t]+(.*)$", re.MULTILINE | re.IGNORECASE)
ASCII_WORD = re.compile(rb"\b(facet|endsolid)\b", re.IGNORECASE)
END_FACET = re.compile(rb"^[ \t]*endfacet\b", re.MULTILINE | re.IGNORECASE)
END_SOLID = re.compile(rb"^[ \t]*endsolid\b", re.MULTILINE | re.IGNORECASE)


def read_stl(data: bytes) -> Contents:
    """Read triangles as three corners each; equal corners are merged later.

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
        If it is no STL, is cut off, or its header does not fit what follows.
    """
    # A binary file may start with "solid" too, but has no facet in words.
    ascii_ = (
        data[:512].lstrip()[:5].lower() == b"solid" and b"\0" not in data[:HEAD] and ASCII_WORD.search(data[:65536]) is not None
    )
    corners = _ascii(data) if ascii_ else _binary(data)
    return Contents(corners, triangles=np.arange(len(corners)).reshape(-1, 3))


def _binary(data: bytes) -> Floats:
    if len(data) < HEAD:
        raise InputError(f"has {len(data)} bytes and is no ASCII STL: a binary STL has {HEAD} and {RECORD} for every triangle")
    count = int(np.frombuffer(data, "<u4", 1, 80)[0])
    check_count("triangles", count, RECORD, len(data) - HEAD)
    surplus = len(data) - HEAD - count * RECORD
    if surplus >= RECORD:
        raise short_by("triangles", count, (len(data) - HEAD) // RECORD)
    check_memory(triangles=count)
    return np.frombuffer(data, TRIANGLE, count, HEAD)["corners"].reshape(-1, 3).astype(np.float64)


def _ascii(data: bytes) -> Floats:
    data = data if b"\n" in data else data.replace(b"\r", b"\n")
    check_memory(triangles=data.count(b"\n") // LEAST_LINES, other=2 * len(data))
    lines = VERTEX.findall(data)
    try:
        numbers = parse_numbers(b"\n".join(lines))
    except ValueError:
        raise InputError('a "vertex" line of the STL holds something else than numbers: "vertex x y z" would be right') from None
    facets = len(END_FACET.findall(data))
    if not END_SOLID.search(data) or len(lines) != 3 * facets:
        raise InputError(
            f'the STL is cut off: {len(lines):,} "vertex" lines, {facets:,} "endfacet"; three to one and an "endsolid" would be right'
        )
    if len(numbers) != 3 * len(lines):
        raise InputError('a "vertex" line of the STL has other than 3 numbers: "vertex x y z" would be right')
    return numbers.reshape(-1, 3)

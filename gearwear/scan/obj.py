"""Points and triangles from OBJ and OFF, the two text formats of surfaces."""

from __future__ import annotations

import re

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import check_count, parse_numbers, short_by, tokens_per_line
from gearwear.scan.triangles import check_indices, fan

VERTEX = re.compile(rb"^[ \t]*v[ \t]+(.*)$", re.MULTILINE)
FACE = re.compile(rb"^[ \t]*f[ \t]+(.*)$", re.MULTILINE)
BESIDE = re.compile(rb"/[^\s]*")
"""Texture and normal indices of an OBJ corner: 7/1/3."""
LINE = 100
"""Bytes that a line takes while it is a Python object of its own."""
OFF_HEAD = re.compile(rb"\s*(ST)?C?N?OFF\b")


def read_obj(data: bytes) -> Contents:
    """Read the vertices and faces of an OBJ; colours, textures, normals, lines and curves are left.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    Contents
        Without triangles if there is no face.

    Raises
    ------
    InputError
        If vertices or faces cannot be read.
    """
    if b"\0" in data:
        raise InputError("holds zero bytes, so it is binary, not an OBJ: a text file would be right")
    check_memory(other=LINE * data.count(b"\n") + 3 * len(data))
    data = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    vertices = VERTEX.findall(data)
    check_memory(points=len(vertices), other=3 * len(data))
    points = _coordinates(b"\n".join(vertices), "v")
    faces = b"\n".join(FACE.findall(data))
    if not faces:
        return Contents(points)
    corner, start, length = _rows(BESIDE.sub(b"", faces), "f")
    relative = corner < 0
    if relative.any():  # counted back from the vertices read so far
        vertex_at = [match.start() for match in VERTEX.finditer(data)]
        so_far = np.searchsorted(vertex_at, [match.start() for match in FACE.finditer(data)])
        corner = np.where(relative, np.repeat(so_far, length) + corner, corner - 1)
    else:
        corner = corner - 1
    return Contents(points, triangles=check_indices(fan(corner, start, length), len(points)))


def read_off(data: bytes) -> Contents:
    """Read the vertices and faces of an OFF (COFF, NOFF, STOFF too); colours and normals are left.

    Parameters
    ----------
    data : bytes
        The file: one vertex or face per line.

    Returns
    -------
    Contents
        Without triangles if there is no face.

    Raises
    ------
    InputError
        If it is no OFF, is cut off, or its header does not fit what follows.
    """
    head = OFF_HEAD.match(data)
    if head is None or b"\0" in data:
        raise InputError('does not start with "OFF" as text: an ASCII OFF file would be right')
    check_memory(other=LINE * data.count(b"\n") + 3 * len(data))
    lines = [line for line in re.sub(rb"#[^\n]*", b"", data[head.end() :]).splitlines() if line.strip()]
    counts = lines[0].split() if lines else []
    if len(counts) < 2 or not all(count.isdigit() and len(count) < 16 for count in counts[:2]):
        raise InputError('the second line of the OFF is not "vertices faces edges": three whole numbers would be right')
    vertices, faces = int(counts[0]), int(counts[1])
    check_count("vertices and faces", vertices + faces, 1, len(lines) - 1)
    if len(lines) - 1 > vertices + faces:
        raise short_by("vertices and faces", vertices + faces, len(lines) - 1)
    check_memory(points=vertices, triangles=faces, other=3 * len(data))
    points = _coordinates(b"\n".join(lines[1 : 1 + vertices]), "vertex")
    if not faces:
        return Contents(points)
    flat, start, words = _rows(b"\n".join(lines[1 + vertices :]), "face")
    corners = flat[start]
    if not ((corners >= 0) & (corners < words)).all():
        raise InputError("a face of the OFF lists fewer corners than it announces: a complete file would be right")
    return Contents(points, triangles=check_indices(fan(flat, start + 1, corners), len(points)))


def _coordinates(text: bytes, what: str) -> Floats:
    """The first three numbers of each line, (n, 3)."""
    words = tokens_per_line(text)
    numbers = _numbers(text, what)
    if not words.size:
        return np.empty((0, 3))
    if words.min() < 3 or len(numbers) != words.sum():
        raise InputError(f'a "{what}" line has fewer than 3 numbers: x y z would be right')
    start = np.cumsum(words) - words
    return np.asarray(numbers[start[:, None] + np.arange(3)])


def _rows(text: bytes, what: str) -> tuple[Ints, Ints, Ints]:
    """Whole numbers of all lines, where each line starts among them, and how many it has."""
    words = tokens_per_line(text)
    numbers = _numbers(text, what)
    if len(numbers) != words.sum():
        raise InputError(f'a "{what}" line holds something else than indices: whole numbers would be right')
    whole = np.where(np.abs(numbers) < 2.0**53, numbers, -1.0).astype(np.int64)
    return whole, np.cumsum(words) - words, words


def _numbers(text: bytes, what: str) -> Floats:
    try:
        return parse_numbers(text)
    except ValueError:
        raise InputError(f'a "{what}" line holds something else than numbers: numbers would be right') from None

"""Points and triangles from PLY: ASCII and binary, either byte order, any further elements and properties."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import check_count
from gearwear.scan.pieces import Pieces, numbers_of, rows_of
from gearwear.scan.ply_values import Element, PlyTable, Property, check_left_over, read_ascii, read_binary
from gearwear.scan.triangles import check_indices, fan

TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
    "int64": "i8",
    "uint64": "u8",
}
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_HEADER = 1 << 20


def read_ply(data: bytes) -> Contents:
    """Read vertices, their normals if there are any, and faces (polygons are cut into triangles).

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
        If it is no PLY, is cut off, or its header does not fit what follows.
    """
    order, elements, start = _header(data)
    vertex = next((e for e in elements if e.name == "vertex"), None)
    if vertex is None or None in [vertex.index(axis) for axis in "xyz"]:
        raise InputError('the PLY header has no element "vertex" with the properties x, y and z: such an element would be right')
    empty = next((e for e in elements if e.count and not e.properties), None)
    if empty is not None:
        raise InputError(
            f"the PLY header promises {empty.count:,} rows of {empty.name!r} without a property: at least one would be right"
        )
    tables = read_binary(data, start, elements, order) if order else read_ascii(data[start:], elements)
    points = _stack(vertex, tables["vertex"], "x", "y", "z")
    if points is None:
        raise InputError("x, y or z of the PLY vertices is a list: single numbers would be right")
    return Contents(points, _stack(vertex, tables["vertex"], "nx", "ny", "nz"), _triangles(elements, tables, len(points)))


def ply_pieces(path: Path) -> Pieces | None:
    """The vertices of a PLY of points alone, piece by piece; None where there are faces, or vertices hold lists or come later.

    Parameters and errors as `read_ply`.
    """
    with path.open("rb") as file:
        head = file.read(LONGEST_HEADER)
        order, elements, start = _header(head)
        size = file.seek(0, 2)
    vertex = elements[0] if elements else None
    if vertex is None or vertex.name != "vertex" or any(e.count for e in elements[1:]):
        return None
    names = [p.name.lower() for p in vertex.properties]
    if any(p.count for p in vertex.properties) or not all(names.count(axis) == 1 for axis in "xyz"):
        return None
    columns = [names.index(axis) for axis in "xyz"]
    if not order:
        check_count("vertex rows", vertex.count, 2 * len(names), size - start + 1)
        return Pieces(vertex.count, lambda: numbers_of(path, start, vertex.count, len(names), columns))
    row = np.dtype([(f"v{i}", order + p.type) for i, p in enumerate(vertex.properties)])
    check_count("vertex rows", vertex.count, row.itemsize, size - start)
    check_left_over(size - start - vertex.count * row.itemsize, "bytes")
    return Pieces(vertex.count, lambda: rows_of(path, start, vertex.count, row, [f"v{i}" for i in columns]))


def _stack(vertex: Element, table: PlyTable, *names: str) -> Floats | None:
    """Three properties as columns; None if one is missing or a list."""
    places = [vertex.index(name) for name in names]
    columns = [table.columns[place] for place in places if place in table.columns]
    if len(columns) < len(names):
        return None
    stacked = np.empty((vertex.count, len(names)))
    for i, column in enumerate(columns):
        stacked[:, i] = column
    return stacked


def _triangles(elements: list[Element], tables: dict[str, PlyTable], vertices: int) -> Ints | None:
    face = next((e for e in elements if e.name in ("face", "faces")), None)
    place = None if face is None else face.index("vertex_indices", "vertex_index")
    if face is None or place not in tables[face.name].lists:
        return None
    flat, start, length = tables[face.name].lists[place]
    triangles = fan(np.asarray(flat), start, length)
    return check_indices(triangles, vertices) if len(triangles) else None


def _header(data: bytes) -> tuple[str, list[Element], int]:
    """Byte order ("" is ASCII), elements, and where the values start."""
    ended = re.search(rb"^end_header", data[:LONGEST_HEADER].replace(b"\r", b"\n"), re.M)  # a comment may hold the word too
    if not data.startswith(b"ply") or ended is None:
        raise InputError('does not start with a PLY header ("ply" … "end_header"): a PLY file would be right')
    end, start = ended.span()
    start += 2 if data[start : start + 2] == b"\r\n" else 1
    order: str | None = None
    elements: list[tuple[str, int, list[Property]]] = []
    for number, line in enumerate(data[:end].decode("ascii", errors="replace").splitlines(), start=1):
        match line.split():
            case ["format", name, *_] if name in ORDERS:
                order = ORDERS[name]
            case ["element", name, count] if count.isdecimal() and len(count) < 16:
                elements.append((name, int(count), []))
            case ["property", "list", count, kind, name] if elements and kind in TYPES and TYPES.get(count, "f")[0] in "iu":
                elements[-1][2].append(Property(name, TYPES[kind], TYPES[count]))
            case ["property", kind, name] if elements and kind in TYPES:
                elements[-1][2].append(Property(name, TYPES[kind]))
            case [] | ["ply"] | ["comment", *_] | ["obj_info", *_]:
                pass
            case _:
                raise InputError(
                    f"line {number} of the PLY header is {line[:60]!r}: a format, element, property or comment would be right"
                )
    if order is None:
        raise InputError(f"the PLY header has no line 'format': one of {', '.join(ORDERS)} would be right")
    return order, [Element(name, count, tuple(properties)) for name, count, properties in elements], start

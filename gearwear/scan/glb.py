"""Triangles and points from GLB, the binary form of glTF 2.0 (Khronos Group, ISO/IEC 12113)."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import check_count
from gearwear.scan.placed import Surface, assemble

HEAD, CHUNK = 12, 8
PER_BYTE = 40
"""Bytes of Python objects that a byte of the description can become: an empty list of three characters."""
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
POINTS, TRIANGLES, STRIP, FAN = 0, 4, 5, 6
"""Kinds of primitives that are read; the others are lines."""
Tree = dict[str, Any]


def read_glb(data: bytes) -> Contents:
    """Read all triangles and points of a binary glTF that its scene shows.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    Contents
        In the file's numbers: glTF says metres, exporters of scans rarely keep to it.

    Raises
    ------
    InputError
        If it is no GLB, is cut off, counts more than it holds, or is compressed by an extension.
    """
    magic, version, length = struct.unpack("<4sII", data[:HEAD].ljust(HEAD))
    if magic != b"glTF" or version != 2:
        raise InputError('does not start with "glTF" and version 2: a binary glTF file (.glb) would be right')
    check_count("bytes", length, 1, len(data))
    chunks = dict(_chunks(data[:length]))
    description = chunks.get(b"JSON", b"")
    check_memory(other=PER_BYTE * len(description))
    tree = json.loads(description)
    needed = [name for name in tree.get("extensionsRequired", []) if "draco" in name.lower() or "meshopt" in name.lower()]
    if needed:
        raise InputError(f"is compressed by {str(needed[0])[:40]}: a GLB without compression would be right")
    return assemble(_placed(tree, chunks.get(b"BIN\0", b"")))


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    start = HEAD
    while start + CHUNK <= len(data):
        length, kind = struct.unpack_from("<I4s", data, start)
        check_count("bytes of a chunk", length, 1, len(data) - start - CHUNK)
        yield kind, data[start + CHUNK : start + CHUNK + length]
        start += CHUNK + length


def _placed(tree: Tree, binary: bytes) -> Iterator[tuple[Surface, Floats]]:
    """Every primitive of every node of the scene, with where it is placed."""
    nodes, groups = tree.get("nodes", []), tree.get("meshes", [])
    surfaces: dict[int, list[Surface]] = {}
    below = {child for node in nodes for child in node.get("children", [])}
    roots = [i for i in range(len(nodes)) if i not in below]
    if tree.get("scenes"):
        roots = tree["scenes"][tree.get("scene", 0)].get("nodes", [])
    stack: list[tuple[int, Floats]] = [(_index(root, nodes), np.eye(4)) for root in roots]
    seen: set[int] = set()
    while stack:
        number, above = stack.pop()
        if number in seen:
            raise InputError(f"node {number} of the GLB stands below two others or below itself: a tree of nodes would be right")
        seen.add(number)
        node = nodes[number]
        place = above @ _matrix(node)
        stack += [(_index(child, nodes), place) for child in node.get("children", [])]
        if "mesh" in node:
            group = _index(node["mesh"], groups)
            if group not in surfaces:
                surfaces[group] = [one for one in (_surface(tree, binary, p) for p in groups[group]["primitives"]) if one]
            for surface in surfaces[group]:
                yield surface, place


def _index(value: Any, among: list[Any]) -> int:
    """A reference into a list, refused where nothing is there."""
    if not isinstance(value, int) or not 0 <= value < len(among):
        raise InputError(
            f"the GLB refers to entry {str(value)[:20]} of a list of {len(among):,}: an entry that is there would be right"
        )
    return value


def _matrix(node: Tree) -> Floats:
    """What a node does to what is below it, (4, 4): its matrix (stored by columns), or translation · rotation · scale."""
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    result = np.eye(4)
    x, y, z, w = (float(value) for value in node.get("rotation", (0, 0, 0, 1)))
    norm = math.sqrt(x * x + y * y + z * z + w * w) or 1.0
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    result[:3, :3] = rotation * np.array(node.get("scale", (1, 1, 1)), np.float64)
    result[:3, 3] = node.get("translation", (0, 0, 0))
    return result


def _surface(tree: Tree, binary: bytes, primitive: Tree) -> Surface | None:
    """A primitive, counted and not read; None for lines and for what has no place."""
    mode = primitive.get("mode", TRIANGLES)
    if mode not in (POINTS, TRIANGLES, STRIP, FAN) or "POSITION" not in primitive["attributes"]:
        return None
    accessors = tree.get("accessors", [])
    position = accessors[_index(primitive["attributes"]["POSITION"], accessors)]
    points = _checked(tree, binary, position)
    corners = accessors[_index(primitive["indices"], accessors)] if "indices" in primitive else None
    count = points if corners is None else _checked(tree, binary, corners)
    triangles = {POINTS: 0, TRIANGLES: count // 3}.get(mode, max(count - 2, 0))

    def read() -> tuple[Floats, Ints]:
        vertices = _values(tree, binary, position).astype(np.float64).reshape(-1, 3)
        order = np.arange(points) if corners is None else _values(tree, binary, corners).ravel().astype(np.int64)
        return vertices, _corners(order, mode, triangles)

    return Surface(points, triangles, read)


def _corners(order: Ints, mode: int, triangles: int) -> Ints:
    """Indices of the corners, (m, 3), from the order in which a primitive lists them."""
    if mode == TRIANGLES:
        return order[: 3 * triangles].reshape(-1, 3)
    if mode == STRIP:  # every second one the other way round
        faces = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)[:triangles]
        faces[1::2] = faces[1::2, [1, 0, 2]]
        return faces
    if mode == FAN:
        return np.stack([np.full(triangles, order[:1].sum()), order[1:-1], order[2:]], axis=1)
    return np.empty((0, 3), np.int64)


def _checked(tree: Tree, binary: bytes, accessor: Tree) -> int:
    """How many values an accessor has; refused where the file does not hold them."""
    count = int(accessor["count"])
    kind, width, start, step = _layout(tree, accessor)
    check_count("values", count, step, max(len(binary) - start + step - kind.itemsize * width, 0))
    if count < 0 or start < 0 or step < 1 or "sparse" in accessor:
        raise InputError("an accessor of the GLB is sparse or has a negative place: values one after the other would be right")
    return count


def _layout(tree: Tree, accessor: Tree) -> tuple[np.dtype[Any], int, int, int]:
    """Type, values in a row, first byte, and bytes from row to row."""
    if "bufferView" not in accessor:  # would be filled with zeros
        raise InputError(
            f"the GLB promises {int(accessor['count']):,} values and holds none of them: a complete file would be right"
        )
    views, buffers = tree.get("bufferViews", []), tree.get("buffers", [])
    view = views[_index(accessor["bufferView"], views)]
    if view.get("buffer", 0) != 0 or (buffers and "uri" in buffers[0]):
        raise InputError("the GLB keeps its points in another file: a GLB that holds them would be right")
    kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
    start = int(view.get("byteOffset", 0)) + int(accessor.get("byteOffset", 0))
    return kind, width, start, int(view.get("byteStride") or kind.itemsize * width)


def _values(tree: Tree, binary: bytes, accessor: Tree) -> Floats:
    """An accessor's values, (count, width); integers that stand for −1 … 1 as such."""
    kind, width, start, step = _layout(tree, accessor)
    count = int(accessor["count"])
    if not count:
        return np.empty((0, width))
    values = np.ndarray((count, width), kind, binary, start, (step, kind.itemsize))
    if accessor.get("normalized") and kind.kind in "iu":
        return np.maximum(values / np.iinfo(kind).max, -1.0)
    return np.asarray(values)

"""Triangles from 3MF and GLB, which hold whole scenes: read by trimesh, imported only when such a file comes."""

from __future__ import annotations

import json
import struct
import zipfile
from io import BytesIO
from typing import Any

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.scan.parsing import MOST_UNPACKED, check_count
from gearwear.scan.triangles import check_indices
from gearwear.scan.types import Contents

UNITS_3MF = {"micron": "um", "millimeter": "mm", "centimeter": "cm", "meter": "m", "inch": "in", "foot": "ft"}


def read_3mf(data: bytes) -> Contents:
    """Read all that a 3MF builds, in the unit that it states.

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
        If it is no 3MF or unpacks to an absurd size.
    """
    if not zipfile.is_zipfile(BytesIO(data)):
        raise InputError("is not a 3MF (a zip archive), or is cut off: a complete 3MF file would be right")
    with zipfile.ZipFile(BytesIO(data)) as archive:
        unpacked = sum(entry.file_size for entry in archive.infolist())
        if unpacked > MOST_UNPACKED * len(data):
            raise InputError(
                f"the 3MF archive would unpack to {unpacked:,} bytes: no scan is as repetitive; a real 3MF file would be right"
            )
        if archive.testzip() is not None:
            raise InputError("the 3MF archive is damaged (a checksum is wrong): a complete file would be right")
    return _surface(data, "3mf")


def read_glb(data: bytes) -> Contents:
    """Read all meshes and point clouds of a binary glTF.

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
        If it is no GLB, is cut off, or counts more than it holds.
    """
    magic, _, length, first = struct.unpack("<4sIII", data[:16].ljust(16))
    if magic != b"glTF":
        raise InputError('does not start with "glTF": a binary glTF file (.glb) would be right')
    check_count("bytes", length, 1, len(data))
    check_count("bytes of description", first, 1, len(data) - 20)
    description = json.loads(data[20 : 20 + first])
    for accessor in description.get("accessors", []):  # an accessor without data would be filled with zeros
        check_count("values", int(accessor["count"]), 1, len(data))
    return _surface(data, "glb")


def _surface(data: bytes, kind: str) -> Contents:
    """Everything in a trimesh scene, placed where the scene puts it."""
    import trimesh

    loaded: Any = trimesh.load(BytesIO(data), file_type=kind, process=False)
    scene = loaded if isinstance(loaded, trimesh.Scene) else trimesh.Scene(loaded)
    none: Ints = np.empty((0, 3), np.int64)
    points: list[Floats] = [np.empty((0, 3))]
    triangles, count, unit = [none], 0, None
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        piece = scene.geometry[name]
        unit = unit or piece.metadata.get("units") or scene.units
        vertices = np.asarray(piece.vertices, np.float64).reshape(-1, 3)
        if not np.array_equal(place, np.eye(4)):
            vertices = vertices @ place[:3, :3].T + place[:3, 3]
        faces = check_indices(np.asarray(getattr(piece, "faces", none), np.int64).reshape(-1, 3), len(vertices))
        if np.linalg.det(place[:3, :3]) < 0.0:  # a mirror image turns its triangles inside out
            faces = faces[:, ::-1]
        points.append(vertices)
        triangles.append(faces + count)
        count += len(vertices)
    stated = UNITS_3MF.get(str(unit).removesuffix("s")) if kind == "3mf" else None
    faces = np.concatenate(triangles)
    return Contents(np.concatenate(points), triangles=faces if len(faces) else None, units=stated)

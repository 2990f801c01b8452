"""Solids as binary glTF 2.0 (GLB) with a colour at every vertex; what a browser, Blender or a phone opens."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.report.figures.colours import NOT_SEEN, ColourScale, paint
from gearwear.wear.solid import Triangles

# Metres with +y up, as glTF wants it, from millimetres with +z up: columns of a 4 × 4 matrix.
_PLACE = [0.001, 0.0, 0.0, 0.0, 0.0, 0.0, -0.001, 0.0, 0.0, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
_FLOAT, _UINT, _BYTE = 5126, 5125, 5121
_ARRAY, _INDICES = 34962, 34963


@dataclass(frozen=True, slots=True)
class Painted:
    """A closed body to show.

    Parameters
    ----------
    name : str
    triangles : Triangles
        mm.
    colour : (n, 3) float
        Red, green, blue of every vertex, sRGB, 0 … 1.
    """

    name: str
    triangles: Triangles
    colour: Floats


def painted(name: str, triangles: Triangles, deviation_um: Floats, scale: ColourScale) -> Painted:
    """A body in the colours of the report's signed scale.

    Parameters
    ----------
    name : str
    triangles : Triangles
    deviation_um : (n,) float
        At every vertex; nan is grey.
    scale : ColourScale
    """
    return Painted(name, triangles, paint(deviation_um, scale))


def grey_ends(body: Painted) -> Painted:
    """The same with end faces of their own corners and no colour: theirs is that of the flanks they meet."""
    vertices, faces = body.triangles.vertices, body.triangles.faces
    flat = np.ptp(vertices[faces, 2], axis=1) == 0.0
    used, corners = np.unique(faces[flat], return_inverse=True)
    own = faces.copy()
    own[flat] = corners.reshape(-1, 3) + len(vertices)
    grey = np.full((len(used), 3), NOT_SEEN)
    return Painted(body.name, Triangles(np.vstack([vertices, vertices[used]]), own), np.vstack([body.colour, grey]))


def write_glb(path: Path, bodies: Sequence[Painted]) -> None:
    """Write bodies as one GLB: a node and a mesh each.

    Parameters
    ----------
    path : Path
    bodies : sequence of Painted
        Single precision: 0.004 µm at 50 mm. A node's matrix turns and scales them to metres with +y up.
    """
    chunks: list[bytes] = []
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []

    def add(data: bytes, target: int, **accessor: Any) -> int:
        views.append({"buffer": 0, "byteOffset": sum(map(len, chunks)), "byteLength": len(data), "target": target})
        chunks.append(data + b"\0" * (-len(data) % 4))
        accessors.append({"bufferView": len(views) - 1, **accessor})
        return len(accessors) - 1

    surfaces, nodes = [], []
    for body in bodies:
        vertices = body.triangles.vertices.astype("<f4")
        count = len(vertices)
        where = add(
            vertices.tobytes(), _ARRAY, componentType=_FLOAT, count=count, type="VEC3",
            min=vertices.min(axis=0).tolist(), max=vertices.max(axis=0).tolist(),
        )  # fmt: skip
        # glTF takes vertex colours as linear light; sRGB to linear by IEC 61966-2-1.
        linear = np.where(body.colour <= 0.04045, body.colour / 12.92, ((body.colour + 0.055) / 1.055) ** 2.4)
        rgba = np.column_stack([np.rint(255.0 * linear), np.full(count, 255.0)]).astype(np.uint8)
        tint = add(rgba.tobytes(), _ARRAY, componentType=_BYTE, normalized=True, count=count, type="VEC4")
        faces = body.triangles.faces.astype("<u4")
        corners = add(faces.tobytes(), _INDICES, componentType=_UINT, count=faces.size, type="SCALAR")
        surfaces.append(
            {"name": body.name, "primitives": [{"attributes": {"POSITION": where, "COLOR_0": tint}, "indices": corners, "material": 0}]}
        )  # fmt: skip
        nodes.append({"name": body.name, "mesh": len(surfaces) - 1, "matrix": _PLACE})
    data = b"".join(chunks)
    document = {
        "asset": {"version": "2.0", "generator": "gearwear"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": surfaces,
        "materials": [{"name": "metal", "pbrMetallicRoughness": {"metallicFactor": 0.1, "roughnessFactor": 0.7}}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, length)
        + struct.pack("<I4s", len(text), b"JSON") + text
        + struct.pack("<I4s", len(data), b"BIN\0") + data
    )  # fmt: skip

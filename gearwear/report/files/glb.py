"""Solids as binary glTF 2.0 (GLB) with a colour at every vertex; what a browser, Blender or a phone opens."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.report.figures.colours import NOT_SEEN, ColourScale, paint
from gearwear.wear.solid import Triangles

_PLACE = np.array([[0.001, 0.0, 0.0, 0.0], [0.0, 0.0, 0.001, 0.0], [0.0, -0.001, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Metres with +y up, as glTF wants it, from millimetres with +z up."""


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
    indices = faces.copy()
    indices[flat] = corners.reshape(-1, 3) + len(vertices)
    grey = np.full((len(used), 3), NOT_SEEN)
    return Painted(body.name, Triangles(np.vstack([vertices, vertices[used]]), indices), np.vstack([body.colour, grey]))


def write_glb(path: Path, bodies: Sequence[Painted]) -> None:
    """Write bodies as one GLB: a node and a mesh each.

    Parameters
    ----------
    path : Path
    bodies : sequence of Painted
        Single precision: 0.004 µm at 50 mm. A node's matrix turns and scales them to metres with +y up.
    """
    import trimesh

    scene: Any = trimesh.Scene()
    for body in bodies:
        # glTF takes vertex colours as linear light; sRGB to linear by IEC 61966-2-1.
        linear = np.where(body.colour <= 0.04045, body.colour / 12.92, ((body.colour + 0.055) / 1.055) ** 2.4)
        rgba = np.column_stack([np.rint(255.0 * linear), np.full(len(linear), 255.0)]).astype(np.uint8)
        triangles = trimesh.Trimesh(body.triangles.vertices, body.triangles.faces, vertex_colors=rgba, process=False)
        scene.add_geometry(triangles, geom_name=body.name, transform=_PLACE)
    path.write_bytes(scene.export(file_type="glb", tree_postprocessor=_finished))


def _finished(document: dict[str, Any]) -> None:
    """What trimesh leaves to its user: a surface that is hardly metallic, or colours come out dark."""
    document["asset"]["generator"] = "gearwear"
    document["materials"] = [{"name": "metal", "pbrMetallicRoughness": {"metallicFactor": 0.1, "roughnessFactor": 0.7}}]
    for body in document["meshes"]:
        for primitive in body["primitives"]:
            primitive["material"] = 0

"""Solids as files: binary STL and 3MF."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from gearwear.wear.solid import Triangles

_CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>"
)
_STAMP = (2000, 1, 1, 0, 0, 0)
"""The same bytes on every run."""
LEVEL = 4
"""Of compression: a third of the usual one's time, for a twentieth more bytes."""
AT_ONCE = 1 << 15
"""Triangles that are worked out before they are written: those of all of a large gear take more room than its scan."""


def write_stl(path: Path, bodies: Sequence[Triangles], name: str) -> None:
    """Write closed bodies as one binary STL.

    Parameters
    ----------
    path : Path
    bodies : sequence of Triangles
        mm; written one after the other. STL is single precision: 0.004 µm at 50 mm.
    name : str
        Goes into the header.
    """
    record = np.dtype([("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("attribute", "<u2")])
    header = f"{name}, mm, written by gearwear".encode("ascii", "replace")[:80].ljust(80)
    with path.open("wb") as file:
        file.write(header + np.uint32(sum(len(body.faces) for body in bodies)).astype("<u4").tobytes())
        for body in bodies:
            for start in range(0, len(body.faces), AT_ONCE):
                some = Triangles(body.vertices, body.faces[start : start + AT_ONCE])
                normal, data = some.normals, np.zeros(len(some.faces), record)
                length = np.linalg.norm(normal, axis=1, keepdims=True)
                data["normal"] = normal / np.where(length > 0.0, length, 1.0)
                data["corner"] = some.vertices[some.faces]
                file.write(data.tobytes())


def write_3mf(path: Path, bodies: Sequence[Triangles], names: Sequence[str]) -> None:
    """Write closed bodies as one 3MF, an object each (3MF Core Specification 1.3), mm.

    Parameters
    ----------
    path : Path
    bodies : sequence of Triangles
    names : sequence of str
        One per body.
    """
    objects, items = [], []
    for number, (body, name) in enumerate(zip(bodies, names, strict=True), start=1):
        # One format for the whole body: half the time of one a line.
        vertices = '<vertex x="%.9g" y="%.9g" z="%.9g"/>' * len(body.vertices) % tuple(body.vertices.ravel().tolist())
        triangles = '<triangle v1="%d" v2="%d" v3="%d"/>' * len(body.faces) % tuple(body.faces.ravel().tolist())
        objects.append(
            f'<object id="{number}" name="{escape(name)}" type="model"><mesh><vertices>{vertices}</vertices>'
            f"<triangles>{triangles}</triangles></mesh></object>"
        )
        items.append(f'<item objectid="{number}"/>')
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<model unit="millimeter" xml:lang="en" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<metadata name="Application">gearwear</metadata><resources>{"".join(objects)}</resources><build>{"".join(items)}</build></model>'
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member, text in (("[Content_Types].xml", _CONTENT_TYPES), ("_rels/.rels", _RELATIONS), ("3D/3dmodel.model", model)):
            info = zipfile.ZipInfo(member, _STAMP)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, text, compresslevel=LEVEL)

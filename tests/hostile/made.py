"""Files made on purpose to break a reader, each a few lines of code; what they did to version 0.1.0 stands beside them."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from collections.abc import Callable

import numpy as np

HUGE = 10**400


def glb(tree: dict[str, object], binary: bytes) -> bytes:
    """A binary glTF of a description and its numbers."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def strip(nodes: list[dict[str, object]], roots: list[int], primitives: int = 1, points: int = 50_000) -> bytes:
    """A GLB of one strip of triangles, with nodes that place it."""
    vertices = np.random.default_rng(0).uniform(-40.0, 40.0, (points, 3)).astype("<f4").tobytes()
    order = np.repeat(np.arange(points - 2, dtype="<u4"), 3).reshape(-1, 3) + np.arange(3, dtype="<u4")
    corners = order[: points // 3].tobytes()
    one = {"attributes": {"POSITION": 0}, "indices": 1}
    return glb(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": roots}],
            "nodes": nodes,
            "meshes": [{"primitives": [one] * primitives}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": points, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5125, "count": len(corners) // 4, "type": "SCALAR"},
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": len(vertices)},
                {"buffer": 0, "byteOffset": len(vertices), "byteLength": len(corners)},
            ],
            "buffers": [{"byteLength": len(vertices) + len(corners)}],
        },
        vertices + corners,
    )


def threemf(model: str) -> bytes:
    """A 3MF archive of one model."""
    out = io.BytesIO()
    head = '<?xml version="1.0"?><model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", f"{head}{model}</model>")
        archive.writestr("filler", np.random.default_rng(0).bytes(20_000))
    return out.getvalue()


def nested_components(levels: int, each: int) -> bytes:
    """Objects that place the one before them `each` times: each to the power of `levels` triangles."""
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    first = f'<object id="0"><mesh><vertices>{vertices}</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>'
    others = "".join(
        f'<object id="{i}"><components>{f"<component objectid={chr(34)}{i - 1}{chr(34)}/>" * each}</components></object>'
        for i in range(1, levels + 1)
    )
    return threemf(f'<resources>{first}{others}</resources><build><item objectid="{levels}"/></build>')


def ply(elements: str) -> bytes:
    head = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
    return f"{head}{elements}end_header\n".encode()


def laz(points: int, promised: int) -> bytes:
    """Points all equal, which compress to almost nothing, and a header that promises more."""
    import laspy

    file = laspy.create(point_format=3, file_version="1.2")
    file.x = file.y = file.z = np.zeros(points)
    out = io.BytesIO()
    file.write(out, do_compress=True)
    data = bytearray(out.getvalue())
    data[107:111] = promised.to_bytes(4, "little")
    return bytes(data)


def long_line(length: int) -> bytes:
    rows = np.random.default_rng(0).uniform(-40.0, 40.0, (3000, 3))
    return b"(" * length + b"\n" + "".join(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in rows).encode()


SCANS: dict[str, Callable[[], bytes]] = {
    "no_property.ply": lambda: ply("element foo 400000000\n"),  # 3 GB from 130 bytes
    "lists.ply": lambda: ply("element foo 1\n" + "property list uchar int a\n" * 25_000) + b"0 " * 25_000,  # a copy per list
    "instances.glb": lambda: strip([{"mesh": 0}] * 2000, list(range(2000))),  # 2,000 times 50,000 points
    "primitives.glb": lambda: strip([{"mesh": 0}], [0], primitives=2000),
    "deep.glb": lambda: strip(
        [{"children": [i + 1]} for i in range(20_000)] + [{"mesh": 0}], [0], points=1000
    ),  # the square of the depth
    "circle.glb": lambda: strip([{"children": [1]}, {"children": [0], "mesh": 0}], [0]),  # without end
    "twice.glb": lambda: strip([{"children": [i + 1, i + 1]} for i in range(40)] + [{"mesh": 0}], [0], points=300),  # 2^40
    "components.3mf": lambda: nested_components(12, 10),  # 10^12 triangles
    "bomb.laz": lambda: laz(100_000, 100_000_000),  # 205 kB unpacked to 3 GB
    "hidden_bomb.laz": lambda: laz(1_500_000, 1_500_000)[:-1] + b"\xff",
    "brackets.xyz": lambda: long_line(300_000),  # the square of the length
    "brackets_apart.xyz": lambda: (b"(x " * 100_000) + long_line(0),
    "columns.xyz": lambda: (b"1.5 " * 100_000 + b"\n") * 40,  # 100,000 columns
    "one_line.csv": lambda: b"1.5," * 5_000_000,
    "sizes.off": lambda: polygons(1200),  # the number of polygons times that of their sizes
}
"""Scans by name."""


def polygons(most: int) -> bytes:
    """An OFF whose faces have 3, 4, 5 … corners."""
    rows = "\n".join(f"{i % 7} {i % 11} {i % 13}" for i in range(most))
    faces = "\n".join(f"{n} " + " ".join(map(str, range(n))) for n in range(3, most))
    return f"OFF\n{most} {most - 3} 0\n{rows}\n{faces}\n".encode()


ONE = "[gear]\nteeth = {teeth}\nmodule = {module}\nface_width = 10\n{more}"
DESIGNS: dict[str, Callable[[], bytes]] = {
    "teeth_tip.toml": lambda: ONE.format(teeth=HUGE, module=1, more="tip_diameter = 12").encode(),  # OverflowError
    "teeth_root.toml": lambda: ONE.format(teeth=HUGE, module=1, more="root_diameter = 12").encode(),
    "ten_thousand.toml": lambda: ONE.format(teeth=10_000, module=1, more="").encode(),  # without end
    "thousand.toml": lambda: ONE.format(teeth=1000, module=1, more="").encode(),
    "dotted.toml": lambda: b".".join([b"a"] * 20_000) + b" = 1\n",  # 1.6 GB from 40 kB
    "dotted_quoted.toml": lambda: b"x = {" + b" . ".join([b'"a"'] * 20_000) + b" = 1}\n",
    "nested.toml": lambda: b"a = " + b"[" * 200_000,
    "large.toml": lambda: b"# " + b"x" * 5_000_000,
    "module_0.csv": lambda: b"teeth,12\nmodule,0,mm\naddendum,1,mm\n",  # ZeroDivisionError
    "module_tiny.csv": lambda: b"teeth,12\nmodule,1e-320,mm\naddendum,1e300,mm\n",
    "field.csv": lambda: b"teeth," + b"1" * 200_000 + b"\n",  # csv.Error
    "encoding_foo.xml": lambda: b'<?xml version="1.0" encoding="foo"?><model version="1"/>',  # LookupError
    "encoding_multi.xml": lambda: b'<?xml version="1.0" encoding="shift_jis"?><model version="1"/>',  # ValueError
    "encoding_7.xml": lambda: b'<?xml version="1.0" encoding="utf-7"?><model version="1"/>',
    "deep.xml": lambda: b"<a>" * 300_000,
    "entities.xml": lambda: (
        b'<!DOCTYPE m [<!ENTITY a "xxxxxxxxxx">'
        + b"".join(b'<!ENTITY %c "%s">' % (98 + i, b"&%c;" % (97 + i) * 10) for i in range(9))
        + b"]><model>&j;</model>"
    ),
}
"""Designs by name."""


def npz(**arrays: tuple[str, str] | np.ndarray) -> bytes:
    """An NPZ; instead of an array (type, shape) as words, with nothing behind the header."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in arrays.items():
            whole = io.BytesIO()
            if isinstance(value, tuple):
                head = f"{{'descr': '{value[0]}', 'fortran_order': False, 'shape': {value[1]}, }}".encode()
                head += b" " * (-(len(head) + 11) % 64) + b"\n"
                whole.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head)
            else:
                np.save(whole, value)
            archive.writestr(f"{name}.npy", whole.getvalue())
    return out.getvalue()

"""Files written without any code of gearwear: by plyfile, trimesh, pye57, laspy, or byte by byte from the format's text."""

from __future__ import annotations

import io
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def ball(points: int = 400, seed: int = 0) -> Floats:
    """Points of a sphere of radius 40 mm, exactly representable in single precision, no two alike."""
    v = np.random.default_rng(seed).normal(size=(points, 3))
    return (40.0 * v / np.linalg.norm(v, axis=1)[:, None]).astype(np.float32).astype(np.float64)


def torus(around: int = 24, tube: int = 10) -> tuple[Floats, Ints]:
    """Closed surface, outward triangles; 2 · around · tube of them; exact in single precision and in ten decimals."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(tube) * 2 * np.pi / tube, indexing="ij")
    ring = 30.0 + 8.0 * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), 8.0 * np.sin(v)], axis=-1).reshape(-1, 3)
    points = np.round(1024.0 * points) / 1024.0
    a = np.arange(around * tube).reshape(around, tube)
    b, d = np.roll(a, -1, axis=0), np.roll(a, -1, axis=1)
    c = np.roll(b, -1, axis=1)
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return points, faces


# ---- clouds ------------------------------------------------------------------------------------


def ply(points: Floats, *, text: bool = False, order: str = "<", kind: str = "f4") -> bytes:
    """By plyfile, with a further property before and after the coordinates."""
    from plyfile import PlyData, PlyElement

    rows = np.zeros(len(points), [("quality", "u1"), ("x", kind), ("y", kind), ("z", kind), ("intensity", "f4")])
    for i, axis in enumerate("xyz"):
        rows[axis] = points[:, i]
    rows["quality"] = np.arange(len(points)) % 256
    out = io.BytesIO()
    PlyData([PlyElement.describe(rows, "vertex")], text=text, byte_order="=" if text else order).write(out)
    return out.getvalue()


def xyz(points: Floats) -> bytes:
    return "".join(" ".join(f"{value!r}" for value in map(float, row)) + "\n" for row in points).encode()


def pcd(points: Floats, data: str = "binary") -> bytes:
    """Fields x y z rgb in the order of the PCD 0.7 text; compressed ones as literal runs and one repetition for rgb."""
    n = len(points)
    head = f"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {n}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA {data}\n".encode()
    if data == "ascii":
        return head + "".join(" ".join(f"{value!r}" for value in map(float, row)) + " 255\n" for row in points).encode()
    coordinates = points.astype("<f4")
    if data == "binary":
        rows = np.zeros(n, [("p", "<f4", 3), ("rgb", "<u4")])
        rows["p"] = coordinates
        return head + rows.tobytes()
    plain = coordinates.T.tobytes()
    packed = b"".join(bytes([len(part) - 1]) + part for part in (plain[i : i + 32] for i in range(0, len(plain), 32)))
    packed += b"\x00\x07"  # one byte 7 …
    left = 4 * n - 1
    while left >= 3:  # … and copies of the byte before
        length = min(left, 264)
        packed += bytes([0xE0, length - 9, 0]) if length >= 9 else bytes([(length - 2) << 5, 0])
        left -= length
    packed += b"".join(b"\x00\x07" for _ in range(left))
    return head + struct.pack("<II", len(packed), 16 * n) + packed


def e57(points: Floats) -> bytes:
    import pye57

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scan.e57"
        file = pye57.E57(str(path), mode="w")
        file.write_scan_raw({f"cartesian{axis}": points[:, i].copy() for i, axis in enumerate("XYZ")})
        file.close()
        return path.read_bytes()


def las(points: Floats, *, compress: bool = False) -> bytes:
    import laspy

    file = laspy.create(point_format=3, file_version="1.2")
    file.header.scales = np.full(3, 1e-6)
    file.x, file.y, file.z = points.T
    out = io.BytesIO()
    file.write(out, do_compress=compress)
    return out.getvalue()


# ---- triangles ---------------------------------------------------------------------------------


def stl(points: Floats, faces: Ints) -> bytes:
    """Binary, with empty normals, as some exporters write them."""
    out = b"exported by a scanner".ljust(80) + struct.pack("<I", len(faces))
    return out + b"".join(struct.pack("<12fH", 0, 0, 0, *points[face].ravel(), 0) for face in faces)


def stl_text(points: Floats, faces: Ints) -> bytes:
    lines = ["solid part"]
    for face in faces:
        corners = [f"      vertex {x!r} {y!r} {z!r}" for x, y, z in points[face].tolist()]
        lines += ["  facet normal 0 0 0", "    outer loop", *corners, "    endloop", "  endfacet"]
    return "\n".join([*lines, "endsolid part"]).encode()


def by_trimesh(kind: str) -> Callable[[Floats, Ints], bytes]:
    def write(points: Floats, faces: Ints) -> bytes:
        import trimesh

        out = trimesh.Trimesh(points, faces, process=False).export(
            file_type=kind, **({"digits": 17} if kind in ("obj", "off") else {})
        )
        return out.encode() if isinstance(out, str) else bytes(out)

    return write


CLOUDS: dict[str, Callable[[Floats], bytes]] = {
    "little.ply": ply,
    "big.ply": lambda p: ply(p, order=">"),
    "double.ply": lambda p: ply(p, kind="f8"),
    "text.ply": lambda p: ply(p, text=True, kind="f8"),
    "a.xyz": xyz,
    "a.asc": xyz,
    "a.txt": lambda p: b"X Y Z\n" + xyz(p),
    "a.pts": lambda p: f"{len(p)}\n".encode() + xyz(p),
    "a.csv": lambda p: b"x,y,z\n" + xyz(p).replace(b" ", b","),
    "ascii.pcd": lambda p: pcd(p, "ascii"),
    "binary.pcd": pcd,
    "compressed.pcd": lambda p: pcd(p, "binary_compressed"),
    "a.e57": e57,
    "a.las": las,
    "a.laz": lambda p: las(p, compress=True),
}
SURFACES: dict[str, Callable[[Floats, Ints], bytes]] = {
    "binary.stl": stl,
    "text.stl": stl_text,
    **{f"a.{kind}": by_trimesh(kind) for kind in ("stl", "ply", "obj", "off", "3mf", "glb")},
}

"""Whatever is wrong with a file comes out as one line that names it, says what, and what would be right."""

from __future__ import annotations

import builtins
import gzip
import io
import json
import struct
import tracemalloc
import zipfile
from pathlib import Path

import pytest

from gearwear.errors import InputError
from gearwear.scan import READERS, read_one, read_scan
from tests.scan.writers import CLOUDS, SURFACES, ball, pcd, ply, stl, stl_text, torus, xyz


def message(path: Path, data: bytes | None = None, units: str = "mm") -> str:
    """The one line that reading gives."""
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(InputError) as error:
        read_one(path, units)
    line = str(error.value)
    assert line.startswith(str(path)) and "\n" not in line
    return line


def test_paths_that_are_no_scan(tmp_path: Path) -> None:
    assert "no such file" in message(tmp_path / "gone.ply")
    assert "is a folder" in message(tmp_path)
    assert "is empty" in message(tmp_path / "a.ply", b"")
    assert "is empty" in message(tmp_path / "a.ply.gz", gzip.compress(b""))
    for name in ("a.docx", "a", "a.gz", "a.step"):
        line = message(tmp_path / name, b"x")
        assert ".ply" in line and ".e57" in line
    with pytest.raises(InputError, match="no scan is given"):
        read_scan([])
    with pytest.raises(InputError, match="'furlong': one of mm, cm, m, um, in"):
        read_one(tmp_path / "a.ply", "furlong")


def test_a_section_beside_a_cloud_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("".join(f"{i},{i * i}\n" for i in range(40)))
    (tmp_path / "b.xyz").write_bytes(xyz(ball()))
    with pytest.raises(InputError, match=r"a\.csv is a planar section"):
        read_scan([tmp_path / "b.xyz", tmp_path / "a.csv"])


@pytest.mark.parametrize("ending", READERS)
@pytest.mark.parametrize(
    "garbage", [b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" * 40, bytes(range(256)) * 8, b"not a scan at all\n" * 30, b"\n", b"\0" * 500]
)
def test_garbage_under_any_name(tmp_path: Path, ending: str, garbage: bytes) -> None:
    message(tmp_path / f"a{ending}", garbage)


def test_truncated_files_say_what_was_promised_and_what_is_there(tmp_path: Path) -> None:
    data = ply(ball(400))  # 17 bytes a point
    assert "promises 400 vertex rows and the file has room for 399" in message(tmp_path / "a.ply", data[:-1])
    text = ply(ball(400), text=True)
    assert "promises 400 vertex rows and the file holds 399" in message(
        tmp_path / "a.ply", text[: text.rstrip().rfind(b"\n") + 3]
    )
    points, faces = torus()
    whole = stl(points, faces)
    assert "promises 480 triangles and the file has room for 240" in message(tmp_path / "a.stl", whole[: 84 + 50 * 240 + 49])
    words = stl_text(points, faces)
    assert "cut off" in message(tmp_path / "a.stl", words[: len(words) // 2])
    assert "promises 400 points and the file has room for 399" in message(tmp_path / "a.pcd", pcd(ball(400))[:-1])
    assert "promises 400 points and the file holds 399" in message(tmp_path / "a.pcd", pcd(ball(400), "ascii")[:-30])
    assert "no complete gzip" in message(tmp_path / "a.ply.gz", gzip.compress(data)[:-20])


@pytest.mark.parametrize("name", [*CLOUDS, *SURFACES])
def test_any_file_cut_in_half(tmp_path: Path, name: str) -> None:
    """A cut text of points alone cannot be told from a short one, unless its last line is short."""
    data = CLOUDS[name](ball(400)) if name in CLOUDS else SURFACES[name](*torus())
    half = data[: len(data) // 2]
    if name in ("a.xyz", "a.asc", "a.txt", "a.csv", "a.obj"):
        half = half[: half.rstrip().rfind(b"\n") + 5]
    message(tmp_path / name, half)


def test_headers_that_promise_too_little(tmp_path: Path) -> None:
    data = ply(ball(400)).replace(b"vertex 400", b"vertex 200")
    assert "3,400 bytes follow after all that the PLY header promises" in message(tmp_path / "a.ply", data)
    points, faces = torus()
    data = stl(points, faces)
    fewer = data[:80] + struct.pack("<I", 10) + data[84:]
    assert "promises 10 triangles and the file holds 480" in message(tmp_path / "a.stl", fewer)


HUGE = 999_999_999_999
ABSURD = {
    "a.ply": ply(ball()).replace(b"vertex 400", f"vertex {HUGE}".encode()),
    "text.ply": ply(ball(), text=True).replace(b"vertex 400", f"vertex {HUGE}".encode()),
    "a.pcd": pcd(ball()).replace(b"POINTS 400", f"POINTS {HUGE}".encode()).replace(b"WIDTH 400", f"WIDTH {HUGE}".encode()),
    "ascii.pcd": pcd(ball(), "ascii")
    .replace(b"POINTS 400", f"POINTS {HUGE}".encode())
    .replace(b"WIDTH 400", f"WIDTH {HUGE}".encode()),
    "lzf.pcd": pcd(ball(), "binary_compressed")
    .replace(b"POINTS 400", f"POINTS {HUGE}".encode())
    .replace(b"WIDTH 400", f"WIDTH {HUGE}".encode()),
    "a.stl": b" " * 80 + b"\xff\xff\xff\xff" + b" " * 500,
    "a.pts": f"{HUGE}\n".encode() + xyz(ball()),
    "a.off": f"OFF\n{HUGE} {HUGE} 0\n".encode() + xyz(ball()),
    "list.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint float x\nproperty float y\nproperty float z\nend_header\n"
    + b"\xff" * 100,
    "bomb.xyz.gz": b"",  # made where it is looked at
}


@pytest.mark.parametrize("name", ABSURD)
def test_an_absurd_count_costs_no_memory(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    data = ABSURD[name] or gzip.compress(b"0 0 0\n" * 20_000_000)
    path.write_bytes(data)
    tracemalloc.start()
    try:
        message(path)
        assert tracemalloc.get_traced_memory()[1] < 400 * len(data) + 2_000_000
    finally:
        tracemalloc.stop()


def test_a_glb_that_counts_more_than_it_holds(tmp_path: Path) -> None:
    data = SURFACES["a.glb"](*torus())
    length = struct.unpack_from("<I", data, 12)[0]
    tree = json.loads(data[20 : 20 + length])
    tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = len(tree["accessors"])
    tree["accessors"].append({"componentType": 5126, "count": HUGE, "type": "VEC3"})
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    made = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest
    assert f"promises {HUGE:,} values" in message(tmp_path / "a.glb", made)


def test_a_3mf_that_unpacks_to_an_absurd_size(tmp_path: Path) -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", b" " * 50_000_000)
    assert "would unpack to 50,000,000 bytes" in message(tmp_path / "a.3mf", out.getvalue())


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (b"property float x", b"property float a", 'no element "vertex" with the properties x, y and z'),
        (b"element vertex", b"element points", 'no element "vertex"'),
        (b"property float x", b"property flout x", "line 5 of the PLY header is 'property flout x'"),
        (b"vertex 400", b"vertex -400", "line 3 of the PLY header"),
        (b"format binary_little_endian 1.0\n", b"", "no line 'format'"),
        (b"format binary_little_endian", b"format binary_middle_endian", "line 2 of the PLY header"),
        (b"end_header", b"end_of_header", "does not start with a PLY header"),
        (b"property float x", b"property list uchar float x", ""),
    ],
)
def test_ply_headers(tmp_path: Path, old: bytes, new: bytes, says: str) -> None:
    assert says in message(tmp_path / "a.ply", ply(ball(400)).replace(old, new))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (b"FIELDS x y z rgb", b"FIELDS a y z rgb", "no FIELDS x, y and z"),
        (b"FIELDS x y z rgb", b"FIELDS x y z", "differ in length"),
        (b"TYPE F F F U", b"TYPE F F Q U", "I, U or F"),
        (b"SIZE 4 4 4 4", b"SIZE 4 4 5 4", "I, U or F"),
        (b"COUNT 1 1 1 1", b"COUNT 1 1 0 1", "COUNT 0"),
        (b"POINTS 400", b"POINTS 300", "the same number twice"),
        (b"POINTS 400", b"POINTS many", "whole numbers"),
        (b"DATA binary", b"DATA base64", "ascii, binary or binary_compressed"),
        (b"DATA", b"ATAD", "does not start with a PCD header"),
    ],
)
def test_pcd_headers(tmp_path: Path, old: bytes, new: bytes, says: str) -> None:
    assert says in message(tmp_path / "a.pcd", pcd(ball(400)).replace(old, new))


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "uses vertex 3 and there are 3"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "uses vertex -1"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", "uses vertex -1"),
        ("a.obj", "v 0 0\n", 'a "v" line has fewer than 3 numbers'),
        ("a.obj", "v 0 0 zero\n", "something else than numbers"),
        ("a.obj", "v 0 0 0\nf one two three\n", "something else than numbers"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "uses vertex 7"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "fewer corners than it announces"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "promises 4 vertices and faces"),
        ("a.off", "OFF\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", "holds 5"),
        ("a.off", "OFF\nthree one\n", "three whole numbers"),
        (
            "a.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid",
            "other than 3 numbers",
        ),
        (
            "a.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 o\nvertex 0 1 0\nendloop\nendfacet\nendsolid",
            "something else than numbers",
        ),
        ("a.stl", "solid nothing\nendsolid nothing\n", "holds 0 points"),
    ],
)
def test_surfaces_in_text(tmp_path: Path, name: str, text: str, says: str) -> None:
    assert says in message(tmp_path / name, text.encode())


def test_faces_of_a_ply_that_use_no_vertex(tmp_path: Path) -> None:
    points, faces = torus()
    data = SURFACES["a.ply"](points, faces + 1)
    assert "uses vertex 240 and there are 240" in message(tmp_path / "a.ply", data)


@pytest.mark.parametrize(("name", "package"), [("a.e57", "pye57"), ("a.las", "laspy")])
def test_a_package_that_is_not_installed_is_named(
    tmp_path: Path, name: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / name).write_bytes(CLOUDS[name](ball()))
    real = builtins.__import__

    def without(module: str, *rest: object) -> object:
        if module == package:
            raise ImportError(module)
        return real(module, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", without)
    assert 'pip install "gearwear[scans]"' in message(tmp_path / name)

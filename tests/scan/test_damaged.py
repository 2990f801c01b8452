"""Whole files damaged, read as a whole and in pieces: finite points of the right shape or one line, and no more memory than the file explains."""

from __future__ import annotations

import re
import struct
import tracemalloc
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.scan import read_one
from gearwear.scan.streaming import IN_PIECES
from gearwear.scan.types import Scan
from tests.hostile.structured import mended
from tests.scan.writers import CLOUDS, SURFACES, ball, e57, pcd, ply, torus

PER_BYTE, BESIDE = 2000, 20_000_000
"""Bytes of memory that a byte of the file may take: a point of two bytes 400 and Python objects beside it; and what a reader takes anyway."""
FEW = settings(max_examples=8, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))

place = st.floats(0.0, 1.0, exclude_max=True)
DAMAGE = st.lists(
    st.one_of(
        st.tuples(st.just("flip"), place, st.integers(0, 7)),
        st.tuples(st.just("cut"), place, st.none()),
        st.tuples(st.just("insert"), place, st.binary(min_size=1, max_size=40)),
        st.tuples(st.just("remove"), place, st.integers(1, 84)),
        st.tuples(st.just("repeat line"), place, st.sampled_from([2, 3, 500])),
        st.tuples(st.just("repeat block"), place, st.integers(1, 200)),
        st.tuples(st.just("count"), place, st.sampled_from([0, 1, 10**5, 10**7, 2**31 - 1, 2**32 - 1, 2**63 - 1])),
        st.tuples(st.just("digits"), place, st.sampled_from([b"", b"0", b"-1", b"99999", b"20000000", b"nan", b"\x1b[2J"])),
    ),
    min_size=1,
    max_size=3,
)


@cache
def whole(name: str) -> bytes:
    return CLOUDS[name](ball(110)) if name in CLOUDS else SURFACES[name](*torus(12, 9))


def damaged(data: bytes, damage: list[tuple[str, float, object]]) -> bytes:
    """Half of the places are in the first 300 bytes, which decide most."""
    for kind, where, how in damage:
        at = int(2.0 * where * min(len(data), 300)) if where < 0.5 else int((2.0 * where - 1.0) * len(data))
        match kind, how:
            case "flip", int(bit):
                data = data[:at] + bytes([data[at] ^ 1 << bit]) + data[at + 1 :] if at < len(data) else data
            case "cut", _:
                data = data[: max(at, 1)]
            case "insert", bytes(more):
                data = data[:at] + more + data[at:]
            case "remove", int(length):
                data = data[:at] + data[at + length :] or b"x"
            case "repeat line", int(times):
                start, stop = data.rfind(b"\n", 0, at) + 1, data.find(b"\n", at) + 1 or len(data)
                data = data[:start] + data[start:stop] * (times if stop - start < 400 else 2) + data[stop:]
            case "repeat block", int(length):
                data = data[: at + length] + data[at:]
            case "count", int(value):
                size = 4 if value < 2**32 else 8
                data = data[:at] + value.to_bytes(size, "little") + data[at + size :]
            case "digits", bytes(digits):
                found = re.compile(rb"\d+").search(data, at)
                data = data if found is None else data[: found.start()] + digits + data[found.end() :]
    return data


def sound(scan: Scan) -> bool:
    points, normals, triangles = scan.points, scan.normals, scan.triangles
    assert points.ndim == 2 and points.shape[1] == 3 and points.dtype == np.float64 and len(points) >= 30
    assert np.isfinite(points).all()
    assert normals is None or (normals.shape == points.shape and np.isfinite(normals).all())
    assert triangles is None or (triangles.shape[1:] == (3,) and 0 <= triangles.min() <= triangles.max() < len(points))
    return scan.chunks is None or sum(len(chunk) for chunk in scan.chunks if np.isfinite(chunk).all()) == len(scan.chunks)


def survives(path: Path, data: bytes, stream: bool) -> None:
    path.write_bytes(data)
    tracemalloc.start()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning is a second line
            assert sound(read_one(path, stream=stream))
    except InputError as error:
        assert str(error).startswith(f"{path}: ")
        assert all(letter >= " " and letter not in "\x7f\x85\u2028\u2029" for letter in str(error)) and len(str(error)) < 600
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < PER_BYTE * len(data) + BESIDE


FILES = [(name, stream) for name in (*CLOUDS, *SURFACES) for stream in (False, True)]


@pytest.mark.parametrize(
    ("name", "stream"),
    # of LAZ, a process for every example, as a whole in `test_fuzz`; .asc is .xyz
    [one for one in FILES if (not one[1] or Path(one[0]).suffix in IN_PIECES) and one[0] not in ("a.laz", "a.asc")],
)
@given(damage=DAMAGE)
@FEW
def test_a_damaged_file_is_read_or_refused(
    tmp_path: Path, name: str, stream: bool, damage: list[tuple[str, float, object]]
) -> None:
    data = damaged(whole(name), damage)
    survives(tmp_path / name, mended(data.ljust(len(whole(name)), b"\0")) if name == "a.e57" else data, stream)


def edited_e57(points: Floats, *edits: tuple[bytes, bytes]) -> bytes:
    """An E57 whose description says something else; its lengths and the sums of its pages are right."""
    data = e57(points)
    plain = b"".join(data[i : i + 1020] for i in range(0, len(data), 1024))
    start, length = struct.unpack_from("<QQ", plain, 24)
    start -= 4 * (start // 1024)
    xml = plain[start : start + length]
    for old, new in edits:
        xml = re.sub(old, new, xml)
    body = bytearray(plain[:start] + xml)
    body += bytes(-len(body) % 1020)
    struct.pack_into("<Q", body, 16, len(body) // 1020 * 1024)
    struct.pack_into("<Q", body, 32, len(xml))
    return mended(b"".join(bytes(body[i : i + 1020]) + bytes(4) for i in range(0, len(body), 1020)))


@pytest.mark.parametrize("stream", [False, True])
@pytest.mark.parametrize("said", [3001, 7_000_000])
def test_an_e57_of_fewer_points_than_it_says_is_refused_before_memory_is_taken(tmp_path, said, stream):
    """pye57 fills an array of the size that is said as far as the file goes, and hands on what memory held behind that."""
    path = tmp_path / "a.e57"
    for count in (b"3000", str(said).encode()):
        data = edited_e57(ball(3000), (rb'recordCount="\d+"', b'recordCount="%s"' % count))
        survives(path, data, stream)
        if count == b"3000":
            assert len(read_one(path, stream=stream)) == 3000
    with pytest.raises(InputError, match=f"promises {said:,} points and the file holds 3,000"):
        read_one(path, stream=stream)


@pytest.mark.parametrize("stream", [False, True])
def test_an_e57_of_ranges_and_angles_is_where_its_points_are(tmp_path, stream):
    points = ball(300)
    distance = np.linalg.norm(points, axis=1)
    fields = np.column_stack([distance, np.arctan2(points[:, 1], points[:, 0]), np.arcsin(points[:, 2] / distance)])
    names = [(b"cartesianX", b"sphericalRange"), (b"cartesianY", b"sphericalAzimuth"), (b"cartesianZ", b"sphericalElevation")]
    path = tmp_path / "a.e57"
    path.write_bytes(edited_e57(fields, *names))
    assert read_one(path, stream=stream).points == pytest.approx(points, abs=1e-5)


def test_a_word_of_a_damaged_header_moves_no_cursor(tmp_path):
    path = tmp_path / "a.pcd"
    path.write_bytes(pcd(ball(110)).replace(b"SIZE 4 4", b"SIZE 4 \x1b[2J\x9b4"))
    with pytest.raises(InputError, match=re.escape(r"SIZE \x1b[2J")) as refused:
        read_one(path)
    assert "\x1b" not in str(refused.value)


@pytest.mark.parametrize("stream", [False, True])
def test_a_signalling_nan_is_no_point_and_no_warning(tmp_path, stream):
    points = ball(300)
    data = ply(points, kind="f8").replace(struct.pack("<d", points[7, 1]), struct.pack("<Q", 0x7FF0_0000_0000_0001))
    survives(tmp_path / "a.ply", data, stream)
    assert read_one(tmp_path / "a.ply", stream=stream).rejected == {"non_finite": 1}

"""Damage at random: a file is read, or refused in one line. Nothing else comes out, and nothing hangs."""

from __future__ import annotations

import gzip
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearwear.errors import InputError
from gearwear.scan import READERS, read_one
from tests.scan.writers import CLOUDS, SURFACES, ball, torus

BOUNDED = settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@cache
def whole(name: str) -> bytes:
    return CLOUDS[name](ball(110)) if name in CLOUDS else SURFACES[name](*torus(12, 9))


def survives(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    try:
        scan = read_one(path)
    except InputError as error:
        assert str(error).startswith(str(path)) and "\n" not in str(error)
    else:
        assert len(scan) >= 30 and (abs(scan.points) <= 1e9).all()


@pytest.mark.parametrize(
    "name",
    # a process for every example of LAZ: that one cut or made to measure is refused `test_bad_files` and `test_structured` show
    [pytest.param(name, marks=[pytest.mark.long] * (name == "a.laz")) for name in (*CLOUDS, *SURFACES)],
)
@given(data=st.data())
@BOUNDED
def test_bytes_flipped_cut_and_inserted(tmp_path: Path, name: str, data: st.DataObject) -> None:
    damaged = bytearray(whole(name))
    # half of the damage goes to the header, which decides most
    places = st.integers(0, len(damaged) - 1) | st.integers(0, min(400, len(damaged) - 1))
    for _ in range(data.draw(st.integers(1, 4))):
        place = min(data.draw(places), len(damaged) - 1)
        match data.draw(st.sampled_from(["flip", "set", "cut", "insert", "remove"])):
            case "flip":
                damaged[place] ^= 1 << data.draw(st.integers(0, 7))
            case "set":
                damaged[place] = data.draw(st.sampled_from([0, 255, 48, 57, 45, 10, 32]))
            case "cut":
                del damaged[max(place, 1) :]
            case "insert":
                damaged[place:place] = data.draw(st.binary(min_size=1, max_size=40))
            case "remove":
                del damaged[place : place + data.draw(st.integers(1, 40))]
                damaged = damaged or bytearray(b"x")
    survives(tmp_path / name, bytes(damaged))


@pytest.mark.parametrize("ending", READERS)
@given(data=st.binary(max_size=300) | st.text(alphabet="0123456789.,;- \nvf/eEnaplyOFF", max_size=300).map(str.encode))
@BOUNDED
def test_random_bytes_under_any_name(tmp_path: Path, ending: str, data: bytes) -> None:
    survives(tmp_path / f"a{ending}", data)


@given(place=st.integers(0, 10_000), value=st.integers(0, 255))
@settings(BOUNDED, max_examples=60)
def test_damaged_gzip(tmp_path: Path, place: int, value: int) -> None:
    packed = bytearray(gzip.compress(whole("little.ply")))
    packed[place % len(packed)] = value
    survives(tmp_path / "a.ply.gz", bytes(packed))

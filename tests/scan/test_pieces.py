"""A file read piece by piece holds what it holds as a whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearwear.errors import InputError, NotEnoughMemory
from gearwear.memory import allowing
from gearwear.scan import READERS, e57, las, pieces, read_one, read_scan, streaming, text
from gearwear.scan.pieces import join
from gearwear.scan.streaming import IN_PIECES
from tests.scan.writers import CLOUDS, SURFACES, ball, pcd, ply, torus, xyz

WHOLE = {"compressed.pcd"}
"""What can only be read as a whole: the fields of compressed PCD stand one after the other."""
STREAMED = sorted(set(CLOUDS) - WHOLE)


@pytest.fixture(autouse=True)
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of a few hundred points in a handful of pieces."""
    for module in (pieces, las, e57, streaming):
        monkeypatch.setattr(module, "PIECE", 64)
    for module in (pieces, text):
        monkeypatch.setattr(module, "TEXT_PIECE", 3000)
    monkeypatch.setattr(streaming, "SAMPLE", 150)


def in_pieces(path: Path) -> pieces.Pieces:
    found = IN_PIECES[path.suffix](path)
    assert found is not None
    return found


@pytest.mark.parametrize("name", STREAMED)
def test_the_pieces_of_a_file_are_the_whole(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(CLOUDS[name](ball()))

    found = in_pieces(path)

    assert found.count == 400 and len(list(found.read())) > 3
    np.testing.assert_array_equal(join(found).points, READERS[path.suffix](path.read_bytes()).points)


@pytest.mark.parametrize("name", STREAMED)
def test_the_chunks_of_a_scan_are_its_clean_points_and_the_sample_is_of_them(tmp_path: Path, name: str) -> None:
    points = ball()
    path = tmp_path / name
    path.write_bytes(CLOUDS[name](points))

    scan, whole = read_one(path, "cm", stream=True), read_one(path, "cm")

    assert scan.chunks is not None and len(scan) == len(scan.chunks) == len(whole) == 400
    for _ in range(2):  # as often as is wanted
        np.testing.assert_array_equal(np.concatenate(list(scan.chunks)), whole.points)
    assert 100 <= len(scan.points) <= 150
    every = {tuple(point) for point in whole.points}
    assert len({tuple(point) for point in scan.points} & every) == len(scan.points)
    assert scan.sha256 == whole.sha256 and scan.units == whole.units == "cm"


def test_what_is_no_measurement_is_left_out_and_counted(tmp_path: Path) -> None:
    points = ball()
    points[5] = points[6]  # in one piece
    points[100, 1] = np.nan
    path = tmp_path / "a.ply"
    path.write_bytes(ply(points))

    scan = read_one(path, stream=True)

    assert scan.chunks is not None
    assert scan.rejected == {"duplicate": 1, "non_finite": 1} and len(scan) == 398
    np.testing.assert_array_equal(np.concatenate(list(scan.chunks)), np.delete(points, [6, 100], axis=0))


def test_withheld_points_of_las_are_left_out_of_every_pass(tmp_path: Path) -> None:
    import laspy

    for name in ("a.las", "a.laz"):
        path = tmp_path / name
        path.write_bytes(CLOUDS[name](ball()))
        cloud = laspy.read(path)
        cloud.withheld = np.arange(400) % 5 == 0
        cloud.write(path)

        scan, whole = read_one(path, stream=True), read_one(path)

        assert scan.rejected == whole.rejected == {"invalid": 80}
        assert scan.chunks is not None
        np.testing.assert_array_equal(np.concatenate(list(scan.chunks)), whole.points)


@pytest.mark.parametrize("name", STREAMED)
def test_a_file_cut_off_in_the_middle_ends_in_one_line(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    data = CLOUDS[name](ball())
    path.write_bytes(data[: int(0.63 * len(data)) + 1])

    if name in {"a.xyz", "a.asc", "a.txt", "a.csv"}:  # nothing tells where a text ends but a last line that is cut
        path.write_bytes(path.read_bytes() + b"\n1.0")
    with pytest.raises(InputError) as error:
        read_one(path, stream=True)

    said = str(error.value)
    assert said.startswith(f"{path}: ") and said.count(str(path)) == 1 and "\n" not in said and "would be right" in said


def test_a_line_of_text_that_is_wrong_is_named(tmp_path: Path) -> None:
    lines = xyz(ball()).splitlines()
    lines[300] = b"1.0 two 3.0"
    path = tmp_path / "a.xyz"
    path.write_bytes(b"\n".join(lines))

    with pytest.raises(InputError, match=r"a\.xyz: line 301: '1\.0 two 3\.0'"):
        read_one(path, stream=True)


def test_a_file_that_changes_between_passes_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.xyz"
    path.write_bytes(xyz(ball()))
    scan = read_one(path, stream=True)
    path.write_bytes(xyz(ball()[:100]))

    assert scan.chunks is not None
    with pytest.raises(InputError, match=r"a\.xyz: has changed while it was read"):
        list(scan.chunks)


@pytest.mark.parametrize(
    ("name", "data"),
    [("a.stl", lambda: SURFACES["binary.stl"](*torus())), ("a.ply.gz", lambda: ply(ball())), ("a.pcd", lambda: pcd(ball(), "binary_compressed"))],
)  # fmt: skip
def test_what_cannot_be_streamed_is_said(tmp_path: Path, name: str, data: object) -> None:
    path = tmp_path / name
    path.write_bytes(data())  # type: ignore[operator]

    with pytest.raises(InputError, match="cannot be streamed"):
        read_one(path, stream=True)


def test_views_are_not_streamed(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(ball()))

    with pytest.raises(InputError, match="2 views of one gear are not streamed"):
        read_scan([path, path], stream=True)


def test_a_scan_is_streamed_by_itself_where_it_is_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(ball()))
    assert read_one(path, stream=None).chunks is None

    monkeypatch.setattr(streaming, "STREAM_FROM", 400)

    assert read_one(path, stream=None).chunks is not None
    assert read_one(path, stream=False).chunks is None


def test_a_scan_too_large_for_the_memory_allowed_is_streamed_where_that_is_enough(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(ball()))

    with allowing(1e-4):  # 250 points: not the 400 of the scan, and the sample of 150 with a piece of 64
        with pytest.raises(NotEnoughMemory):
            read_one(path, stream=False)
        assert read_one(path, stream=None).chunks is not None
    with allowing(5e-5), pytest.raises(NotEnoughMemory):
        read_one(path, stream=None)

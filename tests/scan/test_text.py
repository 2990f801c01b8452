"""The many ways in which people write columns of numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.errors import InputError
from gearwear.scan import read_one
from gearwear.scan.text import BLOCK, read_text
from tests.scan.writers import ball, xyz

POINTS = np.round(ball(120), 4)


def table(delimiter: str = " ", decimal: str = ".", extra: str = "", end: str = "\n", columns: int = 3) -> str:
    rows = (delimiter.join(f"{value:.4f}" for value in row[:columns]).replace(".", decimal) + extra for row in POINTS)
    return end.join(rows) + end


VARIANTS = {
    "blanks": table(),
    "many blanks": table("   ").replace("\n", "  \n"),
    "tabs": table("\t"),
    "commas": table(","),
    "commas and blanks": table(", "),
    "semicolons": table(";"),
    "semicolons, decimal comma": table(";", ","),
    "semicolons and blanks, decimal comma": table("; ", ","),
    "tabs, decimal comma": table("\t", ","),
    "blanks, decimal comma": table(" ", ","),
    "count, decimal comma": "120\n" + table("\t", ","),
    "carriage return and newline": table(end="\r\n"),
    "carriage return": table(end="\r"),
    "no last newline": table().rstrip("\n"),
    "trailing delimiter": table(",", extra=","),
    "quotes": table('","').replace("\n", '"\n"').join(['"', ""]).rstrip('"'),
    "exponents": "\n".join(" ".join(f"{v:.9E}" for v in row) for row in POINTS),
    "plus signs": "\n".join(" ".join(f"{v:+.4f}" for v in row) for row in POINTS),
    "header": "X;Y;Z\n" + table(";"),
    "header with units": "X [mm];Y [mm];Z [mm]\n" + table(";"),
    "header with a title": "Scan 3D 2024 of part 7\n\nx y z\n" + table(),
    "comments": "# x, y, z\n// by a scanner\n" + table().replace("\n", "\n# between\n", 3) + "; end\n",
    "heading between": table().replace("\n", "\nx y z\n", 1),
    "blank lines": table().replace("\n", "\n\n"),
    "byte order mark": "\ufeff" + table(),
    "intensity": table(extra=" 118"),
    "intensity and colour": table(extra=" -1034 12 200 255"),
    "normals": table(extra=" 0.0 0.6 0.8"),
    "running number": "".join(f"{i + 1} {line}\n" for i, line in enumerate(table().splitlines())),
    "quoted names": '"intensity","x","y","z"\n' + "".join(f"158,{x},{y},{z}\n" for x, y, z in POINTS),
    "names with blanks": "Point Quality;X [mm];Y [mm];Z [mm]\n" + "".join(f"0.5;{x};{y};{z}\n" for x, y, z in POINTS),
    "names in another order": "id,z,x,y\n" + "".join(f"{7 * i},{z},{x},{y}\n" for i, (x, y, z) in enumerate(POINTS)),
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_way_of_writing_gives_the_same_points(variant: str) -> None:
    np.testing.assert_allclose(read_text(VARIANTS[variant].encode()).points, POINTS, rtol=0, atol=1e-12)


def test_utf_16_is_text_too() -> None:
    np.testing.assert_array_equal(read_text(table().encode("utf-16")).points, POINTS)


@pytest.mark.parametrize("delimiter", [" ", ",", ";"])
@pytest.mark.parametrize("head", ["", "x y\n", "# x_mm,y_mm\n"])
def test_two_columns_are_a_planar_section(tmp_path: Path, delimiter: str, head: str) -> None:
    path = tmp_path / "outline.csv"
    path.write_text(head + table(delimiter, columns=2))
    scan = read_one(path)
    assert scan.kind == "section"
    np.testing.assert_array_equal(scan.points, POINTS * [1, 1, 0])


def test_a_plane_of_constant_height_is_a_section_as_well(tmp_path: Path) -> None:
    path = tmp_path / "slice.xyz"
    path.write_bytes(xyz(POINTS * [1, 1, 0] + [0, 0, 7.5]))
    scan = read_one(path)
    assert scan.kind == "section"
    np.testing.assert_array_equal(scan.points, POINTS * [1, 1, 0])


@pytest.mark.parametrize("word", ["nan", "NaN", "-nan(ind)", "1.#QNAN", "null", "inf", "-Inf", "#N/A"])
def test_words_for_no_number_are_counted(tmp_path: Path, word: str) -> None:
    lines = table().splitlines()
    for i in (0, 7, 119):
        lines[i] = lines[i].rsplit(" ", 1)[0] + f" {word}"
    path = tmp_path / "a.xyz"
    path.write_text("\n".join(lines))
    scan = read_one(path)
    assert scan.rejected == {"non_finite": 3}
    np.testing.assert_array_equal(scan.points, np.delete(POINTS, [0, 7, 119], axis=0))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (table() + "1 2\n" + table(), "line 121 has 2 columns, line 1 has 3: as many in every line"),
        (table() + "1.5\n" + table(), "line 121 has 1 column, line 1 has 3: as many in every line"),
        (table() + "1.5", "line 121 has 1 column, line 1 has 3: it is the last line, the file may be cut off"),
        (table() + "1 2\n\n", "line 121 has 2 columns, line 1 has 3: it is the last line, the file may be cut off"),
        (table() + "1 2 3e-", "line 121: '1 2 3e-' are not 3 numbers: it is the last line, the file may be cut off"),
        (table() + "7", "line 121 has 1 column, line 1 has 3: it is the last line, the file may be cut off"),
        ("x y z\n" + table() + "1 2 3 4\n", "line 122 has 4 columns, line 2 has 3: as many"),
        (table(",").replace("\n", "\n1,,3\n", 1), "line 2 has 2 columns"),
        (table() + "1 2 3a\n", "line 121: '1 2 3a' are not 3 numbers"),
        (table() + "1.0-2.0 3 4\n", "line 121"),
        ("121\n" + table(), "promises 121 points and the file holds 120"),
        ("1\n2\n3\n", "line 2 has 1 column"),
        ("1.5\n2\n3\n", "line 1 has 1 column"),
        ("inf\n", "line 1 has 1 column"),
        ("a b c\nd e f\n", "no line of numbers in its first 2 lines"),
        ("\n\n", "no line of numbers"),
        ("1 2 3\0", "binary, not text"),
    ],
)
def test_what_does_not_fit_is_named_by_line(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "a.xyz"
    path.write_text(text)
    with pytest.raises(InputError, match=r"a\.xyz: ") as error:
        read_one(path)
    assert says in str(error.value)


def test_blocks_join_without_a_seam_and_keep_count_of_lines() -> None:
    points = np.arange(3.0 * 250_000).reshape(-1, 3)
    text = "".join(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in points).encode()
    assert len(text) > BLOCK
    np.testing.assert_array_equal(read_text(text).points, points)
    with pytest.raises(InputError, match="line 250,001 has 2 columns"):
        read_text(text + b"5 5")


number = st.floats(-1e9, 1e9).map(lambda v: round(v, 6))


@given(
    st.lists(st.tuples(number, number, number), min_size=1, max_size=30),
    st.sampled_from([" ", "\t", ",", ";", " ; ", ", "]),
    st.booleans(),
    st.sampled_from(["\n", "\r\n", "\r"]),
    st.sampled_from(["", "x y z\n", "# by hand\n\n", "//X,Y,Z\n"]),
    st.sampled_from(["{!r}", "{:.6f}", "{:.17e}"]),
)
@settings(max_examples=100, deadline=None)
def test_any_numbers_in_any_dress(
    rows: list[tuple[float, float, float]], delimiter: str, decimal_comma: bool, end: str, head: str, form: str
) -> None:
    text = end.join(delimiter.join(form.format(value) for value in row) for row in rows)
    if decimal_comma and "," not in delimiter:
        text = text.replace(".", ",")
    expected = np.array(rows)
    steps = np.diff(expected[:, 0])
    if len(rows) > 2 and rows[0][0] in (0.0, 1.0) and (steps == 1.0).all():
        return  # a running number, by design
    if not any("." in line or "," in line for line in text.split(end)):
        return
    np.testing.assert_array_equal(read_text((head.replace("\n", end) + text).encode()).points, expected)


@pytest.mark.parametrize("columns", [2, 3])
def test_decimal_commas_with_commas_between_the_columns_are_told(columns: int) -> None:
    """A line "31,6090,-6,2250,2,8490" was read as 31, 6090, −6, a gear of ten metres."""
    with pytest.raises(InputError, match=r"line 2: .* has commas as decimal signs and between the columns too"):
        read_text(("X,Y,Z\n" + table(",", ",", columns=columns)).encode())


def test_whole_numbers_with_colours_behind_are_whole_numbers() -> None:
    whole = np.column_stack([np.round(POINTS * 1e3), np.arange(360).reshape(-1, 3) % 256]).astype(int)
    for keep in (whole, np.abs(whole)):
        np.testing.assert_array_equal(read_text("\n".join(",".join(map(str, row)) for row in keep).encode()).points, keep[:, :3])

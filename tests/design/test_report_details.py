"""What a design says for the head of its reports: text is text, and what cannot be printed is refused in one line."""

from __future__ import annotations

import pytest

from gearwear.design.files.toml import read_design
from gearwear.errors import InputError

GEAR = "[gear]\nteeth = 20\nmodule = 2\nface_width = 10\n"


def read(tmp_path, table):
    file = tmp_path / "design.toml"
    file.write_text(f"{GEAR}[report]\n{table}\n", encoding="utf-8")
    return read_design(file)


def test_what_is_given_comes_through_and_the_rest_is_empty(tmp_path):
    design = read(
        tmp_path, 'part_number = "A <b>"\nserial = 42\ndate = 2026-11-22\nremarks = """one\n\ttwo"""\nlogo = "sub/logo.png"'
    )
    assert design.report.told == [("part number", "A <b>"), ("serial", "42"), ("date", "2026-11-22"), ("remarks", "one\n\ttwo")]
    assert design.report.logo == str(tmp_path / "sub" / "logo.png")  # beside the design, not where the command runs
    assert (design.report.customer, design.report.operator) == ("", "")


def test_the_hash_is_that_of_the_file(tmp_path):
    """SHA-256 of the empty gear of this test, by sha256sum of the same bytes."""
    import hashlib

    design = read(tmp_path, "")
    assert design.sha256 == hashlib.sha256((tmp_path / "design.toml").read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("serial = 1.5", "serial = 1.5: must be text"),
        ("serial = true", "must be text"),
        ('partnumber = "A"', "(part_number?)"),
        (f'operator = "{"x" * 201}"', "operator has 201 letters: at most 200"),
        (f'remarks = "{"x" * 4001}"', "at most 4000"),
        ('customer = "a\\nb"', "customer holds U+000A"),
        ('customer = "a\\u202Eb"', "customer holds U+202E, which cannot be printed"),
        ('remarks = "a\\u0000b"', "remarks holds U+0000"),
    ],
)
def test_what_cannot_stand_there_is_refused_in_one_line(tmp_path, table, words):
    with pytest.raises(InputError) as caught:
        read(tmp_path, table)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_marks_that_scripts_are_written_with_are_text(tmp_path):
    assert read(tmp_path, 'operator = "می‌خواهم"').report.operator == "می‌خواهم"


def test_report_must_be_a_table(tmp_path):
    file = tmp_path / "design.toml"
    file.write_text(f"report = 3\n{GEAR}", encoding="utf-8")
    with pytest.raises(InputError, match=r"must be a table, written \[report\]"):
        read_design(file)

"""A key is the same as long as nothing changes that a result depends on, and another one else."""

from __future__ import annotations

import os
from dataclasses import replace
from datetime import datetime

import pytest

from gearwear.fleet.keys import (
    ABSENT,
    Digests,
    Options,
    contents_of,
    design_digest,
    digests_text,
    file_digest,
    key_of,
    parse_digests,
)
from gearwear.fleet.manifest import ManifestRow

ROW = ManifestRow(
    line=2, gear_id="G 1/ü", design="d.toml", scans=("a.ply",), inspected=datetime(2026, 3, 1), more=(("site", "x"),)
)


@pytest.mark.parametrize("other", [
    replace(ROW, gear_id="G 2"), replace(ROW, scans=("b.ply",)), replace(ROW, units="in"), replace(ROW, part="gear"),
    replace(ROW, before=("n.ply",)), replace(ROW, cycles_run=1.0), replace(ROW, operator="A"), replace(ROW, repeat="2"),
    replace(ROW, inspected=None), replace(ROW, more=(("site", "y"),)),
])  # fmt: skip
def test_each_cell_of_a_row_counts(other):
    assert key_of(other, ["1", "2"], Options(), "0.2") != key_of(ROW, ["1", "2"], Options(), "0.2")


def test_contents_options_and_version_count_and_the_line_does_not():
    key = key_of(ROW, ["1", "2"], Options(), "0.2")
    others = [
        key_of(ROW, ["1", "3"], Options(), "0.2"),
        key_of(ROW, ["1", "2"], Options(loop=False), "0.2"),
        key_of(ROW, ["1", "2"], Options(), "0.3"),
    ]
    assert len({key, *others}) == 4
    assert key_of(replace(ROW, line=7), ["1", "2"], Options(), "0.2") == key


def test_a_key_is_a_name_of_a_file_anywhere():
    key = key_of(ROW, [], Options(), "0")
    assert key.startswith("G-1-_2026-03-01_")
    assert key.isascii() and not set(key) & set(' /\\:*?"<>|')
    assert key_of(replace(ROW, gear_id="../..", inspected=None), [], Options(), "0").startswith("scan_")


DESIGN = "[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\n"


def digest(folder, text):
    (folder / "d.toml").write_text(text)
    return design_digest(folder / "d.toml")


def test_limits_and_comments_measure_nothing_anew(tmp_path):
    plain = digest(tmp_path, DESIGN)
    assert digest(tmp_path, f"# drawing 7\n{DESIGN}[limits]\nwear_depth_mm = 0.1\n") == plain
    assert digest(tmp_path, DESIGN.replace("12", "13")) != plain


def test_a_design_that_is_refused_counts_as_it_is(tmp_path):
    """Else a limit that was mended would stay refused for ever."""
    wrong = digest(tmp_path, f"{DESIGN}[limits]\nwear_depth_mm = -1.0\n")
    assert digest(tmp_path, f"{DESIGN}[limits]\nwear_depth_mm = 1.0\n") != wrong
    assert digest(tmp_path, "teeth =\n") != wrong


def test_a_file_is_read_once_and_again_when_it_changes(tmp_path):
    file, read = tmp_path / "a.ply", []
    file.write_bytes(b"one")
    os.utime(file, ns=(1_000_000_000, 1_000_000_000))

    def counted(path):
        read.append(path)
        return file_digest(path)

    first = Digests()
    one = first.of(file, counted)
    kept = Digests(parse_digests(digests_text(first.lasting())))
    assert kept.of(file, counted) == one and len(read) == 1
    file.write_bytes(b"two")
    assert kept.of(file, counted) != one and len(read) == 2
    assert kept.of(tmp_path / "none", counted) == ABSENT


def test_a_file_that_has_just_changed_is_not_trusted_by_its_time(tmp_path):
    (tmp_path / "a.ply").write_bytes(b"one")
    digests = Digests()
    digests.of(tmp_path / "a.ply", file_digest)
    assert digests.lasting() == {}


def test_lines_that_are_no_digests_are_passed_over():
    assert parse_digests("a,1,2,x\nb,one,2,x\nc\n") == {"a": (1, 2, "x")}


def test_contents_are_those_of_all_files(tmp_path):
    (tmp_path / "d.toml").write_text(DESIGN)
    for name in ("a.ply", "n.ply"):
        (tmp_path / name).write_text(name)
    found = contents_of(replace(ROW, before=("n.ply",)), tmp_path, Digests())
    assert found == [design_digest(tmp_path / "d.toml"), file_digest(tmp_path / "a.ply"), file_digest(tmp_path / "n.ply")]

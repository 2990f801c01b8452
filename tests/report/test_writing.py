"""Nothing is half-written, and JSON holds numbers only."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwear.errors import InputError
from gearwear.report.files.writing import finite, output_folder, write_json


def test_files_arrive_together_and_others_stay(tmp_path):
    out = tmp_path / "deep" / "out"
    with output_folder(out) as stage:
        (stage / "a.txt").write_text("first")
        assert not (out / "a.txt").exists()
    (out / "mine.txt").write_text("kept")
    with output_folder(out) as stage:
        (stage / "a.txt").write_text("second")
        assert (out / "a.txt").read_text() == "first", "the old file stands until the end"
    assert sorted(p.name for p in out.iterdir()) == ["a.txt", "mine.txt"]
    assert (out / "a.txt").read_text() == "second"


@pytest.mark.parametrize("there", [True, False])
def test_a_failure_leaves_the_folder_as_it_was(tmp_path, there):
    out = tmp_path / "deep" / "out"
    if there:
        out.mkdir(parents=True)
        (out / "a.txt").write_text("old")
    with pytest.raises(RuntimeError), output_folder(out) as stage:
        (stage / "a.txt").write_text("half")
        raise RuntimeError
    assert [p.name for p in tmp_path.rglob("*")] == (["deep", "out", "a.txt"] if there else [])
    if there:
        assert (out / "a.txt").read_text() == "old"


def test_a_file_in_the_way_is_named(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(InputError, match=r"out: is a file"), output_folder(tmp_path / "out"):
        pass
    with pytest.raises(InputError, match="is a file"), output_folder(tmp_path / "out" / "below"):
        pass
    assert (tmp_path / "out").read_text() == "a file"


def test_a_name_that_no_folder_has_is_refused_before_any_work(tmp_path):
    with pytest.raises(InputError, match="no folder has a NUL in its name"), output_folder(tmp_path / "a\0b" / "out"):
        raise AssertionError
    assert list(tmp_path.iterdir()) == []


def test_an_input_error_inside_passes_through(tmp_path):
    with pytest.raises(InputError, match="what was wrong"), output_folder(tmp_path / "out"):
        raise InputError("what was wrong")


values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.floats().map(np.float64)
    | st.floats(width=32).map(np.float32),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner, inner),
    max_leaves=20,
)


@settings(max_examples=20)
@given(values)
def test_any_report_becomes_json_that_every_reader_takes(value):
    text = json.dumps(finite(value), allow_nan=False)
    assert json.loads(text) == json.loads(text, parse_constant=pytest.fail)


def test_numbers_survive_and_what_is_not_one_becomes_null(tmp_path):
    report = {
        "value": 1.0 / 3.0,
        "nan": math.nan,
        "inf": np.float64("-inf"),
        "array": np.array([[1.5, np.nan]]),
        "flag": np.True_,
        "µ": 3,
    }
    write_json(tmp_path / "report.json", report)
    read = json.loads((tmp_path / "report.json").read_text("utf-8"))
    assert read == {"value": 1.0 / 3.0, "nan": None, "inf": None, "array": [[1.5, None]], "flag": True, "µ": 3}

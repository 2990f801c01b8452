"""The lines that the study of the closed loop writes."""

import json

import pytest

from benchmarks.study import kept


def test_a_study_that_is_killed_keeps_what_it_had(tmp_path):
    def scores():
        yield {"label": "0"}
        yield {"label": "1", "refused": "…"}
        raise KeyboardInterrupt

    file = tmp_path / "details.jsonl"
    with pytest.raises(KeyboardInterrupt):
        for count, score in enumerate(kept(scores(), str(file)), start=1):
            # There before the next scan is begun, and not only when the file is closed.
            written = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
            assert len(written) == count and written[-1] == score
    assert len(file.read_text(encoding="utf-8").splitlines()) == 2
    assert [*kept([{"label": "0"}], None)] == [{"label": "0"}]

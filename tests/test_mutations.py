"""The list of mutations is up to date: each one's text stands once in its file, and its tests are there."""

from __future__ import annotations

import pytest

from benchmarks.mutations import MUTATIONS, ROOT


@pytest.mark.parametrize("file", sorted({mutation.file for mutation in MUTATIONS}))
def test_no_mutation_is_stale(file):
    text = (ROOT / "gearwear" / file).read_text(encoding="utf-8")
    own = [mutation for mutation in MUTATIONS if mutation.file == file]
    assert [mutation.old for mutation in own if text.count(mutation.old) != 1] == []
    assert [test for mutation in own for test in mutation.tests.split() if not (ROOT / "tests" / test).exists()] == []

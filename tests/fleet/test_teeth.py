"""Teeth of a fleet under one number: scans that were turned and laid on the other end before they were stored."""

from __future__ import annotations

from datetime import datetime

import numpy as np
import pytest

from gearwear.comparison.same_teeth import TeethPattern
from gearwear.fleet.reading import read_fleet, trends
from tests.fleet.fleets import report, row, store_of

TEETH = 17
DAYS = [datetime(2026, month, 1) for month in (1, 3, 5)]
LAID = [(0, False), (6, False), (4, True)]
"""How each scan must be turned to go with the first."""


def stored(folder, own: float, seed: int = 0):
    """Three inspections of one gear whose flanks differ by `own` times what a scan scatters; tooth 4 wears on its left flank."""
    rng = np.random.default_rng(seed)
    place, form = rng.normal(size=(TEETH, 2, 1, 1)), rng.normal(size=(TEETH, 2, 3, 3))
    scans = []
    for i, (day, (turned, over)) in enumerate(zip(DAYS, LAID, strict=True)):
        patterns = [
            TeethPattern(name, own * values + rng.normal(size=values.shape))
            for name, values in (("form and marks", form), ("place", place))
        ]
        # As it lay: the way back from `laid`.
        back = [TeethPattern(one.name, one.laid(turned if over else -turned, over)) for one in patterns]
        tooth = (turned - 3 if over else 3 - turned) % TEETH + 1
        given = report(depth=(50.0 + 20.0 * i, 4.0))
        given["wear"]["regions"][0] |= {"tooth": tooth, "flank": "right" if over else "left"}
        given["scan"] = {"teeth_patterns": [{"name": one.name, "values": one.values.tolist()} for one in back]}
        scans.append((row("G1", day, 1e6 * (i + 1)), given))
    return read_fleet(store_of(folder, scans))


def test_a_tooth_keeps_its_number(tmp_path):
    fleet = stored(tmp_path / "store", 3.0)
    assert [(one.same.turned, one.same.flipped) for one in fleet.scans.values()] == LAID
    assert all(one.same.sure for one in fleet.scans.values())
    deep = [one for one in fleet.teeth if one["quantity"] == "wear_depth_mm" and one["value"] > 0.0]
    assert [(one["tooth"], one["flank"], one["value"]) for one in deep] == [
        (4, "left", pytest.approx(0.05 + 0.02 * i)) for i in range(3)
    ]
    assert [one["flank_in_report"] for one in deep] == ["left", "left", "right"]
    assert not any("doubtful" in note for note in trends(fleet)[0].notes)


def test_a_gear_without_marks_is_doubtful(tmp_path):
    fleet = stored(tmp_path / "store", 0.0)
    assert [one.same.as_it_lay for one in fleet.scans.values()] == [True] * 3
    assert "tooth numbers of 2 of 3 scans" in trends(fleet)[0].notes[0]

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


def stored(folder, own: float, seed: int = 0, laid=LAID, marks=(None, None, None), days=DAYS, settled=(True, True, True)):
    """Three inspections of one gear whose flanks differ by `own` times what a scan scatters; tooth 4 wears on its left flank."""
    rng = np.random.default_rng(seed)
    place, form = rng.normal(size=(TEETH, 2, 1, 1)), rng.normal(size=(TEETH, 2, 3, 3))
    scans = []
    for i, (day, (turned, over)) in enumerate(zip(days, laid, strict=True)):
        patterns = [
            TeethPattern(name, own * values + rng.normal(size=values.shape))
            for name, values in (("form and marks", form), ("place", place))
        ]
        # As it lay: the way back from `laid`.
        back = [TeethPattern(one.name, one.laid(turned if over else -turned, over)) for one in patterns]
        tooth = (turned - 3 if over else 3 - turned) % TEETH + 1
        given = report(depth=(50.0 + 20.0 * i, 4.0), converged=settled[i])
        given["wear"]["regions"][0] |= {"tooth": tooth, "flank": "right" if over else "left"}
        given["scan"] = {"teeth_patterns": [{"name": one.name, "values": one.values.tolist()} for one in back], "mark": marks[i]}
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


def test_teeth_are_in_the_order_of_the_trend(tmp_path):
    """The undated scan, of a new gear by its cycles, is the first: its tooth numbers count, and its rows stand first."""
    fleet = stored(tmp_path / "store", 3.0, days=[None, *DAYS[1:]])
    assert [(one.same.turned, one.same.flipped) for one in fleet.scans.values()] == LAID
    deep = [one for one in fleet.teeth if one["quantity"] == "wear_depth_mm" and one["value"] > 0.0]
    assert [one["inspected"] for one in deep] == [None, *DAYS[1:]]
    points = trends(fleet)[0].trends["wear_depth_mm"].points
    assert [point.inspected for point in points] == [None, *DAYS[1:]]


def test_teeth_are_numbered_by_the_first_scan_that_settled(tmp_path):
    """One that lies nowhere has no teeth to number others by: the second scan's numbers count, turned back by its own 6."""
    fleet = stored(tmp_path / "store", 3.0, settled=(False, True, True))
    (first, second) = fleet.scans.values()
    assert first.same.as_it_lay and first.same.probability == 1.0
    assert (second.same.turned, second.same.flipped) == (4 - 6 + TEETH, True)
    deep = [one for one in fleet.teeth if one["quantity"] == "wear_depth_mm" and one["value"] > 0.0]
    assert [(one["tooth"], one["flank"], one["probability"]) for one in deep] == [
        ((3 - 6) % TEETH + 1, "left", pytest.approx(1.0))
    ] * 2


def test_a_gear_without_marks_is_doubtful(tmp_path):
    fleet = stored(tmp_path / "store", 0.0)
    assert [one.same.as_it_lay for one in fleet.scans.values()] == [True] * 3
    assert "tooth numbers of 2 of 3 scans" in trends(fleet)[0].notes[0]


def seen(off: float, end_told: bool) -> dict:
    """A mark drawn 0.3 pitches from tooth 1, so many pitches off in a scan that was numbered by it."""
    pitch = 360.0 / TEETH
    off_deg = {"value": off * pitch, "std": 0.1}
    return {"angle_deg": 0.3 * pitch, "off_deg": off_deg, "points": 900, "probability": 1.0, "end_told": end_told}


@pytest.mark.parametrize("own", [0.0, 0.3])
def test_a_stated_mark_tells_teeth_and_end_where_nothing_on_the_gear_does(tmp_path, own):
    """Upside down it stands at −0.3 pitches: that is 0.4 off from where the design has it at the tooth next to it, which is then tooth 1."""
    laid = [(0, False), (0, False), (1, True)]
    fleet = stored(tmp_path / "store", own, laid=laid, marks=[seen(0.0, False), seen(0.01, False), seen(0.4, False)])
    assert [(one.same.turned, one.same.flipped) for one in fleet.scans.values()] == laid
    later = list(fleet.scans.values())[1:]
    assert all(one.same.sure and one.same.told_by[0] == "the mark" for one in later)
    deep = [one for one in fleet.teeth if one["quantity"] == "wear_depth_mm" and one["value"] > 0.0]
    assert [(one["tooth"], one["flank"]) for one in deep] == [(4, "left")] * 3
    assert not any("doubtful" in note for note in trends(fleet)[0].notes)


def test_a_mark_on_one_end_leaves_no_way_open(tmp_path):
    fleet = stored(tmp_path / "store", 0.0, laid=[(0, False)] * 3, marks=[seen(0.0, True), seen(-0.02, True), seen(0.02, True)])
    assert all(one.same.as_it_lay and one.same.probability == pytest.approx(1.0) for one in fleet.scans.values())


def test_a_mark_that_one_scan_alone_shows_tells_nothing(tmp_path):
    fleet = stored(tmp_path / "store", 0.0, marks=[seen(0.0, True), None, None])
    assert "tooth numbers of 2 of 3 scans" in trends(fleet)[0].notes[0]

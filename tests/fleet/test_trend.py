"""The same gear over its inspections."""

from __future__ import annotations

import math
from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
import pytest

from gearwear.design.conformity import Conformity
from gearwear.fleet.order import Occasion
from gearwear.fleet.panels import scales_of, trend_panel
from gearwear.fleet.significance import two_sided
from gearwear.fleet.trend import CYCLES, DAYS, Reading, by_urgency, gear_trend, points_of, with_significance
from gearwear.fleet.words import state_words, verdict_words

DAY = datetime(2026, 1, 1)


def readings(values, std=0.004, gear_id="G1", quantity="wear_depth_mm", cycles=True, step=60):
    """Inspections every `step` days, 10,000 cycles a day."""
    return [
        Reading(
            gear_id=gear_id, quantity=quantity, value=float(value), std=std, inspected=DAY + timedelta(step * i),
            cycles=1e4 * (step * i + 30) if cycles else None,
        )
        for i, value in enumerate(values)
    ]  # fmt: skip


def test_a_rate_put_in_comes_back_and_so_does_the_day_of_the_limit():
    rate, limit = 3e-8, 0.12  # mm a cycle
    given = [replace(one, value=rate * one.cycles) for one in readings([0.0] * 5)]
    trend = gear_trend("G1", given, {"wear_depth_mm": limit}).trends["wear_depth_mm"]
    last = given[-1]
    assert (trend.clock, trend.line.slope) == (CYCLES, pytest.approx(rate))
    assert trend.left.value == pytest.approx(limit / rate - last.cycles)
    assert trend.days_left.value == pytest.approx((limit / rate - last.cycles) / 1e4)
    assert abs(trend.date(trend.days_left.value) - (last.inspected + timedelta((limit / rate - last.cycles) / 1e4))) < timedelta(
        seconds=1
    )
    assert trend.left.low < trend.left.value < trend.left.high
    assert trend.conformity is Conformity.CONFORMING


def test_without_cycles_the_clock_is_the_calendar():
    trend = gear_trend("G1", readings([0.01, 0.02, 0.03], cycles=False), {"wear_depth_mm": 0.05}).trends["wear_depth_mm"]
    assert (trend.clock, trend.line.slope) == (DAYS, pytest.approx(0.01 / 60))
    assert trend.days_left.value == pytest.approx(120.0)


@pytest.mark.parametrize("first", [datetime.min, datetime(1900, 1, 1), datetime(2200, 10, 30), datetime(9999, 10, 30)])
def test_at_either_end_of_the_calendar_charts_are_drawn_and_a_date_beyond_is_none(first):
    """A list with the year 1 or 9999 is refused; a table may hold one all the same."""
    last = first + timedelta(60)
    given = [replace(one, inspected=day, cycles=None) for one, day in zip(readings([0.0, 0.02]), (first, last), strict=True)]
    gear = gear_trend("G1", given, {"wear_depth_mm": 0.1})
    trend = gear.trends["wear_depth_mm"]
    assert trend.days_left.value == pytest.approx(240.0)
    reached = trend.date(trend.days_left.value)
    assert reached is None if first.year == 9999 else abs(reached - last - timedelta(240)) < timedelta(seconds=1)
    chart = trend_panel(trend, scales_of([gear]))
    assert f">{first.date()}<" in chart and f">{last.date()}<" in chart


def test_cycles_that_do_not_grow_are_no_clock():
    given = [replace(one, cycles=1e6) for one in readings([0.01, 0.02, 0.03])]
    assert gear_trend("G1", given, {}).trends["wear_depth_mm"].clock == DAYS


def test_neither_dates_nor_cycles_no_rate():
    given = [replace(one, inspected=None, cycles=None, value=i / 100) for i, one in enumerate(readings([0.0]))]
    trend = gear_trend("G1", given, {"wear_depth_mm": 0.1}).trends["wear_depth_mm"]
    assert (trend.line, trend.left, trend.clock) == (None, None, "")


def test_one_inspection_has_a_rate_since_new_where_new_is_nothing():
    one = gear_trend("G1", readings([0.03]), {"wear_depth_mm": 0.06}).trends["wear_depth_mm"]
    assert one.from_new and one.left.value == pytest.approx(one.last.cycles)
    backlash = gear_trend("G1", readings([0.03], quantity="backlash_mm"), {"backlash_mm": 0.06}).trends["backlash_mm"]
    assert backlash.line is None and backlash.conformity is Conformity.CONFORMING


def test_scans_of_one_inspection_are_one_point_whose_scatter_is_not_averaged_away():
    given = readings([0.05])
    same = points_of([given[0], replace(given[0], value=0.052), replace(given[0], value=0.048)])
    assert (len(same), same[0].scans, same[0].value, same[0].std) == (1, 3, pytest.approx(0.05), pytest.approx(0.004))
    (wide,) = points_of([given[0], replace(given[0], value=0.09)])
    assert wide.std == pytest.approx(0.04 / math.sqrt(2.0) / math.sqrt(2.0))  # the scatter of the mean of two


def test_where_nothing_was_found_what_may_hide_counts():
    hidden = replace(readings([0.0])[0], std=math.nan, low=0.0, high=0.02)
    (point,) = points_of([hidden])
    assert (point.open, point.ends) == ((0.0, 0.02), (0.0, 0.02))
    later = readings([0.0, 0.05])[1]
    trend = gear_trend("G1", [hidden, later], {}).trends["wear_depth_mm"]
    step = trend.steps[0]
    assert (step.value, step.std, step.high) == (pytest.approx(0.05), 0.004, pytest.approx(0.05 + 1.96 * 0.004))
    assert step.low == pytest.approx(0.05 - 0.02 - 1.96 * 0.004)
    assert step.p_value == pytest.approx(two_sided(0.03 / 0.004))


def test_what_has_a_limit_and_no_value_cannot_be_said():
    gear = gear_trend("G1", readings([0.01]), {"wear_depth_mm": 0.12, "backlash_mm": 0.2})
    assert gear.conformity is Conformity.NEITHER
    assert "backlash_mm" in gear.notes[0]


@pytest.mark.parametrize(
    "later", [Occasion(DAY + timedelta(60), 1e6), Occasion(cycles=1e6), Occasion(DAY + timedelta(60)), Occasion()]
)
def test_a_last_inspection_without_result_cannot_be_said(later):
    """Nor where it may be the last: with no date and no cycles nothing says that it is not."""
    limits = {"wear_depth_mm": 0.12}
    assert gear_trend("G1", readings([0.01]), limits, inspections=[later]).conformity is Conformity.NEITHER
    assert gear_trend("G1", readings([0.3]), limits, inspections=[later]).conformity is Conformity.NOT_CONFORMING
    assert gear_trend("G1", readings([0.01]), {}, inspections=[later]).conformity is None
    assert any("no result" in note for note in gear_trend("G1", readings([0.01]), limits, inspections=[later]).notes)
    before = Occasion(DAY - timedelta(60), 0.0)
    assert gear_trend("G1", readings([0.01]), limits, inspections=[before]).conformity is Conformity.CONFORMING


def test_a_worn_gear_is_not_judged_by_an_older_scan():
    """Cycles say which scan is the last where a date is missing; where nothing says it, the worst of those that may be it."""
    (new, worn), limits = readings([0.001, 0.5]), {"wear_depth_mm": 0.1}
    for undated in ([replace(new, inspected=None), worn], [new, replace(worn, inspected=None)]):
        gear = gear_trend("G1", undated, limits)
        assert (gear.conformity, gear.notes) == (Conformity.NOT_CONFORMING, ())
        trend = gear.trends["wear_depth_mm"]
        assert (trend.last.value, trend.clock, trend.steps[0].value) == (0.5, CYCLES, pytest.approx(0.499))
    nothing = {"inspected": None, "cycles": None}
    for open_ in (
        [replace(new, **nothing), worn],
        [new, replace(worn, **nothing)],
        [replace(new, cycles=None), replace(worn, inspected=None)],
    ):
        gear = gear_trend("G1", open_, limits)
        trend = gear.trends["wear_depth_mm"]
        assert gear.conformity is trend.conformity is Conformity.NOT_CONFORMING
        assert (trend.last.value, trend.steps, trend.line, trend.left) == (0.5, (), None, None)
        assert gear.notes[0].startswith("which of 2 inspections is the last is not known, the worst counts: 1 of 2 without ")
        near = [replace(one, value=0.5 * one.value) if one.value == 0.5 else one for one in open_]
        assert gear_trend("G1", near, {"wear_depth_mm": 0.25}).conformity is Conformity.NEITHER
        assert gear_trend("G1", near, {"wear_depth_mm": 0.30}).conformity is Conformity.CONFORMING


def test_a_scan_that_is_surely_older_does_not_count():
    """Without a date, but with fewer cycles; what comes before the last stays open, and no change is given."""
    first, second, third = readings([0.5, 0.02, 0.03])
    gear = gear_trend("G1", [replace(first, inspected=None), replace(second, cycles=None), third], {"wear_depth_mm": 0.1})
    assert gear.conformity is Conformity.CONFORMING
    assert gear.trends["wear_depth_mm"].steps == ()
    assert gear.notes == (
        "the order of the inspections before the last is not known: 1 of 3 without inspected, 1 of 3 without cycles_run",
    )


def test_what_was_not_measured_at_the_last_inspection_cannot_be_said():
    limits = {"backlash_mm": 0.2}
    earlier, later = readings([0.05], quantity="backlash_mm"), readings([0.01, 0.02])[1:]
    gear = gear_trend("G1", [*earlier, *later], limits)
    assert gear.conformity is Conformity.NEITHER
    assert gear.notes == ("no value of backlash_mm at the last inspection, which has a limit",)


def test_a_gear_that_gains_metal_is_doubted():
    gear = gear_trend("G1", readings([2.0, 1.0], std=0.05, quantity="wear_volume_mm3"), {})
    assert "is it the same gear?" in gear.notes[0]


def test_a_line_through_two_gears_is_none():
    """80 µm at 5 mm³, then a new gear in its place: no rate of either, and no day on which the limit is reached."""
    volumes = readings([2.0, 5.0, 0.5], std=0.05, quantity="wear_volume_mm3")
    gear = gear_trend("G1", [*volumes, *readings([0.03, 0.08, 0.01])], {"wear_depth_mm": 0.1})
    depth = gear.trends["wear_depth_mm"]
    assert (depth.line, depth.left, depth.clock, depth.last.value) == (None, None, "", 0.01)
    assert gear.conformity is Conformity.CONFORMING
    assert [step.value for step in gear.trends["wear_volume_mm3"].steps] == [3.0, -4.5]


def test_the_most_urgent_comes_first():
    limits = {"wear_depth_mm": 0.1}
    lives = {
        "far beyond": [0.1, 0.3], "just beyond": [0.08, 0.12], "at the limit": [0.06, 0.098], "soon": [0.05, 0.07], "later": [0.02, 0.03],
        "never": [0.03, 0.03],
    }  # fmt: skip
    gears = [gear_trend(name, readings(values, gear_id=name), limits) for name, values in lives.items()]
    bare = [
        gear_trend(name, readings(values, gear_id=name, quantity="wear_volume_mm3"), {})
        for name, values in (("wears fast", [0.1, 0.5]), ("wears slowly", [0.1, 0.2]), ("has nothing", []))
    ]
    ranked = [gear.gear_id for gear in by_urgency([*reversed(bare), *reversed(gears)])]
    assert ranked == [*lives, "wears fast", "wears slowly", "has nothing"]


def test_among_gears_that_do_not_wear_few_rates_are_significant():
    """300 gears whose numbers only scatter: a false discovery in one such fleet of twenty. 300 that wear, by 8 standard deviations of the
    rate: all but a part of the one in twenty whose points bend by chance, and whose ± is widened for it."""
    rng = np.random.default_rng(2)
    still = [gear_trend(f"S{i}", readings(0.05 + 0.004 * rng.standard_normal(5), gear_id=f"S{i}"), {}) for i in range(300)]
    assert sum(gear.trends["wear_depth_mm"].significant for gear in with_significance(still)) <= 3
    wearing = [
        gear_trend(f"W{i}", readings(0.01 * np.arange(5) + 0.004 * rng.standard_normal(5), gear_id=f"W{i}"), {})
        for i in range(300)
    ]
    found = [gear.trends["wear_depth_mm"] for gear in with_significance([*still, *wearing])]
    assert sum(trend.significant for trend in found[300:]) > 0.95 * 300 - 3.0 * math.sqrt(300 * 0.95 * 0.05)
    assert sum(trend.significant for trend in found[:300]) <= 0.05 * 300 + 3.0 * math.sqrt(0.05 * 300)


def test_gears_without_a_result_are_said_by_name_and_not_judged():
    limits = {"wear_depth_mm": 0.1}
    worn = gear_trend("worn", readings([0.01, 0.02]), limits)
    refused = gear_trend("G-17", [], {}, ["its scan was refused"])
    limited = gear_trend("G-18", [], limits)
    assert verdict_words([worn, refused, limited]) == "3 gears: 1 within all limits; no scan of G-17 and G-18 gave a result."
    assert verdict_words([refused]) == "1 gear: no scan of G-17 gave a result."
    many = [gear_trend(f"G{i}", [], limits) for i in range(8)]
    assert verdict_words(many) == "8 gears: no scan of G0, G1, G2, G3, G4 and 3 more gave a result."
    free = gear_trend("free", readings([0.01, 0.02]), {})
    assert verdict_words([free, refused]).endswith("the designs set no limits; no scan of G-17 gave a result.")
    assert [state_words(gear) for gear in (worn, refused, limited, free)] == ["conforming", "no result", "no result", "no limits"]


def test_a_gear_that_is_undecided_is_counted_in_plain_words():
    near = gear_trend("near", readings([0.1]), {"wear_depth_mm": 0.1})
    assert near.conformity is Conformity.NEITHER
    assert verdict_words([near]) == "1 gear: 1 undecided." and state_words(near) == "undecided"

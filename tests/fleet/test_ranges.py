"""What a report leaves open beside its ±: in changes, rates, times to a limit, decisions, words and charts."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import replace
from datetime import datetime, timedelta
from itertools import product

import numpy as np
import pytest

from gearwear.design.conformity import Conformity
from gearwear.fleet.line import fit_line, line_from_new, reaches
from gearwear.fleet.trend import Reading, gear_trend, points_of, with_significance
from gearwear.fleet.words import gear_words, value_words
from tests.commands.doors import run
from tests.fleet.fleets import report, row, store_of

X = np.array([1.0, 2.0, 4.0, 5.0, 7.0])
Y = np.array([3.0, 2.0, 9.0, 11.0, 12.0])
STD = np.array([0.2, 0.4, 0.3, 0.1, 0.5])
DOWN = np.array([0.0, 1.0, 0.0, 4.0, 2.5])
UP = np.array([3.0, 0.0, 0.0, 1.0, 6.0])
DAY, QUANTITY = datetime(2026, 1, 1), "wear_volume_mm3"


def readings(values, std=0.2, ranges=None):
    """Inspections every 60 days, a million cycles each, with a range each."""
    ranges = ranges or [(math.nan, math.nan)] * len(values)
    return [
        Reading(gear_id="G1", quantity=QUANTITY, value=float(value), std=std, inspected=DAY + timedelta(60 * i), cycles=1e6 * (i + 1), low=low, high=high)
        for i, (value, (low, high)) in enumerate(zip(values, ranges, strict=True))
    ]  # fmt: skip


def trend_of(given, limit=None):
    return gear_trend("G1", given, {} if limit is None else {QUANTITY: limit}).trends[QUANTITY]


def by_lines(x):
    """Least and most of the line at x, and of its slope, over all corners of the ranges, each drawn by numpy."""
    weights = 1.0 / (STD + 0.5 * np.maximum(DOWN, UP))
    corners = np.array(list(product(*zip(Y - DOWN, Y + UP, strict=True))))
    slope, level = np.polyfit(X, corners.T, 1, w=weights)
    at = level + slope * x
    return (at.min(), at.max()), (slope.min(), slope.max())


@pytest.mark.parametrize("x", [0.0, 3.3, 7.0, 30.0])
def test_lines_through_every_corner_of_the_ranges_lie_in_the_band(x):
    """The band without its scatter is the least and the most of all those lines: least squares is linear, and so extreme at corners."""
    line = fit_line(X, Y, STD, DOWN, UP)
    assert not line.bends
    std = line.at(x)[1]
    (low, high), (slow, fast) = by_lines(x)
    assert line.band(x) == (pytest.approx(low - line.factor * std), pytest.approx(high + line.factor * std))
    expanded = line.factor * line.slope_std
    assert line.slope_interval == (pytest.approx(slow - expanded), pytest.approx(fast + expanded))


def test_scatter_goes_through_the_same_line_as_variance():
    """20,000 draws of the scatter alone, each drawn by numpy with the same weights: 3.5 standard errors of a standard deviation."""
    line = fit_line(X, Y, STD, DOWN, UP)
    noise = np.random.default_rng(4).standard_normal((5, 20_000)) * STD[:, None]
    slope, level = np.polyfit(X, noise, 1, w=1.0 / (STD + 0.5 * np.maximum(DOWN, UP)))
    tolerance = 3.5 / math.sqrt(2.0 * 20_000)
    assert line.slope_std == pytest.approx(slope.std(), rel=tolerance)
    for x in (0.0, 3.3, 30.0):
        assert line.at(x)[1] == pytest.approx((level + slope * x).std(), rel=tolerance)


def test_two_inspections_as_one_would_do_it_by_hand():
    line = fit_line(np.array([1.0, 3.0]), np.array([5.0, 9.0]), np.array([0.3, 0.4]), np.array([1.0, 2.0]), np.array([0.5, 4.0]))
    scatter = 1.959964 * math.hypot(0.3, 0.4)
    assert line.slope_interval == (
        pytest.approx((4.0 - 2.0 - 0.5 - scatter) / 2.0),
        pytest.approx((4.0 + 4.0 + 1.0 + scatter) / 2.0),
    )
    for x, y, std, down, up in ((1.0, 5.0, 0.3, 1.0, 0.5), (3.0, 9.0, 0.4, 2.0, 4.0)):
        assert line.band(x) == (pytest.approx(y - down - 1.959964 * std), pytest.approx(y + up + 1.959964 * std))


def test_without_ranges_the_interval_is_fiellers():
    """The roots of (A + slope τ)² = k² (u_level² + τ² u_slope²)."""
    line = fit_line(X, X, np.full(5, 0.1))
    k, gap = line.factor, line.level - 20.0
    roots = np.roots([line.slope**2 - (k * line.slope_std) ** 2, 2.0 * gap * line.slope, gap**2 - (k * line.level_std) ** 2])
    found = reaches(line, 20.0, 7.0)
    assert [found.low, found.high] == pytest.approx(sorted(line.middle + roots - 7.0))


def test_from_new_the_ends_of_the_range_are_the_ends_of_the_rate():
    line = line_from_new(2e6, 40.0, 0.0, 10.0, 30.0)
    assert line.slope_interval == (pytest.approx(15e-6), pytest.approx(35e-6))
    found = reaches(line, 100.0, 2e6)
    assert (found.low, found.value, found.high) == (
        pytest.approx(100 / 35e-6 - 2e6),
        pytest.approx(3e6),
        pytest.approx(100 / 15e-6 - 2e6),
    )


@pytest.mark.parametrize("answers", ["worn", "made", "first made, then worn", "at random"])
def test_rate_and_time_to_the_limit_hold_the_truth_however_the_question_is_answered(answers):
    """A million cycles wear off 10 mm³, and 12 mm³ of each number are worn or made so. A scan that takes them for made leaves them open above
    its number, one that takes them for worn below. 1000 fleets each way: 95 % at least, within 3.5 standard errors. Of scatter alone, where the
    answer changes, none would."""
    rng, truth, even, std = np.random.default_rng(7), 10.0, 12.0, 0.5
    places, held_rate, held_time, by_scatter = np.arange(1.0, 6.0), 0, 0, 0
    for _ in range(1000):
        taken = {"worn": [1] * 5, "made": [0] * 5, "first made, then worn": [0, 0, 1, 1, 1], "at random": rng.integers(0, 2, 5)}[
            answers
        ]
        taken = np.array(taken, dtype=float)
        worn = truth * places + even  # they are worn
        y = worn - even * (1.0 - taken) + std * rng.standard_normal(5)
        line = fit_line(places, y, np.full(5, std), even * taken, even * (1.0 - taken))
        low, high = line.slope_interval
        held_rate += low <= truth <= high
        by_scatter += abs(line.slope - truth) <= line.factor * line.slope_std
        found = reaches(line, 100.0, 5.0)
        held_time += found.low <= (100.0 - even) / truth - 5.0 <= found.high
    least = 0.95 - 3.5 * math.sqrt(0.95 * 0.05 / 1000)
    assert held_rate / 1000 >= least and held_time / 1000 >= least
    if answers == "first made, then worn":
        assert by_scatter == 0


def test_a_jump_that_may_be_another_answer_is_no_change_and_no_rate():
    """The same 60 mm³ called made at first and worn later."""
    plain = readings([1.0, 1.0, 61.0, 61.0])
    open_ = readings([1.0, 1.0, 61.0, 61.0], ranges=[(0.0, 61.0), (0.0, 61.0), (1.0, 61.5), (1.0, 61.5)])
    (sure,), (unsure,) = (with_significance([gear_trend("G1", given, {})]) for given in (plain, open_))
    assert [step.significant for step in sure.trends[QUANTITY].steps] == [False, True, False]
    trend = unsure.trends[QUANTITY]
    assert [step.significant for step in trend.steps] == [False, False, False]
    assert not trend.significant and trend.line.p_value == 1.0
    jump, scatter = trend.steps[1], 1.96 * math.hypot(0.2, 0.2)
    assert (jump.low, jump.high) == (pytest.approx(1.0 - 61.0 - scatter), pytest.approx(61.5 - 0.0 + scatter))


def test_a_rate_that_no_answer_takes_away_stays_significant():
    given = readings([10.0, 30.0, 50.0, 70.0], ranges=[(8.0, 11.0), (27.0, 33.0), (46.0, 51.0), (66.0, 72.0)])
    (gear,) = with_significance([gear_trend("G1", given, {})])
    assert gear.trends[QUANTITY].significant and all(step.significant for step in gear.trends[QUANTITY].steps)


def test_where_neither_can_be_said_the_limit_may_be_reached_now_and_that_is_what_is_told():
    """The depth would reach its limit in 40 days; of the volume nobody knows whether it has."""
    volumes = readings([10.0, 12.0, 14.0], ranges=[(math.nan, math.nan), (math.nan, math.nan), (9.0, 60.0)])
    depths = [replace(one, quantity="wear_depth_mm", value=1e-3 * (30.0 + 30.0 * i), std=0.001) for i, one in enumerate(volumes)]
    depths = [replace(one, low=math.nan, high=math.nan) for one in depths]
    gear = gear_trend("G1", [*volumes, *depths], {QUANTITY: 50.0, "wear_depth_mm": 0.11})
    assert gear.conformity is Conformity.NEITHER
    assert gear.nearest.quantity == QUANTITY and gear.trends["wear_depth_mm"].conformity is Conformity.CONFORMING
    assert (gear.nearest.left.low, gear.nearest.left.value > 0.0) == (0.0, True)
    words = gear_words(gear).replace("\u202f", " ")
    assert re.match(r"worn volume 9\.00 to 60\.0 mm³ \(likeliest 14\.0\) of 50\.0, limit in .* \(up to ", words)


def test_what_the_last_inspection_proves_the_line_does_not_take_back():
    given = readings([80.0, 20.0, 70.0], std=5.0)
    given = [replace(one, quantity="thickness_loss_mm") for one in given]
    trend = gear_trend("G1", given, {"thickness_loss_mm": 50.0}).trends["thickness_loss_mm"]
    assert trend.conformity is Conformity.NOT_CONFORMING
    assert (trend.left.value, trend.left.low, trend.left.high) == (0.0, 0.0, 0.0)


def test_a_range_no_wider_than_the_scatter_changes_nothing():
    plain = trend_of(readings([10.0, 20.0, 31.0]), 60.0)
    own = [(value - 1.96 * 0.2, value + 1.96 * 0.2) for value in (10.0, 20.0, 31.0)]
    same = trend_of(readings([10.0, 20.0, 31.0], ranges=own), 60.0)
    assert (same.line, same.left, value_words(same)) == (plain.line, plain.left, value_words(plain))


def test_repeats_of_which_one_found_nothing_are_as_open_as_both_say():
    found, nothing = readings([5.0])[0], replace(readings([0.0], std=math.nan)[0], low=0.0, high=4.0)
    (point,) = points_of([found, nothing])
    assert (point.low, point.high) == (0.0, pytest.approx(5.0 + 1.96 * 0.2))


def test_a_volume_that_falls_within_its_ranges_is_asked_about_and_keeps_its_rate():
    """Another answer to one question explains it, or another gear: 46 mm³ and then 3.4, which may be up to 196, had no word."""
    ranges = [(30.0, 50.0), (3.1, 196.0)]
    gear = gear_trend("G1", readings([46.0, 3.4], ranges=ranges), {})
    (note,) = gear.notes
    assert note.startswith(
        "what wear only makes larger fell: wear_volume_mm3 from 46.0 to 3.40, unless the two reports answer otherwise"
    )
    assert note.endswith("is it the same gear, and the same design?") and gear.trends[QUANTITY].line is not None
    assert (
        gear_trend("G1", readings([46.0, 45.5], ranges=[(30.0, 50.0), (30.0, 50.0)]), {}).notes == ()
    )  # 1.8 standard deviations
    assert "no rate is given: is it the same gear?" in gear_trend("G1", readings([20.0, 2.0]), {}).notes[0]


def test_a_range_stands_in_place_of_a_number_that_it_makes_nothing_of():
    """Within four standard deviations it stands beside the ±."""
    for high, words in ((10.7, "10.00 ± 0.20 mm³ (may be 9.61 to 10.7)"), (11.0, "9.61 to 11.0 mm³ (likeliest 10.0)")):
        said = value_words(trend_of(readings([10.0], ranges=[(10.0 - 1.96 * 0.2, high)])))
        assert said.replace("\u202f", " ").replace("\xa0", " ") == words


def test_tables_and_page_hold_what_is_open(tmp_path):
    """Two inspections of 20 ± 0.5 and 40 ± 0.5 mm³, the later anywhere between 10 and 45."""
    scans = []
    for i, volume in enumerate((20.0, 40.0)):
        given = report(volume=(volume, 0.5))
        if i:
            given["wear"]["volume_mm3"] |= {"low": 10.0, "high": 45.0}
        scans.append((row("A", DAY + timedelta(60 * i), 1e6 * (i + 1)), given))
    store = store_of(tmp_path / "store", scans, {QUANTITY: 45.9})
    said = run("trend", store.folder)
    assert said.status == 3 and "worn volume 10.0 to 45.0 mm³ (likeliest 40.0) of 45.9, whether and when" in " ".join(
        said.out.split()
    )
    with (store.folder / "trend" / "trend.csv").open(encoding="utf-8", newline="") as stream:
        (line,) = [one for one in csv.DictReader(stream) if one["quantity"] == QUANTITY]
    scatter = 1.96 * math.hypot(0.5, 0.5)
    assert float(line["change_low"]) == pytest.approx(-10.0 - scatter) and float(line["change_high"]) == pytest.approx(
        25.0 + scatter
    )
    assert float(line["rate_low"]) == pytest.approx(1e-6 * (-10.0 - scatter), rel=1e-4)
    assert float(line["rate_high"]) == pytest.approx(1e-6 * (25.0 + scatter), rel=1e-4)
    assert (line["rate_significant"], float(line["left_low"])) == ("False", 0.0)
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    (chart,) = re.findall(rf'<svg [^>]*aria-label="{QUANTITY} of A">(.*?)</svg>', page)
    zero, top = (float(re.search(rf'y="([\d.]+)">{value}<', chart)[1]) - 2.2 for value in ("0", "40"))
    per_unit = (zero - top) / 40.0
    ends = [float(y) for y in re.findall(r'class="open" d="M[\d.]+ [\d.]+V([\d.]+)M', chart)]
    assert ends == [pytest.approx(zero - per_unit * value, abs=0.11) for value in (9.0, 46.0)]  # the range, and 2 u beyond

"""Repeats against the stated ±."""

from __future__ import annotations

import math
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import chi2

from gearwear.comparison.same_teeth import TeethPattern
from gearwear.fleet.gauge import Accord, Repeat, gauge_study, in_accord, scatter
from gearwear.fleet.labels import shown
from gearwear.fleet.pages import gauge_page
from gearwear.fleet.reading import gauge_studies, read_fleet
from gearwear.fleet.words import accord_words, gauge_line, gauge_lines
from tests.fleet.fleets import report, row, store_of


def scans(rng, stated=0.1, true=0.1, operators="AB", repeats=3, parts=5):
    return [
        Repeat(f"P{p}", who, str(r), float(p + true * rng.standard_normal()), stated)
        for p in range(parts) for who in operators for r in range(repeats)
    ]  # fmt: skip


def test_scatter_over_the_stated_is_chi_square_by_hand():
    groups = [
        [Repeat("P", "A", "1", 1.0, 0.5), Repeat("P", "A", "2", 2.0, 0.5)],
        [Repeat("Q", "A", "1", 0.0, 1.0), Repeat("Q", "A", "2", 3.0, 1.0)],
    ]
    found = scatter(groups)
    square = 2 * 0.5**2 / 0.5**2 + 2 * 1.5**2
    assert (found.degrees, found.ratio) == (2, pytest.approx(math.sqrt(square / 2)))
    assert found.p_value == pytest.approx(chi2.sf(square, 2))
    assert (found.low, found.high) == (
        pytest.approx(math.sqrt(square / chi2.ppf(0.975, 2))),
        pytest.approx(math.sqrt(square / chi2.ppf(0.025, 2))),
    )


def test_unequal_stated_scatter_is_weighed():
    """A scan that states next to nothing of itself takes no part."""
    pair = [Repeat("P", "A", "1", 1.0, 0.1), Repeat("P", "A", "2", 1.2, 0.1)]
    alone, beside = scatter([pair]), scatter([[*pair, Repeat("P", "A", "3", 9.0, 1e9)]])
    assert beside.ratio * math.sqrt(2) == pytest.approx(alone.ratio, rel=1e-6)


@pytest.mark.parametrize(("factor", "accord"), [(1.0, Accord.ALIKE), (2.5, Accord.MORE), (0.3, Accord.LESS)])
def test_what_repeats_say_of_the_stated(factor, accord):
    (study,) = in_accord([gauge_study("wear_depth_mm", "", scans(np.random.default_rng(4), true=0.1 * factor))])
    assert study.accord is accord
    assert study.repeatability.low < factor < study.repeatability.high


def test_chance_contradicts_seldom_among_many_quantities():
    """200 fleets of 10 quantities whose ± is right: at most one in twenty fleets has a false contradiction, within 3 standard errors."""
    rng = np.random.default_rng(6)
    wrong = sum(
        any(
            one.accord is Accord.MORE
            for one in in_accord([gauge_study("q", str(i), scans(rng, operators="A", repeats=2)) for i in range(10)])
        )
        for _ in range(200)
    )
    assert wrong / 200 <= 0.05 + 3.0 * math.sqrt(0.05 * 0.95 / 200)


def test_the_same_error_in_every_scan_does_not_show():
    given = scans(np.random.default_rng(7))
    moved = [replace(one, value=one.value + 5.0) for one in given]
    plain, other = gauge_study("q", "", given), gauge_study("q", "", moved)
    assert other.repeatability.ratio == pytest.approx(plain.repeatability.ratio)


def test_operators_that_differ_show_as_reproducibility():
    given = [
        replace(one, value=one.value + (0.5 if one.operator == "B" else 0.0)) for one in scans(np.random.default_rng(8), parts=8)
    ]
    study = gauge_study("q", "", given)
    assert study.repeatability.high > 1.0 > study.repeatability.low
    assert study.reproducibility.low > 1.5
    assert study.variance.reproducibility.std == pytest.approx(
        0.5 / math.sqrt(2.0), rel=0.2
    )  # of two operators half a unit apart


def test_operators_that_differ_contradict_the_stated_where_their_own_repeats_do_not():
    """Three operators, 12 µm apart at ± 3: the verdict said that nothing contradicts."""
    off = {"A": -12.0, "B": 0.0, "C": 12.0}
    given = scans(np.random.default_rng(8), stated=3.0, true=3.0, operators="ABC")
    studies = in_accord([gauge_study("wear_depth_mm", "", [replace(one, value=one.value + off[one.operator]) for one in given])])
    assert studies[0].accord is Accord.OPERATORS
    assert accord_words(studies) == (
        "Repeats contradict the stated ± of none of 1 quantity. Scans by different operators contradict it, beyond their repeats, of 1: deepest wear."
    )
    (alike,) = in_accord([gauge_study("wear_depth_mm", "", given)])
    assert alike.accord is Accord.ALIKE


def test_two_answers_to_one_question_contradict_nothing():
    """Every other scan calls 40 mm³ made so and not worn, and says so by its range; without the range it is a contradiction."""
    given = [
        replace(
            one,
            value=one.value - 40.0 * (int(one.repeat) % 2),
            up=40.0 * (int(one.repeat) % 2),
            down=40.0 * (1 - int(one.repeat) % 2),
        )
        for one in scans(np.random.default_rng(4))
    ]
    (study,) = in_accord([gauge_study("wear_volume_mm3", "", given)])
    (plain,) = in_accord([gauge_study("wear_volume_mm3", "", [replace(one, down=0.0, up=0.0) for one in given])])
    assert (study.accord, plain.accord) == (Accord.RANGES, Accord.MORE)  # "agree" stood beside a ratio of a hundred
    assert study.repeatability.ratio == plain.repeatability.ratio > 100.0


def test_the_least_that_ranges_leave_is_that_of_a_search():
    """Of a mean anywhere, by scipy."""
    low, high, std = np.array([0.0, 3.0, 8.0, 1.0]), np.array([1.0, 3.5, 9.0, 20.0]), np.array([0.5, 1.0, 2.0, 0.1])
    given = [Repeat("P", "A", str(i), *one) for i, one in enumerate(zip(low, std, 0.0 * low, high - low, strict=True))]
    found = minimize_scalar(
        lambda mean: float(np.square((mean - np.clip(mean, low, high)) / std).sum()), bounds=(0.0, 20.0), method="bounded"
    )
    assert scatter([given]).p_value == pytest.approx(chi2.sf(found.fun, 3), rel=1e-6)


def test_scans_that_found_no_wear_are_no_zeros():
    given = scans(np.random.default_rng(9))
    nothing = [
        replace(one, value=0.0, std=math.nan, found=False) if (one.part, one.repeat) == ("P4", "0") else one for one in given
    ]
    study = gauge_study("q", "", nothing)
    assert study.variance.repeatability.std < 0.2 and study.repeats == 2
    assert study.left_out == 2 + 4 * 2  # those two, and a repeat of each operator on the other gears


def test_the_largest_balanced_study_is_taken():
    given = [
        one
        for one in scans(np.random.default_rng(9), operators="ABC")
        if not (one.part == "P0" and one.operator == "C" and one.repeat > "0")
    ]
    study = gauge_study("q", "", given)
    assert (study.parts, study.operators, study.repeats, study.left_out) == (("P1", "P2", "P3", "P4"), ("A", "B", "C"), 3, 7)


def test_without_repeats_there_is_no_study():
    assert gauge_study("q", "", scans(np.random.default_rng(1), repeats=1)) is None


def test_one_gear_has_repeatability_and_no_components():
    study = gauge_study("q", "", scans(np.random.default_rng(1), parts=1))
    assert study.variance is None and study.repeatability.degrees == 4


def test_where_nothing_is_stated_nothing_is_said():
    (study,) = in_accord([gauge_study("q", "", scans(np.random.default_rng(1), stated=math.nan))])
    assert (study.accord, study.repeatability) == (Accord.UNKNOWN, None)
    assert study.variance is not None


def _studied(folder, inspections):
    """The study of the worn volume of one gear: a scan for each (date, cycles, operator, repeat, volume)."""
    store = store_of(folder, [(row("G", *when), report(volume=(volume, 0.05))) for *when, volume in inspections])
    studies, scans = gauge_studies(read_fleet(store))
    named = [scan.part for scan in scans["wear_volume_mm3", ""]]
    return next((study for study in studies if study.quantity == "wear_volume_mm3"), None), named


def test_a_gear_that_wears_is_another_part_at_other_cycles(tmp_path):
    """Two scans 0.02 mm³ apart at each of two inspections of 1 and 5 mm³: repeatability is √(2 · 0.01²) of them, not the wear."""
    study, _ = _studied(tmp_path / "s", [
        (None, cycles, "A", str(i), volume + 0.02 * i) for cycles, volume in ((1e6, 1.0), (2e6, 5.0)) for i in range(2)
    ])  # fmt: skip
    assert (study.parts, study.repeats) == (("G 1000000 cycles", "G 2000000 cycles"), 2)
    assert study.variance.repeatability.std == pytest.approx(math.sqrt(2.0) * 0.01)
    assert study.variance.part.variance == pytest.approx(4.0**2 / 2 - 0.01**2)


def test_scans_of_one_date_at_other_cycles_are_other_parts(tmp_path):
    day = datetime(2026, 3, 1)
    _, parts = _studied(tmp_path / "s", [(day, 1e6, "A", "1", 1.0), (day, 2e6, "A", "1", 5.0)])
    assert parts == ["G 1000000 cycles", "G 2000000 cycles"]


def test_a_gear_that_did_not_run_is_the_same_part_on_another_day(tmp_path):
    """One operator on Monday and one on Tuesday, or each scan with its time of day, were no study."""
    study, _ = _studied(tmp_path / "s", [
        (datetime(2026, 3, day, hour), 1e6, who, str(hour), 1.0 + 0.01 * hour) for day, who in ((1, "A"), (2, "B")) for hour in (8, 9)
    ])  # fmt: skip
    assert (study.parts, study.operators, study.repeats) == (("G 1000000 cycles",), ("A", "B"), 2)


def test_nothing_found_comes_from_the_store_as_such(tmp_path):
    nothing = report()
    nothing["wear"]["regions"] = []
    when = datetime(2026, 3, 1), 1e6, "A"
    store = store_of(tmp_path / "s", [(row("G", *when, str(i)), given) for i, given in enumerate((report(), report(), nothing))])
    _, scans = gauge_studies(read_fleet(store))
    assert sorted(scan.found for scan in scans["wear_volume_mm3", ""]) == [False, True, True]
    assert all(scan.found for scan in scans["thickness_loss_mm", ""])


@pytest.mark.parametrize("size", ["volume_mm3", "area_mm2"])
def test_nothing_found_is_no_zero_of_the_page_nor_of_a_section(tmp_path, size):
    """Two gears of 1 and 2, scanned twice, and once more without wear found; what may be there is two patches at the limit."""

    def found(value):
        wear = {
            size: {"value": value, "std": 0.05},
            "detection_limit_um": 20.0,
            f"detection_{'area_mm2' if size == 'volume_mm3' else 'length_mm'}": 3.0,
        }
        region = {"tooth": 3, "flank": "left", size: wear[size], "max_depth_um": 50.0, "max_depth_std_um": 4.0}
        return report() | {"wear": wear | {"regions": [region] if value else [], "flanks": []}}

    given = [
        (row(f"G{part}", None, 1e6, "A", str(i)), found(value))
        for part in (1, 2) for i, value in enumerate((part - 0.1, part + 0.1, 0.0))
    ]  # fmt: skip
    fleet = read_fleet(store_of(tmp_path / "s", given))
    studies, scans = gauge_studies(fleet)
    (study,) = (one for one in studies if one.quantity == f"wear_{size}")
    assert (study.repeats, study.left_out) == (2, 2)
    assert study.variance.repeatability.std == pytest.approx(math.sqrt(2.0) * 0.1)
    hidden = [number["high"] for number in fleet.numbers if number["quantity"] == f"wear_{size}" and number["value"] == 0.0]
    assert hidden == [pytest.approx(2 * 0.02 * 3.0)] * 2
    page = gauge_page([study], scans)
    assert all(shown(study.quantity, mean, 0.05) in page for mean in (1.0, 2.0))


def test_a_repeat_that_lay_the_other_way_up_has_its_sides_exchanged(tmp_path):
    """80 µm left and 20 µm right of both gears, ± 1: where one scan of four lay upside down, its left is their right, of halves with lower
    and upper exchanged. It read as repeats 60 µm apart that contradict the ±."""
    rng, given = np.random.default_rng(3), []
    true = {("single_pitch", "left"): 80.0, ("single_pitch", "right"): 20.0}
    for part in (1, 2):
        own = rng.normal(size=(17, 2, 3, 3))
        for i, over in enumerate((False, True, False, False)):
            pattern = TeethPattern("form and marks", 3.0 * own + rng.normal(size=own.shape))
            if over:
                pattern = TeethPattern(pattern.name, pattern.laid(2, True))
            other = {"left": "right", "right": "left"}
            findings = [
                {
                    "quantity": name,
                    "flank": other[side] if over else side,
                    "value_um": value + 10.0 * part + 0.5 * i,
                    "expanded_um": 2.0,
                }
                for (name, side), value in true.items()
            ]
            halves = [("upper" if over else "lower", findings), ("lower" if over else "upper", findings[:1])]
            one = report() | {"scan": {"teeth_patterns": [{"name": pattern.name, "values": pattern.values.tolist()}]}}
            one["inspection_halves"] = {half: {"findings": found} for half, found in halves}
            given.append((row(f"G{part}", None, 1e6, "A", str(i)), one | {"inspection": {"findings": findings}}))
    _, scans = gauge_studies(read_fleet(store_of(tmp_path / "s", given)))
    for (name, side), value in true.items():
        for half in ("", "lower_half_"):
            found = sorted(scan.value for scan in scans[f"{half}{name}_um", side] if scan.part.startswith("G1"))
            assert found == [value + 10.0 + 0.5 * i for i in range(4)]
    assert ("upper_half_single_pitch_um", "right") not in scans


def test_a_wide_ratio_keeps_its_line_on_the_terminal(tmp_path):
    """Intervals of 11.18 (6.70 to 32.14) were cut off at the edge."""
    given = [replace(one, std=0.001) for one in scans(np.random.default_rng(4), repeats=2, parts=2)]
    (study,) = in_accord([gauge_study("cumulative_pitch_um", "right", given)])
    line = gauge_line(study)
    assert study.repeatability.ratio > 10.0 and len(line) + 2 <= 80 and line.endswith(")")


def test_without_date_and_cycles_repeats_are_told_apart_or_none(tmp_path):
    study, _ = _studied(tmp_path / "told", [(None, None, "A", str(i), 1.0 + 0.02 * i) for i in range(2)])
    assert (study.parts, study.repeats) == (("G",), 2)
    none, parts = _studied(tmp_path / "not", [(None, None, "", "", 1.0), (None, None, "", "", 5.0)])
    assert none is None and parts == ["G", "G inspection 2"]


def test_a_study_of_one_gear_says_why_its_columns_are_empty():
    """Of one gear there is no scatter of gears to hold the gauge against."""
    for parts, said in ((1, True), (3, False)):
        lines = [
            line
            for line, _ in gauge_lines(
                in_accord([gauge_study("wear_depth_mm", "", scans(np.random.default_rng(4), parts=parts))])
            )
        ]
        assert any("at least two gears" in line for line in lines) == said

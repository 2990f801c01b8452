"""Trend and gauge from a store to files, pages and exit status."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from datetime import datetime, timedelta
from html import unescape

import numpy as np
import pyarrow.parquet as pq
import pytest

from gearwear.fleet.outcome import State
from tests.commands.doors import run
from tests.fleet.fleets import report, row, store_of

START = datetime(2026, 1, 1)
LIMITS = {"wear_depth_mm": 0.1}


def inspections(gear_id, depths, std=4.0):
    """Reports at inspections every 60 days, by depth in µm."""
    return [
        (
            row(gear_id, START + timedelta(60 * i), 1e6 * (i + 1)),
            report((0.02 * depth, 0.05), (depth, std), (1e-3 * depth, 0.004)),
        )
        for i, depth in enumerate(depths)
    ]


def table(path):
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_tables_hold_what_was_put_in(tmp_path):
    store = store_of(tmp_path / "store", [*inspections("A", [20, 40, 60]), *inspections("B", [10, 10, 11])], LIMITS)
    said = run("trend", store.folder)
    assert said.status == 0
    folder = store.folder / "trend"
    assert {path.name for path in folder.iterdir()} == {
        "trend.html",
        "trend.csv",
        "trend.parquet",
        "inspections.csv",
        "inspections.parquet",
        "teeth.csv",
        "teeth.parquet",
    }
    rows = {(one["gear_id"], one["quantity"]): one for one in table(folder / "trend.csv")}
    depth = rows["A", "wear_depth_mm"]
    assert (depth["rank"], depth["conformity"], depth["inspections"], depth["last"]) == (
        "1",
        "conforming",
        "3",
        "2026-05-01T00:00:00",
    )
    assert float(depth["rate"]) == pytest.approx(2e-8)
    assert float(depth["left"]) == pytest.approx(2e6)
    assert depth["limit_on"].startswith("2026-08-29")  # 120 days on
    assert (depth["rate_significant"], rows["B", "wear_depth_mm"]["rate_significant"]) == ("True", "False")
    steps = [one for one in table(folder / "inspections.csv") if (one["gear_id"], one["quantity"]) == ("A", "wear_depth_mm")]
    assert [float(one["value"]) for one in steps] == pytest.approx([0.02, 0.04, 0.06])
    assert [one["change"] and float(one["change"]) for one in steps] == ["", pytest.approx(0.02), pytest.approx(0.02)]
    for name in ("trend", "inspections"):
        columns = pq.read_table(folder / f"{name}.parquet").to_pydict()
        assert list(columns) == list(table(folder / f"{name}.csv")[0])
        assert len(columns["gear_id"]) == len(table(folder / f"{name}.csv"))


@pytest.mark.parametrize(("depths", "limits", "status"), [
    ([60], LIMITS, 0), ([60], {}, 0), ([97], LIMITS, 3), ([130], LIMITS, 1), ([60], {"backlash_mm": 0.1}, 3),
])  # fmt: skip
def test_exit_status_for_scripts(tmp_path, depths, limits, status):
    store = store_of(tmp_path / "store", [*inspections("A", depths), *inspections("B", [1])], limits)
    assert run("trend", store.folder, "--quiet").status == status
    assert run("gauge", store.folder, "--quiet").status == 0


def test_a_gear_without_any_result_is_not_passed_for_want_of_limits(tmp_path):
    """Its design was refused, for its limits say: they are not known, and exit status 0 said that all gears conform."""
    scans = [*inspections("A", [60]), (row("B", START), State.REFUSED)]
    assert run("trend", store_of(tmp_path / "store", scans).folder, "--quiet").status == 3


def test_a_worn_gear_is_not_called_conforming_by_an_older_scan_without_a_date(tmp_path):
    """1 µm when new, undated; 500 µm after a million cycles, of 100 µm allowed."""
    new, worn = (report((0.02 * depth, 0.05), (depth, 4.0), (1e-3 * depth, 0.004)) for depth in (1.0, 500.0))
    store = store_of(tmp_path / "cycles", [(row("A", None, 0.0), new), (row("A", START, 1e6), worn)], LIMITS)
    said = run("trend", store.folder)
    assert said.status == 1 and "1 beyond a limit" in said.out and "!" not in said.out
    store = store_of(tmp_path / "neither", [(row("A"), new), (row("A", START, 1e6), worn)], LIMITS)
    said = run("trend", store.folder)
    assert said.status == 1
    assert "! which of 2 inspections is the last is not known, the worst counts: 1 of 2" in " ".join(said.out.split())
    steps = table(store.folder / "trend" / "inspections.csv")
    assert [(one["value"], one["change"]) for one in steps if one["quantity"] == "wear_depth_mm"] == [("0.001", ""), ("0.5", "")]


@pytest.mark.parametrize(("repeats", "status"), [(["1", "2", "3"], 0), (["", "", ""], 3), (["1", "2", "2"], 3)])
def test_scans_with_neither_date_nor_cycles_are_one_inspection_where_repeats_tell_them_apart(tmp_path, repeats, status):
    """Their mean is judged then, with what they scatter, 41 ± 39 µm of 121; else the worst, 120 ± 4 µm."""
    given = [report((1.0, 0.05), (depth, 4.0), (0.05, 0.004)) for depth in (2.0, 2.0, 120.0)]
    store = store_of(
        tmp_path / "store",
        [(row("A", repeat=repeat), one) for repeat, one in zip(repeats, given, strict=True)],
        {"wear_depth_mm": 0.121},
    )
    assert run("trend", store.folder).status == status


def test_where_the_last_is_not_known_the_strictest_limit_counts(tmp_path):
    store = store_of(tmp_path / "store", [*inspections("A", [60]), (row("A"), report(depth=(60.0, 4.0)))], LIMITS)
    listed = [
        (row("A", START, 1e6), one.key, {"wear_depth_mm": limit}) for one, limit in zip(store.listed(), (0.1, 0.05), strict=True)
    ]
    store.keep_manifest("fleet.csv", [listed[0], (row("A"), *listed[1][1:])])
    assert run("trend", store.folder).status == 1


def test_names_that_differ_by_capitals_or_blanks_alone_are_told_of(tmp_path):
    store = store_of(tmp_path / "store", [*inspections("G 1", [20]), *inspections("g1", [40]), *inspections("G2", [40])], LIMITS)
    said = run("trend", store.folder).out
    assert "! there is g1 too: is it the same gear?" in said and "! there is G 1 too: is it the same gear?" in said
    assert said.count("there is") == 2


def test_scans_without_a_result_are_told_of(tmp_path):
    scans = [*inspections("A", [20]), (row("A", START + timedelta(90), 2e6), State.FAILED), (row("C", START), State.REFUSED)]
    scans.append((row("D", START, 1e6), report(converged=False)))
    store = store_of(tmp_path / "store", scans, LIMITS)
    said = run("trend", store.folder)
    assert said.status == 3
    assert "3 gears, 4 scans; 1 refused, 1 failed" in said.out
    assert "1 of 2 scans failed" in said.out
    assert "their registration did not" in said.out
    assert re.search(r"C +no result: no scan gave one", said.out)


def test_what_is_no_store(tmp_path):
    for name in ("trend", "gauge"):
        said = run(name, tmp_path)
        assert (said.status, "holds no fleet" in said.err, list(tmp_path.iterdir())) == (2, True, [])


def gauge_store(folder, true, stated):
    rng = np.random.default_rng(3)
    scans = []
    for part, depth in enumerate((30.0, 60.0, 90.0, 120.0)):
        for who in "AB":
            for repeat in "123":
                found = depth + true * rng.standard_normal()
                scans.append(
                    (
                        row(f"P{part}", START, 1e6, who, repeat),
                        report((0.02 * found, 0.02 * stated), (found, stated), (1e-3 * found, 1e-3 * stated)),
                    )
                )
    return store_of(folder, scans)


@pytest.mark.parametrize(
    ("true", "accord"), [(4.0, "repeats agree with the stated ±"), (12.0, "repeats contradict the stated ±")]
)
def test_a_gauge_study_from_the_store(tmp_path, true, accord):
    store = gauge_store(tmp_path / "store", true, 4.0)
    said = run("gauge", store.folder)
    assert said.status == 0
    assert said.out.startswith("4 gears, 2 operators, 3 repeats\n")
    rows = {one["quantity"]: one for one in table(store.folder / "gauge" / "gauge.csv")}
    depth = rows["wear_depth_mm"]
    assert depth["accord"] == accord
    assert float(depth["repeatability_std_low"]) < 1e-3 * true < float(depth["repeatability_std_high"])
    assert float(depth["part_std_low"]) < 0.0387 < float(depth["part_std_high"])  # of 30, 60, 90, 120 µm
    assert pq.read_table(store.folder / "gauge" / "gauge.parquet").num_rows == len(rows)


def test_pages_ask_for_nothing_and_escape_names(tmp_path):
    store = store_of(tmp_path / "store", [*inspections("<b>&G", [20, 40]), *inspections("<b>&G", [20])[:0]], LIMITS)
    run("trend", store.folder, "--quiet")
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    assert "<b>&G" not in page and "&lt;b&gt;&amp;G" in page
    assert not re.search(r'(?:src|href)="(?!#)|url\(|<script', page)


def test_every_mark_leads_to_its_gear(tmp_path):
    """Also where gears without limits stand between."""
    store = store_of(
        tmp_path / "store", [*inspections("A", [130]), (row("B", START), State.FAILED), *inspections("C", [20])], LIMITS
    )
    run("trend", store.folder, "--quiet")
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    cards = dict(re.findall(r'id="(g\d+)"><h3>(\w+)<', page))
    assert sorted(cards.values()) == ["A", "B", "C"]
    marks = re.findall(r'<a href="#(g\d+)"><title>(\w+)</title>', page)
    assert len(marks) == 2
    assert all(cards[ident] == name for ident, name in marks)


@pytest.mark.long
def test_a_page_of_hundreds_of_gears_stays_small(tmp_path):
    scans = [one for i in range(150) for one in inspections(f"G{i}", [0.2 * i + 5, 0.4 * i + 5])]
    store = store_of(tmp_path / "store", scans, LIMITS)
    run("trend", store.folder, "--quiet")
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    assert page.count('<article class="card') == 150
    assert page.count("<svg") == 1 + 3 * 150
    assert len(page) < 150 * 5000 + 50_000
    again = (store.folder / "trend" / "trend.html").read_bytes()
    run("trend", store.folder, "--quiet")
    assert (store.folder / "trend" / "trend.html").read_bytes() == again


def test_the_overview_names_gears_and_small_charts_have_numbered_scales(tmp_path):
    names = ["first", "<b>&second", "a name that is far too long to stand there"]
    store = store_of(tmp_path / "store", [one for name in names for one in inspections(name, [20, 40])], LIMITS)
    run("trend", store.folder, "--quiet")
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    overview = page[page.index('<svg class="overview"') : page.index("</svg>", page.index('<svg class="overview"'))]
    shown = re.findall(r'<text class="name level"[^>]*>([^<]*)</text>', overview)
    assert sorted(map(unescape, shown)) == sorted(["first", "<b>&second", "a name that i…"])
    (chart,) = re.findall(r'<svg [^>]*aria-label="wear_depth_mm of first">(.*?)</svg>', page)
    limit = LIMITS["wear_depth_mm"]
    zero, *others = ((float(y), float(value)) for y, value in re.findall(r'class="up"[^>]* y="([\d.]+)">([\d.]+)<', chart))
    at_limit = float(re.search(r'class="limit" d="M[\d.]+ ([\d.]+)H', chart)[1])
    assert zero[1] == 0.0 and len(others) >= 2
    for y, value in others:  # the scale is that of the limit's line: text stands 2.2 below its tick
        assert (zero[0] - y) / (zero[0] - 2.2 - at_limit) == pytest.approx(value / limit, abs=0.01)
    assert len(re.findall(r'class="along"', chart)) >= 2


def test_one_gear_without_cycles_takes_no_line_from_the_others(tmp_path):
    """Nor do dates that are missing take their dots from gears that have cycles."""
    by_date = [(replace(one, cycles_run=None), given) for one, given in inspections("B", [20, 40])]
    undated = [(replace(one, inspected=None), given) for one, given in inspections("C", [20, 40])]
    store = store_of(tmp_path / "store", [*inspections("A", [20, 40]), *by_date, *undated], LIMITS)
    run("trend", store.folder, "--quiet")
    page = (store.folder / "trend" / "trend.html").read_text(encoding="utf-8")
    for name, along in (("A", "1"), ("B", "2026-01-01"), ("C", "1")):
        (chart,) = re.findall(rf'<svg [^>]*aria-label="wear_depth_mm of {name}">(.*?)</svg>', page)
        assert chart.count('class="dot"') == 2 and 'class="fit"' in chart and f">{along}<" in chart
    assert "Along x: millions of mesh cycles since new, up to 2.6; or the date, 2026-01-01 to 2026-03-02, of gears" in page


@pytest.mark.long
def test_where_gears_are_close_not_every_one_is_named(tmp_path):
    scans = [one for i in range(150) for one in inspections(f"G{i}", [0.2 * i + 5, 0.4 * i + 5])]
    run("trend", store_of(tmp_path / "store", scans, LIMITS).folder, "--quiet")
    page = (tmp_path / "store" / "trend" / "trend.html").read_text(encoding="utf-8")
    places = [float(x) for x in re.findall(r'class="name" transform="translate\(([\d.]+) ', page)]
    assert len(places) == 75 and min(np.diff(places)) > 11.0

"""One page for the trend of a fleet, and one for its gauge study: offline, for hundreds of gears, on a screen, a phone and paper."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from gearwear.design.quantity import significant
from gearwear.fleet import words
from gearwear.fleet.anova import Component
from gearwear.fleet.gauge import Accord, GaugeStudy, Repeat
from gearwear.fleet.labels import date_words, rate_words, shown, title_of
from gearwear.fleet.panels import (
    Scales,
    clock_of,
    css,
    day_words,
    largest,
    overview,
    ratio_panel,
    repeat_panel,
    scales_of,
    trend_panel,
)
from gearwear.fleet.reading import StoredFleet
from gearwear.fleet.trend import CYCLES, DAYS, GearTrend, Trend
from gearwear.report.page.environment import environment
from gearwear.report.records.comparison import made_by

HERE = Path(__file__).parent / "page"
ACCORDS = {
    Accord.MORE: ("contradict", "not-conforming"),
    Accord.OPERATORS: ("operators contradict", "not-conforming"),
    Accord.ALIKE: ("agree", "conforming"),
    Accord.RANGES: ("agree with the ranges", "conforming"),
    Accord.LESS: ("scatter less", "conforming"),
    Accord.UNKNOWN: ("", "none"),
}
"""What repeats say of the stated ±: word and class of the style."""


@dataclass(frozen=True, slots=True)
class SmallChart:
    """A small chart with what stands above it."""

    title: str
    value: str
    svg: Markup
    beyond: bool = False


@dataclass(frozen=True, slots=True)
class GearCard:
    """A gear on the page.

    Parameters
    ----------
    ident, name, state, kind, said : str
        Its address, its name, its state in words and as a class of the style, and what is most urgent.
    notes : sequence of str
    panels : sequence of SmallChart
    """

    ident: str
    name: str
    state: str
    kind: str
    said: str
    notes: Sequence[str]
    panels: Sequence[SmallChart]


def trend_page(fleet: StoredFleet, gears: Sequence[GearTrend]) -> str:
    """The page of the trend; the same bytes for the same input."""
    scales = scales_of(gears)
    cards = []
    for rank, gear in enumerate(gears, 1):
        shown_trends = [gear.trends[name] for name in words.MAIN if name in gear.trends]
        panels = [
            SmallChart(title_of(trend.quantity), words.value_words(trend), trend_panel(trend, scales), _beyond(trend))
            for trend in shown_trends
        ]
        state = words.state_words(gear)
        cards.append(GearCard(f"g{rank}", gear.gear_id, state, css(gear.conformity), words.gear_words(gear), gear.notes, panels))
    tops = scales[CYCLES].tops
    return environment(HERE).get_template("trend.html.j2").render(
        subject=words.fleet_words(fleet, gears), verdict=words.verdict_words(gears), overview=overview(gears), cards=cards,
        rows=[_row(rank, gear) for rank, gear in enumerate(gears, 1)], along=_along(gears, scales),
        tops=[f"{title_of(name)} {shown(name, tops[name], math.nan)}" for name in words.MAIN if name in tops], same_teeth=words.SAME_TEETH,
        footer=_footer(),
    )  # fmt: skip


def _beyond(trend: Trend) -> bool:
    return css(trend.conformity) == "not-conforming"


def _along(gears: Sequence[GearTrend], scales: Mapping[str, Scales]) -> str:
    """What stands along x."""
    clocks = {clock_of(trend) for gear in gears for trend in gear.trends.values()}
    said = []
    if CYCLES in clocks:
        said.append(f"millions of mesh cycles since new, up to {significant(1e-6 * scales[CYCLES].end, 2)}")
    if DAYS in clocks:
        span = " to ".join(dict.fromkeys(day_words(day) for day in (scales[DAYS].start, scales[DAYS].last)))
        said.append(f"the date, {span}" + (", of gears whose cycles do not tell" if len(clocks) > 1 else ""))
    return "; or ".join(said)


def _row(rank: int, gear: GearTrend) -> list[str]:
    """A gear in the table of all."""
    trend = gear.nearest or gear.trends.get("wear_volume_mm3")
    volume = gear.trends.get("wear_volume_mm3")
    rate = "–" if volume is None else rate_words(volume) + ("" if volume.significant else " (not significant)")
    reached = ""
    if trend is not None and trend.days_left is not None and trend.limit is not None:
        reached = date_words(trend.date(trend.days_left.value)) or "–"
    return [str(rank), gear.gear_id, words.state_words(gear), words.gear_words(gear), reached, rate]


def gauge_page(studies: Sequence[GaugeStudy], scans: Mapping[tuple[str, str], Sequence[Repeat]]) -> str:
    """The page of the gauge study; the same bytes for the same input."""
    main = [
        study
        for study in studies
        if study.quantity in words.MAIN and study.variance is not None and study.variance.total.variance > 0.0
    ]
    halves = {study.quantity: _half(study, scans[study.quantity, study.flank]) for study in main}
    cards = []
    for i, part in enumerate(dict.fromkeys(part for study in main for part in study.parts), 1):
        panels = []
        for study in main:
            repeats = _found_on(part, scans[study.quantity, study.flank])
            if len(repeats) > 1:
                mean = sum(repeat.value for repeat in repeats) / len(repeats)
                svg = repeat_panel(repeats, study.operators, halves[study.quantity])
                panels.append(SmallChart(title_of(study.quantity), shown(study.quantity, mean, study.stated), svg))
        cards.append(GearCard(f"g{i}", part, "", "none", "", (), panels))
    heights = [f"{title_of(study.quantity)} ± {shown(study.quantity, halves[study.quantity], float('nan'))}" for study in main]
    return environment(HERE).get_template("gauge.html.j2").render(
        subject=words.study_words(studies) if studies else "", verdict=words.accord_words(studies) if studies else words.NOTHING_REPEATED,
        rows=[_gauge_row(study) for study in studies], cards=cards, heights=heights, cannot=words.REPEATS_CANNOT,
        why_empty=" ".join(words.empty_words(studies)),
        operators="; ".join(max(studies, key=lambda study: len(study.operators)).operators) if studies else "", footer=_footer(),
    )  # fmt: skip


def _found_on(part: str, scans: Sequence[Repeat]) -> list[Repeat]:
    """The scans of a part that the study can be of: where no wear was found there is no 0 to compare with."""
    return [scan for scan in scans if scan.part == part and scan.found]


def _half(study: GaugeStudy, scans: Sequence[Repeat]) -> float:
    """What half the height of a chart stands for: the largest distance from the mean of a part, with its 2 u."""
    reach = []
    for part in study.parts:
        repeats = _found_on(part, scans)
        mean = sum(repeat.value for repeat in repeats) / len(repeats)
        reach += [abs(repeat.value - mean) + 2.0 * (repeat.std if repeat.std > 0.0 else 0.0) for repeat in repeats]
    return largest(reach)


@dataclass(frozen=True, slots=True)
class GaugeLine:
    """A quantity in the table of the gauge study; each cell a value and its interval, which may be empty."""

    title: str
    cells: Sequence[tuple[str, str]]
    svg: Markup
    accord: str
    kind: str


def _gauge_row(study: GaugeStudy) -> GaugeLine:
    variance, repeats, unit = study.variance, study.repeatability, study.quantity

    def spread(part: Component | None) -> tuple[str, str]:
        if part is None:
            return "–", ""
        return shown(unit, part.std, math.nan), " to ".join(significant(end, 2) for end in part.std_interval)

    cells = [("–", "")] * 6
    if variance is not None:
        cells = [
            spread(component) for component in (variance.repeatability, variance.reproducibility, variance.gauge, variance.part)
        ]
        cells.append(("–" if math.isnan(variance.share) else f"{100.0 * variance.share:.0f} %", ""))
        cells.append(("–" if variance.categories is None else str(variance.categories), ""))
    cells.append((shown(unit, study.stated, math.nan), ""))
    cells.append(("–", "") if repeats is None else (f"{repeats.ratio:.2f}", f"{repeats.low:.2f} to {repeats.high:.2f}"))
    accord, kind = ACCORDS[study.accord]
    return GaugeLine(title_of(unit, study.flank), cells, Markup("") if repeats is None else ratio_panel(repeats), accord, kind)


def _footer() -> str:
    return f"Made by {made_by()}. ± is one standard deviation, bars are two; intervals hold 95 %."

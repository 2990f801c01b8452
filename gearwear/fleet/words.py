"""Trend and gauge study in words: the verdict, the most urgent gears, what repeats say of the stated ±."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

from gearwear.design.conformity import Conformity
from gearwear.design.quantity import NORMAL_95, SPACE, counted, listed, sentence, significant, unbroken
from gearwear.fleet.gauge import Accord, GaugeStudy, Scatter
from gearwear.fleet.labels import left_words, rate_words, shown, title_of, unit_of
from gearwear.fleet.outcome import State
from gearwear.fleet.reading import StoredFleet
from gearwear.fleet.trend import GearTrend, Trend

WIDTH = 80
"""Letters of a line on the terminal."""
MOST = 15
"""Gears on the terminal."""
NAMED = 5
"""Gears without a result that the verdict names."""
LOPSIDED = 4.0
"""Standard deviations that a range must reach for it to be told in place of the number with its ±, as the report does."""
NAME = 23
"""Letters of a quantity's name on the terminal."""
MAIN = ("wear_volume_mm3", "wear_area_mm2", "wear_depth_mm", "thickness_loss_mm", "backlash_mm")
"""Quantities of the small charts."""
SAME_TEETH = (
    "Numbers are those of the whole gear, its worst as a rule. Numbers of single teeth stand in teeth.csv, under the tooth numbers of the gear's"
    " first scan: which tooth is which, and which end is up, is told by pitch, form, marks and damage of the gear, with the probability beside it."
)
UNDECIDED = "undecided"
"""Said of a gear of which it is not proven that it conforms, nor that it does not (`Conformity.NEITHER`)."""
ONE_GEAR = "Repeatability, operators, GRR and ndc take at least two gears, each scanned equally often by the same operators."
"""Why columns of the gauge study are empty."""
NOTHING_REPEATED = (
    "No gear was scanned twice at the same inspection by the same operator: there is nothing to study. Scans of one inspection have the same"
    " cycles_run, or where that is not known the same inspected, to the minute if it has a time."
)
REPEATS_CANNOT = (
    "What repeats alike, as a coat or a scale does, no repeat can show: it is in the stated ± and not in the scatter."
)


def fleet_words(fleet: StoredFleet, gears: Sequence[GearTrend]) -> str:
    """What there is: "30 gears, 150 scans; 2 refused"."""
    not_compared = [
        f"{number} {noun}"
        for number, noun in (
            (fleet.count(State.REFUSED), "refused"),
            (fleet.count(State.FAILED), "failed"),
            (fleet.waiting, "not compared yet"),
        )
        if number
    ]
    return "; ".join(
        [
            f"{counted(len(gears), 'gear')}, {counted(len(fleet.rows), 'scan')}",
            *([", ".join(not_compared)] if not_compared else []),
        ]
    )


def verdict_words(gears: Sequence[GearTrend]) -> str:
    """How many gears keep their limits."""
    judged = [gear for gear in gears if gear.trends]
    empty = [gear.gear_id for gear in gears if not gear.trends]
    more = [f"{len(empty) - NAMED} more"] * (len(empty) > NAMED)
    without = [f"no scan of {listed([*empty[:NAMED], *more])} gave a result"] if empty else []
    count = {state: sum(gear.conformity is state for gear in judged) for state in (*Conformity, None)}
    if judged and count[None] == len(judged):
        wearing = sum(any(trend.significant for trend in gear.trends.values()) for gear in judged)
        statements = [f"{wearing} of {counted(len(gears), 'gear')} wear significantly", "the designs set no limits", *without]
        return sentence("; ".join(statements))
    words = [
        (count[Conformity.NOT_CONFORMING], "{} beyond a limit"),
        (count[Conformity.NEITHER], "{} undecided"),
        (count[Conformity.CONFORMING], "{} within all limits"),
        (count[None], "{} without limits"),
    ]
    kept = ", ".join(phrase.format(number) for number, phrase in words if number)
    return sentence(f"{counted(len(gears), 'gear')}: {'; '.join(filter(None, [kept, *without]))}")


def trend_lines(fleet: StoredFleet, gears: Sequence[GearTrend]) -> list[tuple[str, str]]:
    """The trend for the terminal, each line with its style."""
    lines = [(fleet_words(fleet, gears), "dim"), ("", ""), *wrapped(verdict_words(gears), "bold"), ("", "")]
    wide = min(max(len(gear.gear_id) for gear in gears[:MOST]), 20)
    for rank, gear in enumerate(gears[:MOST], 1):
        style = {Conformity.NOT_CONFORMING: "bold red", Conformity.NEITHER: "yellow"}.get(
            gear.conformity or Conformity.CONFORMING, ""
        )
        head = f"{rank:>3}  {gear.gear_id:<{wide}}  {state_words(gear)}: "
        lines += wrapped(head + gear_words(gear), style, indent=7 + wide)
        lines += [line for note in gear.notes for line in wrapped(f"! {note}", "yellow", 7 + wide, 7 + wide)]
    if len(gears) > MOST:
        lines.append((f"     and {len(gears) - MOST} more, in trend.html and trend.csv", ""))
    return [*lines, ("", "")]


def wrapped(text: str, style: str, indent: int = 0, first: int = 0) -> list[tuple[str, str]]:
    """Lines no wider than `WIDTH`; a value stays with its unit."""
    return [
        (line, style) for line in textwrap.wrap(unbroken(text), WIDTH, initial_indent=" " * first, subsequent_indent=" " * indent)
    ]


def state_words(gear: GearTrend) -> str:
    """Whether a gear keeps its limits."""
    if not gear.trends:
        return "no result"
    if gear.conformity is Conformity.NEITHER:
        return UNDECIDED
    return "no limits" if gear.conformity is None else str(gear.conformity)


def gear_words(gear: GearTrend) -> str:
    """What is most urgent on a gear: the quantity nearest to its limit, or how fast it wears."""
    trend = gear.nearest
    if trend is None and gear.missing:
        return f"{listed([title_of(name) for name in gear.missing])} not known"
    if trend is None:
        trend = gear.trends.get("wear_volume_mm3") or next(iter(gear.trends.values()), None)
        return "no scan gave one" if trend is None else f"{title_of(trend.quantity)} {value_words(trend)}, {rate_words(trend)}"
    clauses = [f"{title_of(trend.quantity)} {value_words(trend)} of {significant(trend.limit)}"]
    if trend.left is not None and trend.conformity is not Conformity.NOT_CONFORMING:
        reach = left_words(trend)
        head = "" if reach.startswith("whether") else "limit " if reach.startswith(("not", "reached")) else "limit in "
        clauses.append(head + reach)
    return ", ".join(clauses)


def value_words(trend: Trend) -> str:
    """The value of the last inspection with its ±; its range beside it where that is wider, and in its place where the ± says nothing beside it;
    where nothing was found, what might be there."""
    last = trend.last
    where = "on what was seen " if last.doubts.unseen else ""
    if last.value == 0.0 and not last.std > 0.0 and math.isfinite(last.high):
        none = f"{where}none" if where else "none seen"
        return f"{none}, below {shown(trend.quantity, last.high, math.nan)}"
    words = where + shown(trend.quantity, last.value, last.std)
    if not any(last.open):
        return words
    down, up = (far or NORMAL_95 * last.noise for far in last.open)
    ends = f"{significant(last.value - down)} to {significant(last.value + up)}"
    if max(down, up) > LOPSIDED * last.noise > 0.0:
        return f"{where}{SPACE.join(filter(None, (ends, unit_of(trend.quantity))))} (likeliest {significant(last.value)})"
    return f"{words} (may be {ends})"


def gauge_lines(studies: Sequence[GaugeStudy]) -> list[tuple[str, str]]:
    """The gauge study for the terminal."""
    if not studies:
        return [*wrapped(NOTHING_REPEATED, "bold"), ("", "")]
    lines = [(study_words(studies), "dim"), ("", ""), *wrapped(accord_words(studies), "bold"), ("", "")]
    lines.append((f"  {'':<{NAME}}{'repeating':>12}{'operators':>10}{'GRR':>6}{'ndc':>5}  repeats / stated", "dim"))
    for study in studies:
        lines.append((f"  {gauge_line(study)}", "yellow" if study.accord in (Accord.MORE, Accord.OPERATORS) else ""))
    lines += [line for why in empty_words(studies) for line in (("", ""), *wrapped(f"! {why}", "yellow"))]
    return [*lines, ("", "")]


def empty_words(studies: Sequence[GaugeStudy]) -> list[str]:
    """Why columns are empty, a sentence each: of all quantities, or of those of which too many scans are left out."""
    empty = [study for study in studies if study.variance is None]
    if len(empty) == len(studies):
        return [ONE_GEAR] if studies else []
    by_why: dict[tuple[int, int], list[str]] = {}
    for study in empty:
        why = study.left_out - study.without_wear, study.without_wear
        by_why.setdefault(why, []).append(title_of(study.quantity, study.flank))
    said = []
    for (unmatched, without), names in by_why.items():
        left_out = [f"{without} that found no wear"] * (without > 0) + [f"{unmatched} without a match"] * (unmatched > 0)
        scans = f"; of the scans {listed(left_out)} {'is' if unmatched + without == 1 else 'are'} left out" if left_out else ""
        said.append(f"Of {listed(names)} there is one gear alone{scans}.")
    return [*said[:-1], f"{said[-1]} {ONE_GEAR}"] if said else []


def study_words(studies: Sequence[GaugeStudy]) -> str:
    """How large the study is, by its largest quantity."""
    study = max(studies, key=lambda study: len(study.parts) * len(study.operators) * study.repeats)
    left_out = f"; {counted(study.left_out, 'scan')} without a match left out" if study.left_out else ""
    return f"{counted(len(study.parts), 'gear')}, {counted(len(study.operators), 'operator')}, {counted(study.repeats, 'repeat')}{left_out}"


def accord_words(studies: Sequence[GaugeStudy]) -> str:
    """What repeats say of the stated ±, all quantities together."""
    judged = [study for study in studies if study.accord is not Accord.UNKNOWN]
    more, operators = (
        [title_of(study.quantity, study.flank) for study in judged if study.accord is accord]
        for accord in (Accord.MORE, Accord.OPERATORS)
    )
    if not judged:
        return "No quantity with a stated ± was repeated."
    of_all = f"of {counted(len(judged), 'quantity', 'quantities')}"
    said = [f"Repeats contradict the stated ± of {_named(more)} {of_all}{_which(more)}."]
    if operators:
        said.append(
            f"Scans by different operators contradict it, beyond their repeats, of {_named(operators)}{_which(operators)}."
        )
    ranges = [title_of(study.quantity, study.flank) for study in judged if study.accord is Accord.RANGES]
    if ranges:
        said.append(
            f"Of {len(ranges)} more they scatter more than the ±, within the ranges that the reports state{_which(ranges)}."
        )
    return " ".join(said)


def _named(names: Sequence[str]) -> str:
    return str(len(names) or "none")


def _which(names: Sequence[str]) -> str:
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f": {'; '.join(names[:3])}{more}" if names else ""


def gauge_line(study: GaugeStudy) -> str:
    """A quantity in one line."""
    variance = study.variance
    repeatability = operators = share = "–"
    categories = ""
    if variance is not None:
        repeatability = shown(study.quantity, variance.repeatability.std, math.nan)
        operators = "–" if variance.reproducibility is None else significant(variance.reproducibility.std, 2)
        share = "–" if math.isnan(variance.share) else f"{100.0 * variance.share:.0f} %"
        categories = "" if variance.categories is None else str(variance.categories)
    name = title_of(study.quantity, study.flank)
    line = f"{name:<{NAME}}{repeatability:>12}{operators:>10}{share:>6}{categories:>5}  {ratio_words(study.repeatability)}"
    return unbroken(line)


def ratio_words(scatter: Scatter | None) -> str:
    """Scatter over what is stated, with its interval."""
    if scatter is None:
        return "–"
    ratio, low, high = (
        f"{value:.2f}" if value < 9.995 else f"{value:.0f}" for value in (scatter.ratio, scatter.low, scatter.high)
    )
    return f"{ratio} ({low} to {high})"

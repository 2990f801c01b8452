"""The wear law and its forecast in words: for the page and the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gearwear.design.quantity import MISSING, SPACE, counted, listed, number, sentence, significant
from gearwear.wear.regions import WearRegion
from gearwear.wear_law.across import across_words
from gearwear.wear_law.forecast import FAR_CYCLES_RATIO, Band
from gearwear.wear_law.study import CyclesToLimit, WearStudy

HOLDS = "for the same load, speed, lubricant and alignment"
BAND = (
    "95 % of the fit's own uncertainty, as if all of it pulled one way, and every load sharing that wear can lead to: from none to all of"
    " the load where two pairs touch"
)
RUN_BAND = (
    "95 % of what runs of elastic teeth come to that fit the measured profile: compliance 0.85 to 1.15 of the finite elements', mates hard to half as"
    " soft again, tip corners that dig or do not touch, and a tenth of what is still to come"
)
QUANTITIES = {
    "depth": "greatest depth of the mean flank",
    "thickness": "loss of tooth thickness",
    "backlash": "growth of normal backlash",
}
"""Quantities that may have a limit."""
FORECAST_HEAD = ("cycles since new", "greatest depth, µm", "loss of thickness, mm", "growth of normal backlash, mm")
FORECAST_CAPTION = (
    f"Forecast for the mean flank, {HOLDS}; the first row is now. The value goes on at the rate so far; the band holds what it may become as"
    " wear changes how pairs share the load, from none to all of it where two pairs touch."
    " The growth of backlash is the most it can be: corners and the highest places of the flanks, which carry first, are not in it."
)

RUN_CAPTION = (
    f"Forecast for the mean flank, {HOLDS}; the first row is now. The pair is run on as the pattern of its wear says that it ran, with elastic teeth"
    " that share ever less of the load where they have worn, and cycles left to a limit are those of this run."
    " The growth of backlash is the most it can be: corners and the highest places of the flanks, which carry first, are not in it."
)


def forecast_caption(study: WearStudy) -> str:
    """What the forecast's value and band are."""
    return RUN_CAPTION if study.forecast is not None and study.forecast.by_running else FORECAST_CAPTION


def law_words(study: WearStudy) -> str:
    """What the mean worn profile is consistent with, or why that cannot be told."""
    uneven = "" if study.across is None else across_words(study.across)
    if study.best is None:
        return " ".join(map(sentence, filter(None, [f"no wear law was fitted: {study.why_not}", uneven])))
    said = [f"wear law, fitted to the mean of {counted(len(study.teeth), f'{study.side} flank')}: {study.best.words}"]
    if study.left_out:
        which, single = listed(str(tooth + 1) for tooth in study.left_out), len(study.left_out) == 1
        said.append(
            f"{'Tooth' if single else 'Teeth'} {which} lost much more or less than the others and {'is' if single else 'are'} not in it"
        )
    if study.note:
        said.append(study.note)
    if study.volume_share < 0.995:
        share = f"{number(100 * study.volume_share, 0)}{SPACE}%"
        said.append(f"The flanks in it lost {share} of the worn volume; of the rest the law says nothing")
    if uneven:
        said.append(f"{uneven}. The law and its forecast are those of the mean over the face")
    if study.sharing_alike:
        said.append(f"With load sharing {listed(study.sharing_alike, 'or')} it fits as well")
    return " ".join(map(sentence, [*said, *([study.why_not] if study.why_not else [])]))


def left_words(study: WearStudy, regions: Sequence[WearRegion] = ()) -> list[str]:
    """One sentence per limit: how many cycles are left, and which of the worn regions are past it."""
    said = []
    for ahead in study.left:
        name, limit, left = QUANTITIES[ahead.quantity], _limit(ahead), ahead.left
        if ahead.never:
            text = f"the {name} never reaches its limit of {limit} by this law"
            if math.isfinite(left.low):
                text += f"; at the upper side of its band it does in {count(left.low)} more cycles"
        elif left.value == 0.0:
            text = f"the limit of {limit} on the {name} is reached already"
        else:
            text = f"the {name} reaches its limit of {limit} in {count(left.value)} more cycles ({_span(ahead)})"
            run = _run(study)
            if ahead.far(run):
                text += f", at {significant(1.0 + left.value / run, 2)} times the cycles run"
        past = _past(ahead, study, regions)
        said.append(sentence(f"{text}; {past} by itself" if past else text))
    return said


def forecast_words(study: WearStudy | None, regions: Sequence[WearRegion] = ()) -> str:
    """The forecast, short, for the terminal; "" where there is none."""
    if study is None or study.forecast is None:
        return ""
    cycles, depth = study.forecast.cycles, study.forecast.greatest_depth
    depths = [
        f"{number(1e3 * depth.value[i], 0)}{SPACE}µm ({number(1e3 * depth.low[i], 0)} to {number(1e3 * depth.high[i], 0)})"
        f" at {count(cycles[i])} cycles"
        for i in range(1, len(cycles))
    ]
    left = []
    for ahead in study.left:
        limit = f"{ahead.quantity} {_limit(ahead)}"
        if ahead.never:
            left.append(f"no end to {limit}")
        elif ahead.left.value == 0.0:
            left.append(f"none to {limit}")
        else:
            past = _past(ahead, study, regions)
            left.append(f"{count(ahead.left.value)} ({_span(ahead)}) to {limit}{', ' if past else ''}{past}")
    how = ", run on" if study.forecast.by_running else ""
    said = [f"forecast{how}, mean flank at its deepest: {'; '.join(depths)}"] if depths else []
    lean = study.across.lean if study.across is not None and study.across.leans else 0.0
    over = (
        f" (mean over the face; {1e3 * abs(lean):.0f}{SPACE}µm deeper at the {'upper' if lean > 0.0 else 'lower'} end)"
        if lean
        else ""
    )
    said = [f"cycles left, mean flank{over}: {'; '.join(left)}", *said] if left else said
    return " ".join(map(sentence, said))


def far_words(study: WearStudy) -> str:
    """That some of the forecast is a guess; "" where none is."""
    if study.forecast is None:
        return ""
    if not study.forecast.far.any() and not any(ahead.far(_run(study)) and not ahead.never for ahead in study.left):
        return ""
    return (
        f"Beyond {number(FAR_CYCLES_RATIO, 0)} times the cycles run a forecast is a guess: by then the flanks have lost as much again, and pressure and"
        " sliding are no longer those that the rate was found with."
    )


def forecast_rows(study: WearStudy) -> list[tuple[str, ...]]:
    """A row under `FORECAST_HEAD` for each number of cycles."""
    forecast = study.forecast
    if forecast is None:
        return []
    columns = ((forecast.greatest_depth, 1e3, 1), (forecast.thickness_loss, 1.0, 4), (forecast.backlash_increase, 1.0, 4))
    return [
        (count(cycles), *(_band(band, i, factor, digits) for band, factor, digits in columns))
        for i, cycles in enumerate(forecast.cycles)
    ]


def _band(band: Band, i: int, factor: float, digits: int) -> str:
    if not math.isfinite(band.value[i]):
        return MISSING
    value, low, high = (number(factor * float(part[i]), digits) for part in (band.value, band.low, band.high))
    return f"{value} ({low} … {high})"


def _run(study: WearStudy) -> float:
    assert study.forecast is not None  # limits come with a forecast
    return study.forecast.cycles_run


def _past(ahead: CyclesToLimit, study: WearStudy, regions: Sequence[WearRegion]) -> str:
    """Which teeth are past a limit on depth that the mean flank has still to reach; "" for none."""
    if ahead.quantity != "depth" or ahead.left.value == 0.0:
        return ""
    teeth = [
        str(r.tooth + 1) for r in sorted(regions, key=lambda r: r.tooth) if r.side == study.side and r.max_depth > ahead.limit
    ]
    return (
        f"{'tooth' if len(teeth) == 1 else 'teeth'} {listed(teeth)} {'is' if len(teeth) == 1 else 'are'} past it" if teeth else ""
    )


def _limit(ahead: CyclesToLimit) -> str:
    return f"{significant(1e3 * ahead.limit)}{SPACE}µm" if ahead.quantity == "depth" else f"{significant(ahead.limit)}{SPACE}mm"


def _span(ahead: CyclesToLimit) -> str:
    """The band of the cycles left."""
    return f"{count(ahead.left.low)} to {'no end' if math.isinf(ahead.left.high) else count(ahead.left.high)}"


def count(cycles: float) -> str:
    """A number of cycles, to three digits.

    >>> count(2.0e6), count(125300.0), count(80.0)
    ('2.00 million', '125 thousand', '80')
    """
    for size, name in ((1e9, " billion"), (1e6, " million"), (1e3, " thousand")):
        if cycles >= size:
            return significant(float(cycles) / size) + name
    return f"{cycles:.0f}"

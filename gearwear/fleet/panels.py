"""Small charts as SVG: one for each gear and quantity, all of a kind on the same scales, so that they can be compared at a glance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import partial

from markupsafe import Markup

from gearwear.design.conformity import COVERAGE, Conformity
from gearwear.fleet.gauge import Repeat, Scatter
from gearwear.fleet.trend import CYCLES, DAYS, GearTrend, Point, Trend

WIDTH, HEIGHT = 132.0, 58.0
"""Of a small chart, in its own units; the page says how large one is."""
LEFT, RIGHT, TOP, BOTTOM = 4.0, 128.0, 4.0, 54.0
SCALE_LEFT, SCALE_BOTTOM = 21.0, 47.0
"""Of charts whose scales are numbered."""
NAME_STEP, LEVEL_STEP, NAME_LETTERS = 11.0, 95.0, 14
"""Room that a gear's name takes along the overview, turned and level, and its letters there; where gears are closer, not every one is named."""
AHEAD = 0.3
"""Share of the time scanned that is kept free for what the line says of the time ahead."""
BAND_STEPS = 8
"""Pieces that the edge of a line's band is drawn in."""
ROOM = 1.15
"""Height of a chart over its limit."""
TALLEST = 1.6
"""Largest height of a chart over its limit; what lies beyond stands at the edge."""
DAY_0, DAY = datetime(1970, 1, 1), timedelta(1)
"""From which days are counted along x, and one of them; in no zone, so that the clock of this machine does not move them."""


@dataclass(frozen=True, slots=True)
class Scales:
    """What the charts of a fleet share.

    Parameters
    ----------
    clock : {"cycle", "day"}
    start, end : float
        Along x: cycles since new, or days since 1970.
    last : float
        The last inspection, in the same.
    tops : dict of str to float
        Along y, from 0, by quantity.
    """

    clock: str
    start: float
    end: float
    last: float
    tops: dict[str, float]

    def x(self, place: float) -> float:
        share = (place - self.start) / (self.end - self.start)
        return SCALE_LEFT + (RIGHT - SCALE_LEFT) * min(max(share, 0.0), 1.0)

    def y(self, quantity: str, value: float) -> float:
        share = value / self.tops[quantity]
        return SCALE_BOTTOM - (SCALE_BOTTOM - TOP) * min(max(share, -0.03), 1.0)


def scales_of(gears: Sequence[GearTrend]) -> dict[str, Scales]:
    """Scales for a fleet, by clock: the height is the limit's, where there is one."""
    every = [trend for gear in gears for trend in gear.trends.values()]
    tops: dict[str, float] = {}
    for trend in every:
        tallest = max((_top(point) for point in trend.points), default=0.0)
        tops[trend.quantity] = max(tops.get(trend.quantity, 0.0), tallest, 1e-12)
    for trend in every:
        if trend.limit is not None:
            tops[trend.quantity] = min(max(tops[trend.quantity], ROOM * trend.limit), TALLEST * trend.limit)
    return {clock: _scales(clock, [trend for trend in every if clock_of(trend) == clock], tops) for clock in (CYCLES, DAYS)}


def _scales(clock: str, trends: Iterable[Trend], tops: dict[str, float]) -> Scales:
    places = [place for trend in trends for point in trend.points if (place := place_of(point, clock)) is not None]
    start = 0.0 if clock == CYCLES else min(places, default=0.0)
    last = max(places, default=1.0)
    return Scales(clock, start, last + AHEAD * max(last - start, 1e-9), last, tops)


def clock_of(trend: Trend) -> str:
    """What a trend is drawn over: what its line is over; without one cycles where all of its inspections have them, else dates."""
    return trend.clock or (CYCLES if all(point.cycles is not None for point in trend.points) else DAYS)


def place_of(point: Point, clock: str) -> float | None:
    """Where an inspection stands along x."""
    if clock == CYCLES:
        return point.cycles
    return None if point.inspected is None else (point.inspected - DAY_0) / DAY


def _top(point: Point) -> float:
    return max(filter(math.isfinite, (point.value, point.ends[1])))


def trend_panel(trend: Trend, by_clock: Mapping[str, Scales]) -> Markup:
    """A quantity of one gear over its inspections, with its limit and its line."""
    name, scales = trend.quantity, by_clock[clock_of(trend)]
    marks = [f'<path class="axis" d="M{SCALE_LEFT} {TOP}V{SCALE_BOTTOM}H{RIGHT}"/>', *_ticks(name, scales)]
    if trend.limit is not None:
        marks.append(f'<path class="limit" d="M{SCALE_LEFT} {scales.y(name, trend.limit):.1f}H{RIGHT}"/>')
    marks += [*_band(trend, scales), *_line(trend, scales)]
    for point in trend.points:
        place = place_of(point, scales.clock)
        if place is not None:
            marks.append(_mark(scales.x(place), name, point, scales))
    return _svg("".join(marks), f"{name} of {trend.gear_id}")


def ticks(top: float) -> list[float]:
    """Round numbers from 0 up to `top`: two to four beside 0, in steps of 1, 2 or 5 × 10ⁿ.

    >>> ticks(0.16), ticks(1.0), ticks(47.0)
    ([0.0, 0.05, 0.1, 0.15], [0.0, 0.5, 1.0], [0.0, 20.0, 40.0])
    """
    power = 10.0 ** math.floor(math.log10(0.5 * top))
    step = max(m * power for m in (1, 2, 5) if m * power <= 0.5 * top * (1.0 + 1e-9))
    return [round(k * step, 12 - math.floor(math.log10(step))) for k in range(int(top / step * (1.0 + 1e-9)) + 1)]


def _ticks(name: str, scales: Scales) -> list[str]:
    """Numbers of both scales: round ones of the quantity and of millions of cycles, or the first and the last date."""
    marks = []
    for value in ticks(scales.tops[name]):
        y = scales.y(name, value)
        marks.append(
            f'<path class="axis" d="M{SCALE_LEFT - 2.0} {y:.1f}h2"/><text class="up" x="{SCALE_LEFT - 3.0}" y="{y + 2.2:.1f}">{value:g}</text>'
        )
    if scales.clock == CYCLES:
        along = [(value, f"{1e-6 * value:g}", "middle") for value in ticks(scales.end)]
    else:
        ends = dict.fromkeys((scales.start, scales.last))
        along = [(day, day_words(day), "start" if day == scales.start else "middle") for day in ends]
    for place, words, anchor in along:
        x = scales.x(place)
        marks.append(
            f'<path class="axis" d="M{x:.1f} {SCALE_BOTTOM}v2"/><text class="along" text-anchor="{anchor}" x="{x:.1f}" y="{HEIGHT - 2.0}">{words}</text>'
        )
    return marks


def day_words(days: float) -> str:
    """The date so many days after 1970."""
    return (DAY_0 + days * DAY).date().isoformat()


def _band(trend: Trend, scales: Scales) -> list[str]:
    """The 95 % interval of the line, with what ranges leave open."""
    line = trend.line
    if line is None:
        return []
    first, begin = _begin(trend, scales)
    low = begin if trend.from_new else first
    places = [low + (scales.end - low) * step / BAND_STEPS for step in range(BAND_STEPS + 1)]
    ends = [line.band(place - begin) for place in places]
    lower, upper = (
        [(scales.x(x), scales.y(trend.quantity, end[side])) for x, end in zip(places, ends, strict=True)] for side in (0, 1)
    )
    return [f'<path class="band" d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in [*lower, *reversed(upper)])}z"/>']


def _begin(trend: Trend, scales: Scales) -> tuple[float, float]:
    """The place of the first inspection, and from where the places of the line are counted."""
    first = place_of(trend.points[0], scales.clock) or 0.0
    return first, 0.0 if trend.clock == CYCLES else first


def _line(trend: Trend, scales: Scales) -> list[str]:
    line = trend.line
    if line is None:
        return []
    first, begin = _begin(trend, scales)
    last, end = place_of(trend.last, scales.clock) or 0.0, scales.end
    pieces = []
    for kind, low, high in (("fit", 0.0 if trend.from_new else first, last), ("ahead", last, end)):
        ends = [(place, max(line.at(place - begin)[0], 0.0)) for place in (low, high)]
        top = scales.tops[trend.quantity]
        if ends[1][1] > top > ends[0][1]:  # cut where it leaves the chart
            cut = low + (high - low) * (top - ends[0][1]) / (ends[1][1] - ends[0][1])
            ends[1] = (cut, top)
        elif ends[0][1] >= top:
            continue
        (x0, y0), (x1, y1) = ends
        pieces.append(
            f'<path class="{kind}" d="M{scales.x(x0):.1f} {scales.y(trend.quantity, y0):.1f}'
            f'L{scales.x(x1):.1f} {scales.y(trend.quantity, y1):.1f}"/>'
        )
    return pieces


def _mark(x: float, name: str, point: Point, scales: Scales) -> str:
    """A dot with 2 u on either side, and a thin whisker as far as decisions take its range; where nothing was found, a hollow one with what
    might be there; an arrow where it is beyond the chart."""
    y = scales.y(name, point.value)
    if point.value > scales.tops[name]:
        return f'<path class="dot" d="M{x - 2.4:.1f} {TOP + 3.4:.1f}h4.8l-2.4 -4.2z"/>'
    kind = "dot" if point.std > 0.0 else "none"
    bars = _bars(x, point, lambda value: scales.y(name, value), 1.6, scales.tops[name])
    return f'{bars}<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="1.9"/>'


def _bars(x: float, point: Point, y: Callable[[float], float], cap: float, top: float) -> str:
    """2 u on either side of a point, and a whisker where a range goes beyond: with a cap at its end, if that lies within the chart."""
    half = COVERAGE * point.noise if point.noise > 0.0 else 0.0
    bars = f'<path class="u" d="M{x:.1f} {y(point.value - half):.1f}V{y(point.value + half):.1f}"/>' if half else ""
    for far, end, side in zip(point.open, point.ends, (-1.0, 1.0), strict=True):
        if far > 0.0:
            caps = f"M{x - cap:.1f} {y(end):.1f}h{2.0 * cap:.1f}" if end <= top else ""
            bars += f'<path class="open" d="M{x:.1f} {y(point.value + side * half):.1f}V{y(end):.1f}{caps}"/>'
    return bars


def overview(gears: Sequence[GearTrend]) -> Markup:
    """Share of its nearest limit that each gear has used, the most urgent first; empty without limits."""
    limited = []
    for rank, gear in enumerate(gears, 1):
        trend = gear.nearest
        if trend is not None and trend.limit is not None:
            limited.append((rank, gear, trend.last, trend.limit))
    if not limited:
        return Markup("")
    width, bottom = 1000.0, 158.0
    top = min(max(1.3, *(_top(point) / limit for _, _, point, limit in limited)), 2.5)
    step = (width - 50.0) / len(limited)
    every = math.ceil(NAME_STEP / step)
    level = step > LEVEL_STEP
    height = bottom + (20.0 if level else 74.0)

    def y(share: float) -> float:
        return bottom - (bottom - 10.0) * min(max(share, 0.0), top) / top

    marks = []
    for share, kind in ((0.0, "axis"), (0.5, "grid"), (1.0, "limit")):
        marks.append(
            f'<path class="{kind}" d="M46 {y(share):.1f}H{width}"/><text x="40" y="{y(share) + 4:.1f}">{100 * share:.0f} %</text>'
        )
    for i, (rank, gear, point, limit) in enumerate(limited):
        x = 50.0 + (i + 0.5) * step
        radius = min(max(0.4 * step, 1.8), 4.0)
        bars = _bars(x, point, partial(_share, y, limit), radius, top * limit)
        marks.append(
            f'<a href="#g{rank}"><title>{_escaped(gear.gear_id)}</title>{bars}'
            f'<circle class="{css(gear.conformity)}" cx="{x:.1f}" cy="{y(point.value / limit):.1f}" r="{radius:.1f}"/>'
            f"{_name(gear.gear_id, x, bottom, level) if i % every == 0 else ''}</a>"
        )
    return Markup(
        f'<svg class="overview" viewBox="0 0 {width:g} {height:g}" role="img" aria-label="Share of the limit used, gear by gear">{"".join(marks)}</svg>'
    )


def _share(y: Callable[[float], float], limit: float, value: float) -> float:
    """Where a value stands as a share of its limit."""
    return y(value / limit)


def _name(gear_id: str, x: float, bottom: float, level: bool) -> str:
    """A gear's name under its place; where it is not to lie `level`, turned so that neighbours have room."""
    short = gear_id if len(gear_id) <= NAME_LETTERS else gear_id[: NAME_LETTERS - 1] + "…"
    turned = f'class="name level" transform="translate({x:.1f} {bottom + 15.0})"'
    if not level:
        turned = f'class="name" transform="translate({x + 3.0:.1f} {bottom + 9.0}) rotate(-50)"'
    return f"<text {turned}>{_escaped(short)}</text>"


def css(state: Conformity | None) -> str:
    """Class of a state in the style of the page."""
    return "none" if state is None else str(state).replace(" ", "-")


def repeat_panel(scans: Sequence[Repeat], operators: Sequence[str], half: float) -> Markup:
    """The scans of one gear about their mean, operator by operator, each with the stated 2 u; `half` is what the chart's half height stands for."""
    middle, mean = 0.5 * (TOP + BOTTOM), sum(scan.value for scan in scans) / len(scans)

    def y(value: float) -> float:
        return middle - (BOTTOM - TOP) * 0.5 * min(max(value / half, -1.0), 1.0)

    marks = [f'<path class="axis" d="M{LEFT} {middle}H{RIGHT}"/>']
    room = (RIGHT - LEFT) / len(operators)
    for i, who in enumerate(operators):
        by_operator = [scan for scan in scans if scan.operator == who]
        if i:
            marks.append(f'<path class="grid" d="M{LEFT + i * room:.1f} {TOP}V{BOTTOM}"/>')
        for k, scan in enumerate(by_operator):
            x, off = LEFT + (i + (k + 1.0) / (len(by_operator) + 1.0)) * room, scan.value - mean
            if scan.std > 0.0:
                marks.append(
                    f'<path class="u" d="M{x:.1f} {y(off - COVERAGE * scan.std):.1f}V{y(off + COVERAGE * scan.std):.1f}"/>'
                )
            marks.append(f'<circle class="dot" cx="{x:.1f}" cy="{y(off):.1f}" r="1.9"/>')
    return _svg("".join(marks), "scans about their mean, operator by operator")


def ratio_panel(scatter: Scatter) -> Markup:
    """Scatter over what is stated, from a tenth to ten times on a logarithmic scale, with its interval."""

    def x(ratio: float) -> float:
        return 66.0 + 62.0 * min(max(math.log10(max(ratio, 1e-9)), -1.0), 1.0)

    return Markup(
        f'<svg class="ratio" viewBox="0 0 132 14" role="img" aria-label="scatter over the stated ±"><path class="axis" d="M4 13H128"/>'
        f'<path class="limit" d="M66 1V13"/><path class="u" d="M{x(scatter.low):.1f} 6.5H{x(scatter.high):.1f}"/>'
        f'<circle class="dot" cx="{x(scatter.ratio):.1f}" cy="6.5" r="2.2"/></svg>'
    )


def _svg(marks: str, words: str) -> Markup:
    return Markup(f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{_escaped(words)}">{marks}</svg>')


def _escaped(text: str) -> str:
    return str(Markup.escape(text))


def largest(values: Iterable[float]) -> float:
    """Of some numbers, and never 0: half the height of a chart."""
    return max((abs(value) for value in values if math.isfinite(value)), default=0.0) or 1.0

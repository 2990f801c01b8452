"""The same gear over its inspections: what changed, how fast, and when a limit is reached."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from itertools import compress, pairwise

import numpy as np

from gearwear.design.conformity import COVERAGE, GOOD_TO_BAD, Conformity, conformity, worst
from gearwear.design.quantity import NORMAL_95, significant
from gearwear.fleet.doubts import DOUBTED, NO_DOUBTS, Doubts, together
from gearwear.fleet.line import FittedLine, Reach, beyond, chance_of, fit_line, interval, line_from_new, own_range, reaches
from gearwear.fleet.order import Occasion, Order, order_of
from gearwear.fleet.significance import discoveries

QUANTITIES = (
    "wear_volume_mm3", "wear_area_mm2", "wear_depth_mm", "thickness_loss_mm", "backlash_mm", "lost_volume_mm3", "transmission_error_um",
    "law_sliding_depth_um",
)  # fmt: skip
"""What is followed, in the order of the tables."""
NOTHING_AT_FIRST = {
    "wear_volume_mm3",
    "wear_area_mm2",
    "wear_depth_mm",
    "thickness_loss_mm",
    "lost_volume_mm3",
    "law_sliding_depth_um",
}
"""What a new gear has none of: one inspection with its cycles then gives a rate since new."""
CYCLES, DAYS = "cycle", "day"
WORN_OFF = ("wear_volume_mm3", "wear_area_mm2")
"""What does not fall on the same gear: then there is no rate of any of its numbers."""
ONLY_GROW = (*WORN_OFF, "wear_depth_mm", "thickness_loss_mm", "backlash_mm", "lost_volume_mm3")
"""What wear makes larger and nothing makes smaller; a fall is told."""
FALLEN = 3.0
"""Standard deviations by which a number that can only grow must fall for the gear to be doubted."""
OTHER_GEAR = (
    "its wear fell from one inspection to the next, so no rate is given: is it the same gear? One that was put in its place needs a gear_id of"
    " its own"
)
NO_RESULT = "the last inspection gave no result: whether the limits are kept is undecided"
"""What is said where older inspections conform."""
SECONDS = 86400.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """One number of one scan.

    Parameters
    ----------
    gear_id, quantity : str
    value, std : float
        nan where no standard deviation is stated.
    inspected : datetime or None
    cycles : float or None
        Run since new.
    which : int
        As in `Occasion`.
    low, high : float
        Within what limits the number lies where more than scatter is open; else nan.
    doubts : Doubts
        Of its scan.
    """

    gear_id: str
    quantity: str
    value: float
    std: float
    inspected: datetime | None = None
    cycles: float | None = None
    which: int = 0
    low: float = math.nan
    high: float = math.nan
    doubts: Doubts = NO_DOUBTS

    @property
    def inspection(self) -> Occasion:
        return Occasion(self.inspected, self.cycles, self.which)


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """A number at one inspection.

    Parameters
    ----------
    inspected, cycles, which
        As in `Reading`.
    value, std : float
        Mean of its scans. The standard deviation is theirs, not divided by their number: what repeats alike does not average out; it is the
        scatter of the mean where that is larger.
    low, high : float
        The range of its scans, their own 95 % in it; nan where none has one.
    scans : int
    doubts : Doubts
        Of any of its scans.
    """

    inspected: datetime | None
    cycles: float | None
    value: float
    std: float
    low: float
    high: float
    scans: int
    which: int = 0
    doubts: Doubts = NO_DOUBTS

    @property
    def inspection(self) -> Occasion:
        return Occasion(self.inspected, self.cycles, self.which)

    @property
    def noise(self) -> float:
        """Standard deviation of the scatter: 0 where nothing was found, and a range says what might be there; nan where nothing is stated."""
        return 0.0 if not self.std > 0.0 and math.isfinite(self.high) else self.std

    @property
    def open(self) -> tuple[float, float]:
        """How far below and above the range reaches where that is beyond the scatter's own 95 %; else 0."""
        return beyond(self.value, self.noise, self.low, self.high)

    @property
    def ends(self) -> tuple[float, float]:
        """What a decision goes by: the range with U, two standard deviations, at either end; nan where nothing is stated."""
        return interval(self.value, *self.open, COVERAGE * self.noise)

    def judged(self, limit: float) -> Conformity:
        """How it keeps a limit: a doubtful result proves nothing, and what was not seen does not prove that a limit is kept."""
        state = conformity(*self.ends, limit)
        if self.doubts.grave or (self.doubts.unseen and state is Conformity.CONFORMING):
            return Conformity.NEITHER
        return state


@dataclass(frozen=True, slots=True, kw_only=True)
class Advance:
    """From one inspection to the next.

    Parameters
    ----------
    before, after : Point
    value, std : float
        The change, and the standard deviation of its scatter.
    low, high : float
        Its 95 % interval, with what the ranges leave open: each number anywhere in its own.
    p_value : float
        Chance of such a change where there is none: of the least that the ranges leave.
    significant : bool
        Among all of the fleet's: of those called so, one in twenty is chance.
    """

    before: Point
    after: Point
    value: float
    std: float
    low: float
    high: float
    p_value: float
    significant: bool = False

    @property
    def falls(self) -> bool:
        """Whether it is less than nothing by more than three standard deviations, whatever the ranges leave open."""
        return not self.doubtful and self.high < (NORMAL_95 - FALLEN) * self.std

    @property
    def seems_to_fall(self) -> bool:
        """Whether it is that by the ± alone, or by the ranges."""
        return not self.doubtful and (self.falls or self.value < -FALLEN * self.std < 0.0)

    @property
    def doubtful(self) -> bool:
        """Whether one of its ends proves nothing."""
        return bool(self.before.doubts.grave or self.after.doubts.grave)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """A quantity of one gear over its inspections.

    Parameters
    ----------
    gear_id, quantity : str
    points : tuple of Point
        In their order; where it is not known which is the last, the worst of those that may be it comes last.
    clock : {"cycle", "day", ""}
        What the rate is per; "" where there is none.
    steps : tuple of Advance
        From each point to the next; none where their order is not known.
    line : FittedLine or None
        Over cycles since new, or days since the first inspection.
    from_new : bool
        Whether the line goes through one inspection and nothing at first.
    significant : bool
        Whether the rate is, among all of the fleet's.
    limit : float or None
    conformity : Conformity or None
        Of the last inspection with the limit, the worst of those that may be the last; None without one.
    left : Reach or None
        Cycles or days from the last inspection until the line reaches the limit; None without limit or line. Where that inspection does not
        prove that the limit is kept it begins with 0, and where it proves that it is not it is 0.
    per_day : float
        Cycles a day between the first and the last inspection; nan where that is not known.
    """

    gear_id: str
    quantity: str
    points: tuple[Point, ...]
    clock: str = ""
    steps: tuple[Advance, ...] = ()
    line: FittedLine | None = None
    from_new: bool = False
    significant: bool = False
    limit: float | None = None
    conformity: Conformity | None = None
    left: Reach | None = None
    per_day: float = math.nan

    @property
    def last(self) -> Point:
        return self.points[-1]

    @property
    def inspections(self) -> set[Occasion]:
        """Those with a value."""
        return {point.inspection for point in self.points}

    @property
    def days_left(self) -> Reach | None:
        """`left` in days, where that can be said."""
        if self.left is None or self.clock == DAYS:
            return self.left
        if not self.per_day > 0.0:
            return None
        return Reach(*(cycles / self.per_day for cycles in (self.left.value, self.left.low, self.left.high)))

    def date(self, days: float) -> datetime | None:
        """The date so many days after the last inspection; None where there is none or it is out of reach."""
        if self.last.inspected is None or not days < 100.0 * 365.25:
            return None
        try:
            return self.last.inspected + timedelta(days)
        except OverflowError:  # beyond what a calendar holds
            return None


@dataclass(frozen=True, slots=True, kw_only=True)
class GearTrend:
    """All quantities of one gear.

    Parameters
    ----------
    gear_id : str
    trends : dict of str to Trend
        By quantity.
    conformity : Conformity or None
        The worst of those with a limit.
    notes : tuple of str
        What the reader must know.
    missing : tuple of str
        Quantities with a limit of which there is no number.
    """

    gear_id: str
    trends: Mapping[str, Trend]
    conformity: Conformity | None
    notes: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    @property
    def nearest(self) -> Trend | None:
        """The quantity that decides: the worst by its limit, and of those the first to reach it or furthest beyond; None where none has a limit."""
        limited = [trend for trend in self.trends.values() if trend.limit is not None]
        return min(limited, key=_urgency, default=None)

    @property
    def used(self) -> float:
        """Largest share of a limit that is used up; 0 where there is none."""
        return max((trend.last.value / trend.limit for trend in self.trends.values() if trend.limit is not None), default=0.0)


def gear_trend(
    gear_id: str,
    readings: Sequence[Reading],
    limits: Mapping[str, float],
    notes: Sequence[str] = (),
    inspections: Iterable[Occasion] = (),
) -> GearTrend:
    """A gear over its inspections.

    Parameters
    ----------
    gear_id : str
    readings : sequence of Reading
        Of this gear.
    limits : mapping
        By quantity.
    notes : sequence of str
    inspections : iterable of Occasion
        Those without a result too: where one of them may be the last, the limits cannot be said to be kept.
    """
    measured = {reading.inspection for reading in readings}
    order = order_of([*inspections, *measured])
    by_quantity: dict[str, list[Reading]] = {}
    for reading in readings:
        by_quantity.setdefault(reading.quantity, []).append(reading)
    trends = {
        quantity: _trend(gear_id, quantity, by_quantity[quantity], limits.get(quantity), order)
        for quantity in QUANTITIES
        if quantity in by_quantity
    }
    remarks = list(notes)
    judged = [trend.conformity for trend in trends.values() if trend.conformity is not None]
    missing = [quantity for quantity in limits if quantity not in trends]
    if missing and trends:
        remarks.append(f"no value of {', '.join(missing)}, which has a limit")
    if missing:
        judged.append(Conformity.NEITHER)
    late = [name for name in limits if name in trends and order.last & measured - trends[name].inspections]
    if late:
        remarks.append(f"no value of {', '.join(late)} at the last inspection, which has a limit")
    if judged and trends and order.last - measured:
        remarks.append(
            NO_RESULT
            if len(order.last) == 1
            else f"no result of {len(order.last - measured)} of {len(order.last)} inspections that may be the last"
        )
    if trends and order.note:
        remarks.append(order.note)
    doubtful = [reading.doubts for reading in readings if reading.inspection in order.last]
    remarks += together(doubtful).words
    older = {reading.inspection for reading in readings if reading.doubts.grave} - order.last
    if older:
        remarks.append(f"{len(older)} of {len(measured)} inspections are doubtful, and in no rate")
    if any(step.falls for name in WORN_OFF if name in trends for step in trends[name].steps):
        remarks.append(OTHER_GEAR)
        trends = {name: replace(trend, clock="", line=None, left=None) for name, trend in trends.items()}
    else:
        remarks += _fallen(trends)
    return GearTrend(
        gear_id=gear_id, trends=trends, conformity=worst(judged), notes=tuple(remarks), missing=tuple(missing) if trends else ()
    )


def _fallen(trends: Mapping[str, Trend]) -> list[str]:
    """The numbers that only grow on the same gear and fell, by their ± at least: in one note, each by its last such step."""
    steps = {name: [step for step in trends[name].steps if step.seems_to_fall] for name in ONLY_GROW if name in trends}
    last = {name: found[-1] for name, found in steps.items() if found}
    if not last:
        return []
    told = ", ".join(
        f"{name} from {significant(step.before.value)} to {significant(step.after.value)}" for name, step in last.items()
    )
    open_ = not any(step.falls for step in last.values())
    ranges = ", unless the two reports answer otherwise what their ranges leave open" if open_ else ""
    return [f"what wear only makes larger fell: {told}{ranges}: {DOUBTED}"]


def with_significance(gears: Sequence[GearTrend]) -> list[GearTrend]:
    """The same, with what is significant among the steps and the rates of all gears, each quantity by itself."""
    rates: set[tuple[str, str]] = set()
    steps: set[tuple[str, str, int]] = set()
    for quantity in QUANTITIES:
        trends = [gear.trends[quantity] for gear in gears if quantity in gear.trends]
        lines = {(trend.gear_id, quantity): trend.line.p_value for trend in trends if trend.line is not None}
        rates |= set(compress(lines, discoveries([*lines.values()])))
        each = {(trend.gear_id, quantity, i): step.p_value for trend in trends for i, step in enumerate(trend.steps)}
        steps |= set(compress(each, discoveries([*each.values()])))

    def marked(trend: Trend) -> Trend:
        steps_marked = tuple(
            replace(step, significant=(trend.gear_id, trend.quantity, i) in steps) for i, step in enumerate(trend.steps)
        )
        return replace(trend, steps=steps_marked, significant=(trend.gear_id, trend.quantity) in rates)

    return [replace(gear, trends={name: marked(trend) for name, trend in gear.trends.items()}) for gear in gears]


def by_urgency(gears: Iterable[GearTrend]) -> list[GearTrend]:
    """The most urgent first: what does not conform, what may not, then what reaches a limit first by its line (at the earliest, where two
    are alike); without limits what wears fastest."""

    order = {Conformity.NOT_CONFORMING: 0, Conformity.NEITHER: 1, Conformity.CONFORMING: 2, None: 3}

    def key(gear: GearTrend) -> tuple[int, float, float, float, float, str]:
        nearest = gear.nearest
        *_, time_left, earliest = (math.inf, math.inf) if nearest is None else _urgency(nearest)
        at_limit = gear.conformity in (Conformity.NOT_CONFORMING, Conformity.NEITHER)
        return order[gear.conformity], -gear.used if at_limit else 0.0, time_left, earliest, _wear_rate(gear), gear.gear_id

    return sorted(gears, key=key)


def _wear_rate(gear: GearTrend) -> float:
    """Minus the rate of the worn volume, for sorting."""
    volume = gear.trends.get("wear_volume_mm3")
    return 0.0 if volume is None or volume.line is None else -volume.line.slope


def _urgency(trend: Trend) -> tuple[int, float, float, float]:
    """Smaller is more urgent: what does not conform, by how much; what may not; then time left by the line, and at the earliest."""
    assert trend.limit is not None
    reach = trend.days_left or trend.left
    bad = trend.conformity is Conformity.NOT_CONFORMING
    time_left = (math.inf, math.inf) if bad or reach is None else (reach.value, reach.low)
    place = 0 if trend.conformity is None else -GOOD_TO_BAD.index(trend.conformity)
    return place, -trend.last.value / trend.limit if bad else 0.0, *time_left


def points_of(readings: Iterable[Reading], order: Order | None = None) -> tuple[Point, ...]:
    """The inspections of one gear and quantity in the order of all of the gear's, scans of the same one taken together."""
    together: dict[Occasion, list[Reading]] = {}
    for reading in readings:
        together.setdefault(reading.inspection, []).append(reading)
    order = order or order_of(together)
    return tuple(_point(one, together[one]) for one in order.inspections if one in together)


def _point(inspection: Occasion, scans: Sequence[Reading]) -> Point:
    values, stds = np.array([scan.value for scan in scans]), np.array([scan.std for scan in scans])
    stated = math.sqrt(float(np.mean(np.square(stds)))) if np.isfinite(stds).all() else math.nan
    seen = float(values.std(ddof=1)) / math.sqrt(len(values)) if len(values) > 1 else 0.0
    ends = [own_range(scan.value, scan.std, scan.low, scan.high) for scan in scans]
    blind = any(not scan.std > 0.0 and math.isfinite(scan.low) and not math.isfinite(scan.high) for scan in scans)
    open_ = any(math.isfinite(scan.low) or math.isfinite(scan.high) for scan in scans)
    return Point(
        inspected=inspection.inspected,
        cycles=inspection.cycles,
        which=inspection.which,
        value=float(values.mean()),
        std=max(stated, seen) if math.isfinite(stated) else math.nan,
        low=min(low for low, _ in ends) if open_ else math.nan,
        high=max(high for _, high in ends) if open_ and not blind else math.nan,
        scans=len(scans),
        doubts=together(scan.doubts for scan in scans),
    )


def _trend(gear_id: str, quantity: str, readings: Sequence[Reading], limit: float | None, order: Order) -> Trend:
    points, state = _worst_last(points_of(readings, order), limit, order)
    clock, places = _places(points)
    usable = [
        (place, point)
        for place, point in zip(places, points, strict=False)
        if (point.noise > 0.0 or any(point.open)) and not point.doubts.grave
    ]
    line, from_new = None, False
    if clock and len(usable) > 1:
        x, y, std = (np.array(values) for values in zip(*((place, p.value, p.noise) for place, p in usable), strict=True))
        line = fit_line(x, y, std, *np.array([point.open for _, point in usable]).T)
    elif clock == CYCLES and len(usable) == 1 and quantity in NOTHING_AT_FIRST and usable[0][0] > 0.0:
        place, point = usable[0]
        line, from_new = line_from_new(place, point.value, point.noise, *point.open), True
    return Trend(
        gear_id=gear_id,
        quantity=quantity,
        points=points,
        clock=clock if line is not None else "",
        steps=tuple(_step(before, after) for before, after in pairwise(points)) if order.known or clock else (),
        line=line,
        from_new=from_new,
        limit=limit,
        conformity=state,
        left=None if limit is None or line is None or points[-1].doubts.grave else _left(line, limit, places[-1], state),
        per_day=_per_day(points),
    )


def _left(line: FittedLine, limit: float, now: float, state: Conformity | None) -> Reach:
    """How far the limit is off by the line, as far as the last inspection itself does not say otherwise."""
    reach = reaches(line, limit, now)
    if state is Conformity.NOT_CONFORMING:
        return Reach(0.0, 0.0, 0.0)
    return reach if state is Conformity.CONFORMING else replace(reach, low=0.0)


def _worst_last(points: tuple[Point, ...], limit: float | None, order: Order) -> tuple[tuple[Point, ...], Conformity | None]:
    """The points with the worst of those that may be the last at the end, and how it keeps its limit.

    Where an inspection that may be the last has no value, the limit cannot be said to be kept, and those before it are shown: the last of
    them, or where their order is not known the worst.
    """

    def judge(point: Point) -> Conformity | None:
        return None if limit is None else point.judged(limit)

    def badness(point: Point) -> tuple[int, float]:
        state = judge(point)
        return -1 if state is None else GOOD_TO_BAD.index(state), point.value

    may_be = [point for point in points if point.inspection in order.last] or (points[-1:] if order.known else points)
    last = max(may_be, key=badness)
    states = [judge(last)] if order.last <= {point.inspection for point in points} else [judge(last), Conformity.NEITHER]
    state = None if limit is None else worst(filter(None, states))
    return (*(point for point in points if point is not last), last), state


def _places(points: Sequence[Point]) -> tuple[str, list[float]]:
    """What the rate is per, and where the inspections lie: cycles where all have them and they grow, else days, else nothing."""
    cycles = [point.cycles for point in points if point.cycles is not None]
    if len(cycles) == len(points) and all(after > before for before, after in pairwise(cycles)):
        return CYCLES, cycles
    moments = [point.inspected for point in points if point.inspected is not None]
    if len(moments) == len(points) and moments == sorted(moments):
        return DAYS, [(moment - moments[0]).total_seconds() / SECONDS for moment in moments]
    return "", []


def _per_day(points: Sequence[Point]) -> float:
    known = [(point.inspected, point.cycles) for point in points if point.inspected is not None and point.cycles is not None]
    if len(known) < 2:
        return math.nan
    (first, low), (last, high) = known[0], known[-1]
    days = (last - first).total_seconds() / SECONDS
    return (high - low) / days if days > 0.0 else math.nan


def _step(before: Point, after: Point) -> Advance:
    value, std = after.value - before.value, math.hypot(before.noise, after.noise)
    down, up = after.open[0] + before.open[1], after.open[1] + before.open[0]
    low, high = interval(value, down, up, NORMAL_95 * std)
    return Advance(
        before=before, after=after, value=value, std=std, low=low, high=high,
        p_value=math.nan if before.doubts.grave or after.doubts.grave else chance_of(value, down, up, std),
    )  # fmt: skip

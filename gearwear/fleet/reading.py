"""From a store to what trend and gauge work on."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from gearwear.design.quantity import listed
from gearwear.fleet.doubts import NO_DOUBTS, Doubts, doubts_by_scan, together
from gearwear.fleet.gauge import GaugeStudy, Repeat, gauge_study, in_accord
from gearwear.fleet.line import beyond
from gearwear.fleet.manifest import read_moment, shown_time
from gearwear.fleet.order import Occasion, order_of
from gearwear.fleet.outcome import State
from gearwear.fleet.quantities import DOUBT, GEAR, MARK, PATTERN, TOOTH
from gearwear.fleet.store import Listed, Store
from gearwear.fleet.tables import read_tables
from gearwear.fleet.teeth import NumberedScan, doubt, numbered_scans, tooth_rows
from gearwear.fleet.trend import QUANTITIES, GearTrend, Reading, by_urgency, gear_trend, with_significance


@dataclass(frozen=True, slots=True)
class StoredFleet:
    """What a store holds of a fleet.

    Parameters
    ----------
    rows : tuple of Listed
        Scans of all manifests.
    states : dict of str to State
        By key; a scan without one was not compared yet.
    numbers : tuple of dict
        Rows of the tables: numbers of whole gears.
    scans : dict of str to NumberedScan
        How the tooth numbers of each scan go with those of the gear's first, by key.
    teeth : tuple of dict
        Numbers of teeth and flanks, in those tooth numbers.
    doubts : dict of str to Doubts
        Of the scans that have any, by key.
    """

    rows: tuple[Listed, ...]
    states: Mapping[str, State]
    numbers: tuple[dict[str, Any], ...]
    scans: Mapping[str, NumberedScan] = field(default_factory=dict)
    teeth: tuple[dict[str, Any], ...] = ()
    doubts: Mapping[str, Doubts] = field(default_factory=dict)

    @property
    def waiting(self) -> int:
        """Scans without a state."""
        return sum(row.key not in self.states for row in self.rows)

    def count(self, state: State) -> int:
        """Scans in a state."""
        return sum(self.states.get(row.key) is state for row in self.rows)


def read_fleet(store: Store) -> StoredFleet:
    """Read a store.

    Raises
    ------
    InputError
        If it is none.
    """
    rows, states = store.listed(), store.states()
    done = [row.key for row in rows if states.get(row.key) is State.DONE]
    tables = store.tables(done)
    patterns = (row for row in read_tables(tables, PATTERN) if row["converged"])  # else teeth are nowhere, the first scan's too
    scans = numbered_scans(patterns, read_tables(tables, MARK))
    teeth = tuple(tooth_rows(read_tables(tables, TOOTH), scans))
    return StoredFleet(
        tuple(rows), states, tuple(read_tables(tables, GEAR)), scans, teeth, doubts_by_scan(read_tables(tables, DOUBT))
    )


def trends(fleet: StoredFleet) -> list[GearTrend]:
    """All gears of a fleet, the most urgent first."""
    numbers: dict[str, list[dict[str, Any]]] = {}
    for number in fleet.numbers:
        if number["quantity"] in QUANTITIES:
            numbers.setdefault(number["gear_id"], []).append(number)
    by_gear = _by_gear(fleet.rows)
    alike: dict[str, list[str]] = {}
    for gear_id in by_gear:
        alike.setdefault("".join(gear_id.split()).casefold(), []).append(gear_id)
    also = {gear_id: [other for other in names if other != gear_id] for names in alike.values() for gear_id in names}
    gears = [_gear(fleet, gear_id, rows, numbers.get(gear_id, []), also[gear_id]) for gear_id, rows in by_gear.items()]
    return by_urgency(with_significance(gears))


def _by_gear(rows: Iterable[Listed]) -> dict[str, list[Listed]]:
    by_gear: dict[str, list[Listed]] = {}
    for row in rows:
        by_gear.setdefault(row.cells["gear_id"], []).append(row)
    return by_gear


def _gear(
    fleet: StoredFleet, gear_id: str, rows: Sequence[Listed], numbers: Sequence[dict[str, Any]], also: Sequence[str]
) -> GearTrend:
    """One gear; `also` are others whose names are the same but for capitals and blanks."""
    inspections = _inspections(rows)
    states = {row.key: fleet.states.get(row.key) for row in rows}
    notes = [f"there is {listed([*also])} too: is it the same gear?"] if also else []
    for state, words in ((State.REFUSED, "refused"), (State.FAILED, "failed"), (None, "not compared yet")):
        number = sum(reached is state for reached in states.values())
        if number:
            notes.append(f"{number} of {len(rows)} scans {words}")
    lost = {row["key"] for row in numbers if not row["converged"]}
    if lost:
        notes.append(f"{len(lost)} of {len(rows)} scans left out: their registration did not settle")
    doubtful = doubt(scan for scan in fleet.scans.values() if scan.gear_id == gear_id)
    notes += [doubtful] if doubtful else []
    readings = [_reading(row, inspections, fleet.doubts) for row in numbers if row["key"] not in lost]
    if not readings:  # with a reading its doubts are those of the inspection
        notes += together(fleet.doubts[row.key] for row in rows if row.key in fleet.doubts and row.key not in lost).words
    last = order_of(inspections.values()).last
    limits = _strictest(row.limits for row in rows if inspections[row.key] in last)
    return gear_trend(gear_id, readings, limits, notes, inspections.values())


def _inspections(rows: Sequence[Listed]) -> dict[str, Occasion]:
    """At which inspection each scan of a gear was, by key.

    Scans with the same date and cycles are of one. Those with neither are, where operator and repeat tell them apart: else nothing says that
    they are repeats, and each may be another.
    """
    inspections: dict[str, Occasion] = {}
    seen: Counter[tuple[str, str]] = Counter()
    for row in rows:
        moment, run = read_moment(row.cells.get("inspected", "")), row.cells.get("cycles_run", "")
        one = Occasion(moment, float(run) if run else None)
        if one == Occasion():
            who = row.cells.get("operator", ""), row.cells.get("repeat", "")
            one = Occasion(which=seen[who])
            seen[who] += 1
        inspections[row.key] = one
    return inspections


def _reading(row: Mapping[str, Any], inspections: Mapping[str, Occasion], doubts: Mapping[str, Doubts]) -> Reading:
    """From a row of a table."""
    inspection = _inspection(row, inspections)
    return Reading(
        gear_id=row["gear_id"], quantity=row["quantity"], value=row["value"], std=_known(row["std"]), inspected=inspection.inspected,
        cycles=inspection.cycles, which=inspection.which, low=_known(row["low"]), high=_known(row["high"]),
        doubts=doubts.get(row["key"], NO_DOUBTS),
    )  # fmt: skip


def _inspection(row: Mapping[str, Any], inspections: Mapping[str, Occasion]) -> Occasion:
    """Of a row of a table."""
    return inspections.get(row["key"], Occasion(row["inspected"], row["cycles_run"]))


def _strictest(limits: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """The smallest limit of each quantity, of several designs."""
    strictest: dict[str, float] = {}
    for each in limits:
        for quantity, limit in each.items():
            strictest[quantity] = min(limit, strictest.get(quantity, limit))
    return strictest


def _known(value: float | None) -> float:
    return math.nan if value is None else value


def gauge_studies(fleet: StoredFleet) -> tuple[list[GaugeStudy], dict[tuple[str, str], list[Repeat]]]:
    """The gauge study of every quantity, and the scans behind each, by quantity and flank.

    A part is a gear at the same cycles, whoever scanned it on which day; where these are not known, at one inspection: between two it wears.
    Left and right are those of its first scan: one that lay the other way up shows them exchanged.
    """
    inspections = {key: one for rows in _by_gear(fleet.rows).values() for key, one in _inspections(rows).items()}
    scans: dict[tuple[str, str], list[Repeat]] = {}
    for number in fleet.numbers:
        if number["converged"]:
            std, low, high = (_known(number[name]) for name in ("std", "low", "high"))
            part = _part(number["gear_id"], _inspection(number, inspections))
            repeat = Repeat(
                part, number["operator"], number["repeat"], number["value"], std, *beyond(number["value"], std, low, high),
                found=std > 0.0 or number["value"] != 0.0 or low != 0.0,
            )  # fmt: skip
            place, scan = (number["quantity"], number["flank"]), fleet.scans.get(number["key"])
            scans.setdefault(place if scan is None else scan.quantity_in_first(*place), []).append(repeat)
    order = {name: i for i, name in enumerate(QUANTITIES)}
    places = sorted(scans, key=lambda place: (order.get(place[0], len(order)), *place))
    studies = [gauge_study(*place, scans[place]) for place in places]
    return in_accord([study for study in studies if study is not None]), scans


def _part(gear_id: str, inspection: Occasion) -> str:
    """A name for a gear at an inspection, which no other one has.

    >>> from datetime import datetime
    >>> _part("G1", Occasion(datetime(2026, 3, 1), 1.5e6)), _part("G1", Occasion(which=1))
    ('G1 1500000 cycles', 'G1 inspection 2')
    """
    if inspection.cycles is not None:
        return f"{gear_id} {inspection.cycles:.15g} cycles"
    which = f"inspection {inspection.which + 1}" if inspection.which else ""
    return " ".join(filter(None, (gear_id, shown_time(inspection.inspected), which)))

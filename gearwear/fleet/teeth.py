"""The same teeth from inspection to inspection: the tooth numbers of every scan of a gear in those of its first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np

from gearwear.comparison.same_teeth import SameTeeth, TeethPattern, marked_ways, match_teeth
from gearwear.design.side import Side
from gearwear.fleet.order import Occasion, order_of

Rows = list[Mapping[str, Any]]
FLANKS = [str(side) for side in Side]
OTHER_HALF = {"lower": "upper", "upper": "lower"}
TEETH_COLUMNS: dict[str, type] = {
    "gear_id": str, "inspected": datetime, "cycles_run": float, "operator": str, "repeat": str, "quantity": str, "tooth": int, "flank": str,
    "value": float, "std": float, "low": float, "high": float, "tooth_in_report": int, "flank_in_report": str, "turned_teeth": int,
    "upside_down": bool, "probability": float, "told_by": str, "key": str,
}  # fmt: skip
"""Columns of ``teeth.csv``: a row for each number of a tooth or flank; `tooth` and `flank` are those of the gear's first scan."""


@dataclass(frozen=True, slots=True)
class StoredMark:
    """A mark that a scan was numbered by: where the design has it, by how much and with what std it stands off that (rad), and whether it told
    which end is up."""

    angle: float
    off: float
    std: float
    end_told: bool


@dataclass(frozen=True, slots=True)
class NumberedScan:
    """A scan whose teeth were told.

    Parameters
    ----------
    key, gear_id : str
    teeth : int
        Of the gear.
    same : SameTeeth
        Against the gear's first scan.
    place : int
        Of its inspection among the gear's.
    """

    key: str
    gear_id: str
    teeth: int
    same: SameTeeth
    place: int = 0

    def quantity_in_first(self, quantity: str, flank: str) -> tuple[str, str]:
        """A number of the whole gear, with its flank or of a half of a double helical gear, as the first scan's report calls it."""
        if self.same.flipped:
            half, of, rest = quantity.partition("_half_")
            quantity = f"{OTHER_HALF.get(half, half)}{of}{rest}"
        return quantity, self.in_first(1, flank)[1]

    def in_first(self, tooth: int, flank: str) -> tuple[int, str]:
        """A tooth, counted from 1, and a flank ("": none) of this scan's report, as the first scan's report calls them."""
        index = tooth - 1
        if self.same.flipped:
            index, flank = -index, str(Side.of(flank).opposite) if flank else flank
        return (index + self.same.turned) % self.teeth + 1, flank


def numbered_scans(rows: Iterable[Mapping[str, Any]], mark_rows: Iterable[Mapping[str, Any]] = ()) -> dict[str, NumberedScan]:
    """Match every scan of each gear with its first.

    Parameters
    ----------
    rows : iterable of mapping
        Rows of the scope "pattern", as `read_tables` gives them.
    mark_rows : iterable of mapping
        Those of the scope "mark": where two scans of a gear were numbered by a stated mark, it tells teeth and end of the later one, and what is
        the gear's own only what the mark leaves open.

    Returns
    -------
    dict of str to NumberedScan
        By key; scans of which the store holds no patterns, and such as have another number of teeth than the first, are left out.
    """
    by_gear: dict[str, dict[str, Rows]] = {}
    for row in rows:
        by_gear.setdefault(row["gear_id"], {}).setdefault(row["key"], []).append(row)
    marks = _marks(mark_rows)
    first: dict[str, tuple[str, Sequence[TeethPattern]]] = {}
    numbered: dict[str, NumberedScan] = {}
    for gear_id, place, key, scan_rows in _in_order(by_gear):
        patterns = _patterns(scan_rows)
        teeth = len(patterns[0].values)
        if gear_id not in first:
            first[gear_id] = key, patterns
            numbered[key] = NumberedScan(key, gear_id, teeth, SameTeeth(0, False, 1.0), place)
            continue
        first_key, theirs = first[gear_id]
        if [pattern.values.shape for pattern in theirs] == [pattern.values.shape for pattern in patterns]:
            marked = None
            if first_key in marks and key in marks:
                marked = marked_ways(marks[first_key], marks[key], marks[first_key].angle, teeth)
            numbered[key] = NumberedScan(key, gear_id, teeth, match_teeth(theirs, patterns, marked=marked), place)
    return numbered


def _marks(rows: Iterable[Mapping[str, Any]]) -> dict[str, StoredMark]:
    """Of each scan that was numbered by one, by key."""
    by_scan: dict[str, dict[str, Mapping[str, Any]]] = {}
    for row in rows:
        by_scan.setdefault(row["key"], {})[row["quantity"]] = row
    return {
        key: StoredMark(
            math.radians(stored["angle_deg"]["value"]),
            math.radians(stored["off_deg"]["value"]),
            math.radians(stored["off_deg"]["std"]),
            bool(stored["end_told"]["value"]),
        )
        for key, stored in by_scan.items()
        if {"angle_deg", "off_deg", "end_told"} <= stored.keys() and (stored["off_deg"]["std"] or 0.0) > 0.0
    }


def _in_order(by_gear: Mapping[str, Mapping[str, Rows]]) -> Iterator[tuple[str, int, str, Rows]]:
    """Gear, place of the inspection, key and rows of each scan, gear by gear in the order of its inspections."""
    for gear_id, scans in sorted(by_gear.items()):
        at = {key: Occasion(rows[0]["inspected"], rows[0]["cycles_run"]) for key, rows in scans.items()}
        places = order_of(at.values()).places
        for place, _, key in sorted((places[at[key]], _who(rows[0]), key) for key, rows in scans.items()):
            yield gear_id, place, key, scans[key]


def _who(row: Mapping[str, Any]) -> tuple[str, str]:
    """Tells scans of one inspection apart."""
    return row["operator"] or "", row["repeat"] or ""


def _patterns(rows: Sequence[Mapping[str, Any]]) -> list[TeethPattern]:
    """Patterns from their rows, in the order of their names."""
    by_name: dict[str, list[tuple[int, int, int, int, float]]] = {}
    for row in rows:
        name, i, j = row["quantity"].rsplit("/", 2)
        value = np.nan if row["value"] is None else row["value"]
        by_name.setdefault(name, []).append((row["tooth"] - 1, FLANKS.index(row["flank"]), int(i), int(j), value))
    teeth = max(cell[0] for values in by_name.values() for cell in values) + 1
    patterns = []
    for name, cells in sorted(by_name.items()):
        rows_, columns = max(cell[2] for cell in cells) + 1, max(cell[3] for cell in cells) + 1
        values = np.full((teeth, 2, rows_, columns), np.nan)
        for *place, value in cells:
            values[tuple(place)] = value
        patterns.append(TeethPattern(name, values))
    return patterns


def tooth_rows(numbers: Iterable[Mapping[str, Any]], scans: Mapping[str, NumberedScan]) -> list[dict[str, Any]]:
    """Rows of ``teeth.csv``: by gear, quantity, tooth, flank and inspection.

    Parameters
    ----------
    numbers : iterable of mapping
        Rows of the scope "tooth".
    scans : mapping
        By key; numbers of other scans are left out.
    """
    numbered = []
    for row in numbers:
        scan = scans.get(row["key"])
        if scan is None or not row["converged"]:
            continue
        tooth, flank = scan.in_first(int(row["tooth"]), row["flank"] or "")
        same = scan.same
        numbered.append(
            {
                **{name: row[name] for name in TEETH_COLUMNS if name in row},
                "tooth": tooth, "flank": flank, "tooth_in_report": row["tooth"], "flank_in_report": row["flank"] or "",
                "turned_teeth": same.turned, "upside_down": same.flipped, "probability": same.probability, "told_by": ", ".join(same.told_by),
            }
        )  # fmt: skip

    def place(row: Mapping[str, Any]) -> tuple[Any, ...]:
        return row["gear_id"], row["quantity"], row["tooth"], row["flank"], scans[row["key"]].place, _who(row), row["key"]

    numbered.sort(key=place)
    return [{name: row[name] for name in TEETH_COLUMNS} for row in numbered]


def doubt(scans: Iterable[NumberedScan]) -> str | None:
    """What is to be said of the tooth numbers of one gear; None where all are sure."""
    every = list(scans)
    unsure = sum(not scan.same.sure for scan in every)
    if not unsure:
        return None
    return f"tooth numbers of {unsure} of {len(every)} scans against the first are doubtful: too little on the gear tells its teeth apart"

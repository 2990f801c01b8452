"""Tables of what was found, by family, as markdown; the same scans of several versions side by side."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from scipy import stats

from benchmarks.families.families import FAMILIES
from benchmarks.families.scoring import score

Json = dict[str, Any]


def clopper_pearson(hits: int, number: int, level: float = 0.95) -> tuple[float, float]:
    """Exact interval of a share (Clopper and Pearson 1934)."""
    if number == 0:
        return 0.0, 1.0
    tail = 0.5 * (1.0 - level)
    low = 0.0 if hits == 0 else float(stats.beta.ppf(tail, hits, number - hits + 1))
    high = 1.0 if hits == number else float(stats.beta.ppf(1.0 - tail, hits + 1, number - hits))
    return low, high


def share(hits: int, number: int) -> str:
    """A share with its exact 95 % interval."""
    if number == 0:
        return "–"
    low, high = clopper_pearson(hits, number)
    return f"{hits}/{number} = {100 * hits / number:.0f} % ({100 * low:.0f}…{100 * high:.0f})"


def median(values: Iterable[float | None], unit: str = "", digits: int = 2) -> str:
    """Median of what is there."""
    got = [v for v in values if v is not None and math.isfinite(v)]
    return f"{np.median(got):.{digits}g}{unit}" if got else "–"


COLUMNS: Sequence[tuple[str, Callable[[list[Json]], str]]] = (
    ("scans", lambda rows: str(len(rows))),
    ("refused", lambda rows: str(sum(r["ended"] == "refused" for r in rows))),
    ("failed", lambda rows: str(sum(r["ended"] == "failed" for r in rows))),
    ("misplaced", lambda rows: str(sum(r.get("misplaced", False) for r in rows))),
    ("right names", lambda rows: share(*_right(rows))),
    ("of them by name", lambda rows: str(sum(t["match"] == "name" for r in _ok(rows) for t in r["true"]))),
    ("scans with a false name", lambda rows: share(sum(bool(r["false"]) for r in _ok(rows)), len(_ok(rows)))),
    ("near names", lambda rows: str(sum(len(r["near"]) for r in _ok(rows)))),
    ("unexplained", lambda rows: share(sum(r["unexplained"] for r in _ok(rows)), len(_ok(rows)))),
    ("outside: unexplained or near", lambda rows: share(*_outside(rows))),
    ("volume in its interval", lambda rows: share(sum(r["volume"]["covered"] for r in _ok(rows)), len(_ok(rows)))),
    ("volume off, median", lambda rows: median((_off(r["volume"]) for r in _ok(rows)), " %")),
    ("its ±, median", lambda rows: median((_width(r["volume"]) for r in _ok(rows)), " %")),
    (
        "worn flanks found",
        lambda rows: share(sum(r["flanks"]["found"] for r in _ok(rows)), sum(r["flanks"]["worn"] for r in _ok(rows))),
    ),
    (
        "of those found, in their intervals",
        lambda rows: share(sum(r["flanks"]["covered"] for r in _ok(rows)), sum(r["flanks"]["found"] for r in _ok(rows))),
    ),
    ("missed though deeper than the limit told", lambda rows: str(sum(r["flanks"]["deep_missed"] for r in _ok(rows)))),
    ("scans with false wear", lambda rows: share(sum(r["flanks"]["false"] > 0 for r in _ok(rows)), len(_ok(rows)))),
    ("thinnest in its interval", lambda rows: share(*_thin(rows))),
    ("thinnest off, median", lambda rows: median((abs(t["error_um"]) for t in _thins(rows)), " µm")),
    ("its std, median", lambda rows: median((t["std_um"] for t in _thins(rows)), " µm")),
    ("least of each tooth in its interval", lambda rows: share(*_covered(one for t in _thins(rows) for one in t["each"]))),
    ("deepest wear in its interval", lambda rows: share(*_covered(_deepest(rows)))),
    ("deepest off, median", lambda rows: median((abs(d["value"] - d["true"]) for d in _deepest(rows)), " µm")),
    ("its std, median", lambda rows: median((d["std"] for d in _deepest(rows)), " µm")),
    ("mean thickness off, median", lambda rows: median((t["mean_error_um"] for t in _thins(rows)), " µm")),
    ("processor seconds, median", lambda rows: median((r["seconds"] for r in rows), digits=3)),
    ("MB, most", lambda rows: f"{max((r['peak_mb'] or 0.0 for r in rows), default=0.0):.0f}"),
)
"""What is told of the scans of a family."""


def _covered(intervals: Iterable[Json]) -> tuple[int, int]:
    """How many intervals hold the truth, and how many there are."""
    held = [one["covered"] for one in intervals]
    return sum(held), len(held)


def _deepest(rows: list[Json]) -> list[Json]:
    """Deepest wear of every flank found, µm."""
    return [one for r in _ok(rows) for one in r["flanks"]["deepest"]]


def page(studies: Sequence[tuple[str, list[Json]]], kinds: bool = False) -> str:
    """All tables.

    Parameters
    ----------
    studies : sequence of (name, lines)
        Versions; where there are several, only scans that all of them have are told.
    kinds : bool
        Whether also by kinds within a family.
    """
    scored = [(name, {_key(line): score(line) for line in lines}) for name, lines in studies]
    common = set.intersection(*(set(rows) for _, rows in scored))
    parts = []
    for letter, family in FAMILIES.items():
        keys = sorted((k for k in common if k[0][0] == letter), key=lambda k: (k[1], int(k[0][1:])))
        if not keys:
            continue
        groups = {"": keys}
        if kinds:
            groups |= {
                what: [k for k in keys if scored[0][1][k]["what"] == what]
                for what in sorted({scored[0][1][k]["what"] for k in keys})
            }
        for what, some in groups.items():
            title = f"### {letter}: {family.title}" if not what else f"#### {letter}: {what}"
            parts.append(f"{title}\n\n{_table([(name, [rows[k] for k in some]) for name, rows in scored])}")
    return "\n\n".join([summary(scored, common), *parts])


def summary(scored: Sequence[tuple[str, dict[Any, Json]]], common: set[Any]) -> str:
    """One line a family and version: what the goals are about."""
    chosen = (
        "scans",
        "right names",
        "scans with a false name",
        "volume in its interval",
        "its ±, median",
        "thinnest in its interval",
        "worn flanks found",
    )
    columns = [(title, of) for title, of in COLUMNS if title in chosen]
    lines = [
        "| family | version | " + " | ".join(title for title, _ in columns) + " | refused or failed |",
        "|---|---|" + "---|" * (len(columns) + 1),
    ]
    for letter, family in FAMILIES.items():
        for name, rows in scored:
            some = [rows[k] for k in sorted(common) if k[0][0] == letter]
            if some:
                ended = sum(r["ended"] != "ok" for r in some)
                lines.append(
                    f"| {letter}: {family.title} | {name} | " + " | ".join(of(some) for _, of in columns) + f" | {ended} |"
                )
    return "\n".join(lines)


def _table(versions: Sequence[tuple[str, list[Json]]]) -> str:
    lines = ["| | " + " | ".join(name for name, _ in versions) + " |", "|---|" + "---|" * len(versions)]
    for title, of in COLUMNS:
        cells = [of(rows) for _, rows in versions]
        if any(cell not in ("–", "0") for cell in cells):
            lines.append(f"| {title} | " + " | ".join(cells) + " |")
    if len(versions) > 1:
        first = {r["label"]: r["volume"]["half"] for r in _ok(versions[0][1]) if r["volume"]["value"]}
        ratios = [
            [r["volume"]["half"] / first[r["label"]] for r in _ok(rows) if r["volume"]["value"] and first.get(r["label"])]
            for _, rows in versions
        ]
        lines.append("| ± of the volume over the first version's, median | " + " | ".join(median(one) for one in ratios) + " |")
    for title, of_row in (("false names", "false"), ("near names", "near"), ("names missed", "")):
        cells = []
        for _, rows in versions:
            told = [
                n for r in _ok(rows) for n in (r[of_row] if of_row else [t["name"] for t in r["true"] if t["match"] == "missed"])
            ]
            cells.append(", ".join(f"{name} {n}" for name, n in Counter(told).most_common()) or "–")
        if any(cell != "–" for cell in cells):
            lines.append(f"| {title} | " + " | ".join(cells) + " |")
    told = [
        [r["broken"] for r in _ok(rows) if r["broken"] is not None and r["broken"]["named"] is not None] for _, rows in versions
    ]
    if any(told):
        lines.append("| breakage named | " + " | ".join(share(sum(b["named"] for b in one), len(one)) for one in told) + " |")
        lines.append(
            "| broken volume in its interval | "
            + " | ".join(share(sum(b["covered"] for b in one), len(one)) for one in told)
            + " |"
        )
    untrue = [sum(r["broken"]["false"] for r in _ok(rows) if r["broken"] is not None) for _, rows in versions]
    if any(untrue):
        lines.append("| false breakage | " + " | ".join(map(str, untrue)) + " |")
    fitted = [_parameters(rows) for _, rows in versions]
    if any(number for _, number in fitted):
        lines.append("| parameters in their intervals | " + " | ".join(share(*one) for one in fitted) + " |")
    return "\n".join(lines)


def _key(line: Json) -> tuple[str, int, int]:
    return line["label"], line["study_seed"], line["study_points"]


def _ok(rows: list[Json]) -> list[Json]:
    return [r for r in rows if r["ended"] == "ok"]


def _right(rows: list[Json]) -> tuple[int, int]:
    true = [t for r in _ok(rows) for t in r["true"]]
    return sum(t["match"] != "missed" for t in true), len(true)


def _outside(rows: list[Json]) -> tuple[int, int]:
    some = [r for r in _ok(rows) if r["outside"]]
    return sum(bool(r["unexplained"] or r["near"] or r["allowed"]) for r in some), len(some)


def _off(volume: Json) -> float | None:
    return (
        100.0 * abs(volume["value"] - volume["true"]) / volume["true"]
        if volume["true"] > 0.0 and volume["value"] is not None
        else None
    )


def _width(volume: Json) -> float | None:
    """Standard deviation in per cent of what is true."""
    return 100.0 * volume["half"] / (1.96 * volume["true"]) if volume["true"] > 0.0 and volume["value"] else None


def _thins(rows: list[Json]) -> list[Json]:
    return [r["thinnest"] for r in _ok(rows) if r["thinnest"] is not None]


def _thin(rows: list[Json]) -> tuple[int, int]:
    return sum(t["covered"] for t in _thins(rows)), len(_thins(rows))


def _parameters(rows: list[Json]) -> tuple[int, int]:
    told = [p for r in _ok(rows) for t in r["true"] for p in t.get("parameters", {}).values() if p["std"]]
    return sum(abs(p["error"]) <= 1.96 * p["std"] for p in told), len(told)

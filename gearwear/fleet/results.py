"""Trend and gauge study as tables: plain rows for CSV and Parquet."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Any

from gearwear.fleet.anova import Component
from gearwear.fleet.gauge import GaugeStudy
from gearwear.fleet.trend import Advance, GearTrend, Point, Trend

TREND_COLUMNS: dict[str, type] = {
    "rank": int, "gear_id": str, "gear_conformity": str, "quantity": str, "inspections": int, "first": datetime, "last": datetime,
    "cycles_run": float, "value": float, "std": float, "low": float, "high": float, "limit": float, "conformity": str,
    "change": float, "change_std": float, "change_low": float, "change_high": float, "change_p": float, "change_significant": bool,
    "rate": float, "rate_std": float, "rate_low": float, "rate_high": float, "per": str, "rate_p": float, "rate_significant": bool, "from_new": bool, "line_misfit": float, "line_bends": bool, "left": float,
    "left_low": float, "left_high": float, "limit_on": datetime, "limit_on_earliest": datetime, "limit_on_latest": datetime,
    "doubtful": str, "unseen": str, "notes": str,
}  # fmt: skip
"""Columns of ``trend.csv``: a row for each gear and quantity; `left` in cycles or days, as `per` says."""

POINT_COLUMNS: dict[str, type] = {
    "gear_id": str, "quantity": str, "inspected": datetime, "cycles_run": float, "scans": int, "value": float, "std": float, "low": float,
    "high": float, "change": float, "change_std": float, "change_low": float, "change_high": float, "change_p": float,
    "change_significant": bool, "doubtful": str, "unseen": str,
}  # fmt: skip
"""Columns of ``inspections.csv``: a row for each gear, quantity and inspection; the change is from the one before, where their order is known."""

_PARTS = ("repeatability", "operator", "interaction", "reproducibility", "gauge", "part", "total")
GAUGE_COLUMNS: dict[str, type] = {
    "quantity": str, "flank": str, "parts": int, "operators": int, "repeats": int, "left_out": int,
    **{f"{name}_std{end}": float for name in _PARTS for end in ("", "_low", "_high")},
    "gauge_share": float, "categories": int, "p_interaction": float, "interaction_pooled": bool, "stated_std": float,
    "repeats_over_stated": float, "repeats_over_stated_low": float, "repeats_over_stated_high": float, "repeats_p": float,
    "all_over_stated": float, "all_over_stated_low": float, "all_over_stated_high": float, "accord": str,
}  # fmt: skip
"""Columns of ``gauge.csv``: a row for each quantity."""


def trend_rows(gears: Sequence[GearTrend]) -> list[dict[str, Any]]:
    """Rows of ``trend.csv``; a gear without any number has one of its own."""
    rows = []
    for rank, gear in enumerate(gears, 1):
        head = {"rank": rank, "gear_id": gear.gear_id, "gear_conformity": _word(gear.conformity), "notes": "; ".join(gear.notes)}
        lines = [{**head, **_trend_row(trend)} for trend in gear.trends.values()] or [head]
        rows += [{name: row.get(name) for name in TREND_COLUMNS} for row in lines]
    return rows


def _word(value: object) -> str:
    return "" if value is None else str(value)


def _trend_row(trend: Trend) -> dict[str, Any]:
    first, last, line = trend.points[0], trend.last, trend.line
    row: dict[str, Any] = {
        "quantity": trend.quantity, "inspections": len(trend.points), "first": first.inspected, "last": last.inspected,
        "cycles_run": last.cycles, "value": last.value, "std": last.std, "low": last.low, "high": last.high, "limit": trend.limit,
        "conformity": _word(trend.conformity), **_doubts(last),
    }  # fmt: skip
    if trend.steps:
        row |= _change(trend.steps[-1])
    if line is not None:
        row |= {
            "rate": line.slope, "rate_std": line.slope_std, "rate_low": line.slope_interval[0], "rate_high": line.slope_interval[1], "per": trend.clock, "rate_p": line.p_value,
            "rate_significant": trend.significant, "from_new": trend.from_new, "line_misfit": line.misfit, "line_bends": line.bends,
        }  # fmt: skip
    if trend.left is not None:
        row |= {"left": trend.left.value, "left_low": trend.left.low, "left_high": trend.left.high}
    days = trend.days_left
    if days is not None:
        row |= {
            "limit_on": trend.date(days.value), "limit_on_earliest": trend.date(days.low), "limit_on_latest": trend.date(days.high)
        }  # fmt: skip
    return row


def _doubts(point: Point) -> dict[str, Any]:
    return {"doubtful": "; ".join(point.doubts.grave), "unseen": "; ".join(point.doubts.unseen)}


def _change(step: Advance) -> dict[str, Any]:
    return {
        "change": step.value, "change_std": step.std, "change_low": step.low, "change_high": step.high, "change_p": step.p_value,
        "change_significant": step.significant,
    }  # fmt: skip


def point_rows(gears: Iterable[GearTrend]) -> list[dict[str, Any]]:
    """Rows of ``inspections.csv``."""
    rows = []
    for gear in gears:
        for trend in gear.trends.values():
            for i, point in enumerate(trend.points):
                row: dict[str, Any] = {
                    "gear_id": gear.gear_id, "quantity": trend.quantity, "inspected": point.inspected, "cycles_run": point.cycles,
                    "scans": point.scans, "value": point.value, "std": point.std, "low": point.low, "high": point.high,
                    **_doubts(point),
                }  # fmt: skip
                if i and trend.steps:
                    row |= _change(trend.steps[i - 1])
                rows.append({name: row.get(name) for name in POINT_COLUMNS})
    return rows


def gauge_rows(studies: Iterable[GaugeStudy]) -> list[dict[str, Any]]:
    """Rows of ``gauge.csv``."""
    rows = []
    for study in studies:
        variance = study.variance
        row: dict[str, Any] = {
            "quantity": study.quantity, "flank": study.flank, "parts": len(study.parts), "operators": len(study.operators),
            "repeats": study.repeats, "left_out": study.left_out, "stated_std": study.stated, "accord": str(study.accord),
        }  # fmt: skip
        if variance is not None:
            for name in _PARTS:
                part: Component | None = getattr(variance, name)
                if part is not None:
                    row |= dict(
                        zip((f"{name}_std", f"{name}_std_low", f"{name}_std_high"), (part.std, *part.std_interval), strict=True)
                    )
            row |= {
                "gauge_share": variance.share, "categories": variance.categories, "p_interaction": variance.p_interaction,
                "interaction_pooled": variance.pooled,
            }  # fmt: skip
        for name, ratio in (("repeats", study.repeatability), ("all", study.reproducibility)):
            if ratio is not None:
                row |= {
                    f"{name}_over_stated": ratio.ratio, f"{name}_over_stated_low": ratio.low, f"{name}_over_stated_high": ratio.high
                }  # fmt: skip
        if study.repeatability is not None:
            row["repeats_p"] = study.repeatability.p_value
        rows.append({name: row.get(name) for name in GAUGE_COLUMNS})
    return rows

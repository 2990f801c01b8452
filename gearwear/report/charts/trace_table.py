"""The values in µm under a row of traces."""

from __future__ import annotations

import math

import numpy as np

from gearwear.design.side import Side
from gearwear.inspection.estimate import RESOLVABLE_SHARE, Estimate
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.k_band import BandVerdict
from gearwear.inspection.tolerances import SYMBOLS, Tolerances, tolerances
from gearwear.report.charts.panel import GROUPS, Panel
from gearwear.report.charts.sheet import mean_seen, median_seen, micrometres, plain, strokes
from gearwear.report.figures.colours import ALARM, BLUE, INK, MUTED, RULE

ROW = 4.2
"""Height of a line, mm of paper."""


def table_height(with_k_band: bool) -> float:
    """mm of paper."""
    return (6.5 if with_k_band else 5.5) * ROW


def draw_table(panel: Panel, inspection: Inspection) -> None:
    """Slope, form, total and crowning of every flank, mean of all flanks and median U; K-band line where there are bands.

    Grey italics where U is over 30 % of the tolerance, bold red where the required class or the band is exceeded.
    """
    evaluation, top = panel.evaluation, panel.bottom - 5.0
    kind, letter = ("profile", "α") if evaluation.along == "roll" else ("helix", "β")
    limits = required_tolerances(inspection)
    parts: list[tuple[str, Estimate, float]] = []
    for part in ("slope", "form", "total"):
        limit = math.nan if limits is None else float(getattr(limits, f"{kind}_{part}"))
        parts.append((SYMBOLS[f"{kind}_{part}"], getattr(evaluation, part), limit))
    parts.append((f"C_{letter}", evaluation.crowning, math.nan))
    for side in Side:
        heads = [(place, str(tooth + 1)) for place, tooth in enumerate(panel.teeth)]
        for place, words in [*heads, (panel.columns, "mean"), (panel.columns + 1, "U")]:
            _write(panel, side, place, top + 0.6, words, MUTED, head=True)
    for line, (symbol, estimate, limit) in enumerate(parts):
        y = top - (line + 1.0) * ROW
        _name(panel, y, plain(symbol) + ("" if math.isnan(limit) else f" ≤ {1e3 * limit:g}"))
        for side in Side:
            for place, tooth in enumerate(panel.teeth):
                value, expanded = float(estimate.value[tooth, side.index]), float(estimate.expanded[tooth, side.index])
                over = abs(value) - expanded > limit or (abs(value) > limit and expanded <= RESOLVABLE_SHARE * limit)
                colour = ALARM if over else MUTED if expanded > RESOLVABLE_SHARE * limit else INK
                _write(panel, side, place, y, micrometres(value), colour)
            _write(panel, side, panel.columns, y, micrometres(mean_seen(estimate.value[:, side.index])), BLUE)
            _write(panel, side, panel.columns + 1, y, micrometres(median_seen(estimate.expanded[:, side.index])), MUTED)
    if evaluation.k is not None:
        _k_band_line(panel, top - (len(parts) + 1.0) * ROW)


def _k_band_line(panel: Panel, y: float) -> None:
    """How far every trace leaves its band; − is the room left; under the mean: flanks inside, of those seen."""
    k = panel.evaluation.k
    assert k is not None
    _name(panel, y, "K ≤ 0")
    colours = {BandVerdict.OUTSIDE: ALARM, BandVerdict.INSIDE: INK}
    for side in Side:
        if k.bands[side.index] is None:
            continue
        for place, tooth in enumerate(panel.teeth):
            verdict = k.verdict(tooth, side.index)
            words = micrometres(float(k.excess.value[tooth, side.index]))
            _write(panel, side, place, y, words, MUTED if verdict is None else colours.get(verdict, MUTED))
        count = k.count(side.index)
        seen = sum(count.values()) - count.get(BandVerdict.NOT_SEEN, 0)
        _write(panel, side, panel.columns, y, f"{count.get(BandVerdict.INSIDE, 0)}/{seen}", BLUE)
        _write(panel, side, panel.columns + 1, y, micrometres(median_seen(k.excess.expanded[:, side.index])), MUTED)


def required_tolerances(inspection: Inspection) -> Tolerances | None:
    """Tolerances of the required class, if one is required and the standard covers the gear."""
    settings = inspection.settings
    if settings.required_class is None or all(np.isnan(finding.grade.tolerance) for finding in inspection.findings):
        return None
    return tolerances(inspection.size, settings.required_class, settings.edition, inspection.pitch.sector)


def _name(panel: Panel, y: float, words: str) -> None:
    """A line's name, between the groups, and its rules."""
    panel.page.text(
        0.5 * (GROUPS[Side.LEFT][1] + GROUPS[Side.RIGHT][0]), y, words, fontsize=7, color=INK, ha="center", va="center"
    )
    strokes(panel.page, [((left, y + 0.5 * ROW), (right, y + 0.5 * ROW)) for left, right in GROUPS.values()], RULE, 0.4)


def _write(panel: Panel, side: Side, place: int, y: float, words: str, colour: str, head: bool = False) -> None:
    column = place < panel.columns and not head
    panel.page.text(
        panel.x(side, place), y, words, fontsize=7, color=colour, ha="center", va="center",
        fontstyle="italic" if column and colour == MUTED else "normal",
        fontweight="bold" if column and colour == ALARM else "normal",
    )  # fmt: skip

"""Profile and helix charts: a trace per tooth, left flanks on the left, right flanks on the right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.evaluation import Evaluation
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.k_band import KBand
from gearwear.inspection.sections import LineTraces
from gearwear.report.charts.panel import Panel, draw_axes, draw_ground
from gearwear.report.charts.pens import Pens
from gearwear.report.charts.sheet import A4, MAGNIFICATIONS, SOURCES, WIDTH, headline, sheet
from gearwear.report.charts.trace_table import draw_table, table_height
from gearwear.report.figures.colours import ALARM, BLUE, INK, MUTED, ORANGE, PAPER, TEAL, UNSEEN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PER_ROW = 12
"""Most teeth side by side."""

HEAD, FOOT = 27.0, 20.0
"""Header and footer, mm of paper."""

HEIGHTS = (120.0, 96.0)
"""Most height of the traces: of a single row, which fills an A4 page, and of several."""

_AREAS = {"spread": {"color": BLUE, "alpha": 0.16, "lw": 0}, "band": {"color": TEAL, "alpha": 0.16, "lw": 0}}
_LINES = {
    "band": {"color": TEAL, "lw": 0.6},
    "outside": {"color": ALARM, "lw": 2.2, "solid_capstyle": "butt"},
    "line": {"color": ALARM, "lw": 0.6, "ls": (0, (4, 2))},
    "cut": {"color": ALARM, "lw": 0.5, "ls": (0, (1, 2))},
    "trace": {"color": INK, "lw": 0.8},
    "own": {"color": ORANGE, "lw": 1.1},
}
"""What there is of each trace, the lowest first: its uncertainty and K band; the band's edge, what is outside of it, the mean line, where the trace
leaves its column, and the trace at the common magnification or its own."""

LENGTHS = tuple(m * 10.0**e for e in (1, 0, -1, -2) for m in (8.0, 6.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.2, 1.0))
"""Magnifications along the trace, falling."""


def profile_chart(figure: Figure, inspection: Inspection, teeth: Sequence[int] | None = None) -> Figure:
    """Profile traces of all teeth: left flanks on the left, right flanks on the right, tip up, + (more material) to the right.

    Parameters
    ----------
    figure : Figure
        Drawn on; its size is set.
    inspection : Inspection
        What was found; its K bands, if any, are drawn, and what is outside of them is marked.
    teeth : sequence of int or None
        0-based teeth to draw; None: all.

    Returns
    -------
    Figure
    """
    return _trace_chart(figure, inspection, inspection.profile, teeth)


def helix_chart(figure: Figure, inspection: Inspection, teeth: Sequence[int] | None = None) -> Figure:
    """Helix traces of all teeth, +z up; otherwise as `profile_chart`."""
    return _trace_chart(figure, inspection, inspection.helix, teeth)


def section_chart(figure: Figure, inspection: Inspection, teeth: Sequence[int] | None = None, *, section: LineTraces) -> Figure:
    """Traces along one line of all flanks; otherwise as `profile_chart`."""
    return _trace_chart(figure, inspection, section.evaluation, teeth, section)


def rows_of(teeth: Sequence[int]) -> list[list[int]]:
    """The teeth in rows of about the same number, at most `PER_ROW`.

    >>> [len(row) for row in rows_of(range(28))], [len(row) for row in rows_of(range(12))]
    ([10, 9, 9], [12])
    """
    count = max(1, math.ceil(len(teeth) / PER_ROW))
    return [[int(tooth) for tooth in row] for row in np.array_split(np.asarray(teeth, dtype=np.int64), count)]


def _trace_chart(
    figure: Figure,
    inspection: Inspection,
    evaluation: Evaluation,
    teeth: Sequence[int] | None,
    section: LineTraces | None = None,
) -> Figure:
    everyone = range(inspection.gear.teeth)
    rows = rows_of(everyone if teeth is None else teeth)
    columns = max(len(rows_of(everyone)[0]), len(rows[0]), 4)
    extent = float(evaluation.station[-1] - evaluation.station[0])
    stretch = next((m for m in LENGTHS if m * extent <= HEIGHTS[len(rows) > 1]), LENGTHS[-1])
    block = 9.0 + stretch * extent + table_height(evaluation.k is not None) + 6.0
    page = sheet(figure, max(HEAD + len(rows) * block + FOOT, A4))
    scale = _magnification(evaluation, Panel(page, evaluation, rows[0], columns, 0.0, 1, stretch).width)
    _head(page, inspection, evaluation, scale, stretch, section)
    pens = Pens(_AREAS, _LINES)
    for i, row in enumerate(rows):
        panel = Panel(
            page, evaluation, row, columns, page.get_ylim()[1] - HEAD - i * block - 9.0 - stretch * extent, scale, stretch
        )
        draw_ground(panel)
        for side in Side:
            for place, tooth in enumerate(row):
                _trace(panel, pens, side, place, tooth)
            _mean_trace(panel, side)
        draw_axes(panel, inspection.gear)
        draw_table(panel, inspection)
    pens.draw(page)
    _foot(page, inspection, evaluation)
    return figure


def _head(
    page: Axes, inspection: Inspection, evaluation: Evaluation, scale: int, stretch: float, section: LineTraces | None
) -> None:
    top, roll = page.get_ylim()[1], evaluation.along == "roll"
    where = evaluation.range
    letter, other = ("α", "z") if roll else ("β", "L")
    low, high = evaluation.band if roll else map(abs, evaluation.band)
    name, averaged = "Profile" if roll else "Helix", f"mean of {other} {low:.2f} … {high:.2f} mm"
    if section is not None:
        name += (
            {"low": " near z = 0", "middle": " at mid-face", "high": " near z = b"}[section.place]
            if roll
            else ({"low": " near the root", "middle": " at the measuring circle", "high": " near the tip"}[section.place])
        )
        averaged = f"at {other} = {section.at if roll else abs(section.at):.2f} mm, from points within ± {section.half_width:.2f} mm of it"
    headline(page, name, inspection, top - 9)
    wide = f" (up to {evaluation.cutoff:.2f} where the scan is thin)" if evaluation.cutoff > 1.01 * where.cutoff else ""
    start, end = map(abs, where.ends) if roll else where.ends
    evaluated = f"{'L' if roll else 'z'} {start:.2f} … {end:.2f} mm  (L{letter} = {where.length:.2f} mm)"
    if where.over is not None:
        evaluated += f", slope over {where.over:.3f} mm"
    line = f"evaluated {evaluated}   ·   Gauss filter λ = {where.cutoff:.3f} mm{wide}   ·   {averaged}"
    page.text(8, top - 15, line, fontsize=7.5, color=INK, va="baseline")
    up = "tip up" if roll else "+z up"
    line = f"magnification {scale}:1 across, {stretch:g}:1 along   ·   {up}, more material to the right   ·   traces set to their mean line"
    page.text(8, top - 19.5, line, fontsize=7.5, color=INK, va="baseline")
    page.plot([8, WIDTH - 8], [top - 22, top - 22], color=INK, lw=0.8)
    page.text(WIDTH - 8, top - 9, str(inspection.settings.edition), fontsize=8, color=INK, ha="right", va="baseline")
    required = inspection.settings.required_class
    line = f"required class {required}" if required is not None else "no class required"
    page.text(WIDTH - 8, top - 19.5, f"{line}   ·   teeth numbered counter-clockwise seen from +z", fontsize=7, color=MUTED, ha="right", va="baseline")  # fmt: skip


def _trace(panel: Panel, pens: Pens, side: Side, place: int, tooth: int) -> None:
    """One trace in its column, with its mean line, its uncertainty and its K band."""
    page, evaluation = panel.page, panel.evaluation
    x, half, common = panel.x(side, place), 0.5 * panel.width, panel.scale
    if math.isnan(evaluation.line[tooth, side.index, 0]):
        middle = 0.5 * (panel.bottom + panel.top)
        page.text(x, middle, "not seen", fontsize=7, color=MUTED, rotation=90, ha="center", va="center")
        return
    height = panel.y(evaluation.station)
    zero, trace = evaluation.line[tooth, side.index, 0], evaluation.filtered[tooth, side.index]
    scale = _own_scale(trace - zero, common, half)
    if scale != common:
        _own_scale_words(panel, x, scale, ORANGE)
    across = scale * (trace - zero)
    shown = np.where(np.abs(across) <= half, across, np.nan)
    wide = 2.0 * scale * evaluation.standard[tooth, side.index]
    low, high = (x + np.clip(shown + sign * wide, -half, half) for sign in (-1.0, 1.0))
    pens.area("spread", height, low, high)
    band = None if evaluation.k is None else evaluation.k.bands[side.index]
    if evaluation.k is not None and band is not None and math.isfinite(evaluation.k.shift[tooth, side.index]):
        outside = _band(panel, pens, x, scale, band, float(evaluation.k.shift[tooth, side.index]), zero, trace)
        pens.line("outside", x + np.where(outside, shown, np.nan), height)
    ends = np.array(evaluation.range.ends)
    line = scale * (evaluation.line_at(ends)[tooth, side.index] - zero)
    if np.abs(line).max() <= half:
        pens.line("line", x + line, panel.y(ends))
    pens.line("cut", x + np.where(np.abs(across) > half, np.clip(across, -half, half), np.nan), height)
    pens.line("trace" if scale == common else "own", x + shown, height)
    _clipped(panel, x, across, scale)


def _band(panel: Panel, pens: Pens, x: float, scale: int, band: KBand, shift: float, zero: float, trace: Floats) -> Floats:
    """Draw a band where it suits a trace best; where the trace is outside of it."""
    half = 0.5 * panel.width
    low, high = (x + np.clip(scale * (np.array(limit) + shift - zero), -half, half) for limit in (band.lower, band.upper))
    corner = panel.y(np.array(band.station))
    pens.area("band", corner, low, high)
    pens.line("band", np.concatenate([low, high[::-1], low[:1]]), np.concatenate([corner, corner[::-1], corner[:1]]))
    station = panel.evaluation.station
    lower, upper = (np.interp(station, band.station, limit) + shift for limit in (band.lower, band.upper))
    return np.asarray(band.covers(station) & ((trace > upper) | (trace < lower)))


def _clipped(panel: Panel, x: float, across: Floats, scale: int) -> None:
    """Where a trace leaves its column on either side: an arrow and how far it goes."""
    half, height = 0.5 * panel.width, panel.y(panel.evaluation.station)
    for sign in (-1.0, 1.0):
        out = np.flatnonzero(np.nan_to_num(sign * across) > half)
        if len(out):
            at = out[np.argmax(sign * across[out])]
            y = float(np.clip(height[at], height[0] + 1.0, height[-1] - 3.5))
            panel.page.plot(x + sign * half, y, marker="<" if sign < 0 else ">", ms=3, color=ALARM)
            words = f"{1e3 * across[at] / scale:+.0f}".replace("-", "−")
            align = "left" if sign < 0 else "right"
            panel.page.text(x + sign * (half - 0.6), y + 1.2, words, fontsize=7, color=ALARM, ha=align)


def _mean_trace(panel: Panel, side: Side) -> None:
    """Mean of the traces of all teeth, each set to its mean line; only where all of them were seen."""
    evaluation = panel.evaluation
    seen = np.isfinite(evaluation.line[:, side.index, 0])
    if seen.sum() < 2:
        return
    mean = (evaluation.filtered[seen, side.index] - evaluation.line[seen, side.index, :1]).mean(axis=0)
    x, half = panel.x(side, panel.columns), 0.5 * panel.width
    scale = _own_scale(mean, panel.scale, half)
    if scale != panel.scale:
        _own_scale_words(panel, x, scale, BLUE)
    across = np.where(np.abs(scale * mean) <= half, scale * mean, np.nan)
    panel.page.plot([x, x], [panel.bottom, panel.top], color=UNSEEN, lw=0.4)
    panel.page.plot(x + across, panel.y(evaluation.station), color=BLUE, lw=1.0)


def _own_scale_words(panel: Panel, x: float, scale: int, colour: str) -> None:
    ground = {"boxstyle": "square,pad=0.1", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.85}
    panel.page.text(
        x, panel.top - 3.2, f"{scale}:1", fontsize=7, fontweight="bold", color=colour, ha="center", bbox=ground, zorder=5
    )


def _foot(page: Axes, inspection: Inspection, evaluation: Evaluation) -> None:
    lines = [
        "Values in µm; U (k = 2, median of all flanks) from the scan's scatter, with what noise may add. Shaded: ± U. Dashed red: least-squares line. Dashed green: ends of the evaluation range.",
        "Orange: a trace too large for the common magnification, drawn at its own. Grey italics: not resolvable (U over 30 % of the tolerance). Bold red: exceeds the required class.",
    ]
    if evaluation.k is not None:
        source = inspection.settings.k_bands.source if inspection.settings.k_bands is not None else ""
        lines.append(
            f"Green: K band ({source}), set where it suits the trace best; thick red: outside of it. K: how far the trace leaves it, − is the room left."
        )
    unseen = [note for note in inspection.notes if note.startswith("Not seen")]
    words = "\n".join([*lines, SOURCES, *unseen[:1]])
    page.text(8, 18.5, words[:1100], fontsize=7, color=MUTED, va="top", linespacing=1.3)


def _own_scale(trace: Floats, scale: int, half: float) -> int:
    """The common magnification, or the largest that holds a trace too big for it."""
    size = np.abs(trace[np.isfinite(trace)])
    if not len(size) or scale * float(np.quantile(size, 0.97)) <= half:
        return scale
    return next((m for m in MAGNIFICATIONS if m < scale and m * float(size.max()) <= half), 1)


def _magnification(evaluation: Evaluation, width: float) -> int:
    """The largest round magnification at which four of five traces, and their K bands, stay in their columns."""
    off = np.abs(evaluation.filtered - evaluation.line[..., :1])
    known = np.isfinite(off).any(axis=-1)
    if not known.any():
        return 100
    reach = float(np.quantile(np.nanmax(off[known], axis=-1), 0.8))
    for side, band in enumerate(evaluation.k.bands if evaluation.k is not None else ()):
        shift = (evaluation.k.shift - evaluation.line[..., 0])[:, side] if evaluation.k is not None else np.zeros(0)
        if band is not None and np.isfinite(shift).any():
            middle = float(np.nanmedian(shift))
            reach = max(reach, middle + max(band.upper), -middle - min(band.lower))
    return next((m for m in MAGNIFICATIONS if m * reach <= 0.5 * width), 1)

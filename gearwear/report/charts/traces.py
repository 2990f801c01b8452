"""Profile and helix charts: a trace per tooth, left flanks on the left, right flanks on the right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.profiles import LEFT, RIGHT
from gearwear.measure.inspection.estimate import RESOLVABLE_SHARE, Estimate
from gearwear.measure.inspection.evaluation import Evaluation, KBand
from gearwear.measure.inspection.inspection import Inspection
from gearwear.measure.inspection.tolerances import SYMBOLS, Tolerances, tolerances
from gearwear.report.charts.sheet import (
    MAGNIFICATIONS,
    SIDE_NAMES,
    WIDTH,
    gear_words,
    mean_seen,
    median_seen,
    micrometres,
    nice,
    sheet,
    tex,
)
from gearwear.report.colours import BLUE, INK, LOST, MUTED, ORANGE, RULE, TEAL, UNSEEN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PER_ROW = 12
"""Most teeth side by side."""

GROUPS = {LEFT: (20.0, 138.0), RIGHT: (160.0, 278.0)}
"""Where the left and the right flanks stand on the paper, mm."""

HEIGHT, HEAD, ROW, FOOT = 98.0, 27.0, 4.2, 14.0
"""Trace, header, table row and footer, mm of paper."""

LENGTHS = (20.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.5, 0.2, 0.1, 0.05)
"""Magnifications along the trace, falling."""


def profile_chart(
    figure: Figure,
    inspection: Inspection,
    teeth: Sequence[int] | None = None,
    k_band: KBand | None = None,
    magnification: int | None = None,
) -> Figure:
    """Profile traces of all teeth: left flanks on the left, right flanks on the right, tip up, + (more material) to the right.

    Parameters
    ----------
    figure : Figure
        Drawn on; its size is set.
    inspection : Inspection
        What was found.
    teeth : sequence of int or None
        0-based teeth to draw; None: all.
    k_band : KBand or None
        Limits every trace must run between; what is outside is marked.
    magnification : int or None
        Of the deviation, paper : part; None: the largest of 1, 2, 5 × 10ⁿ that holds four of five traces.

    Returns
    -------
    Figure
    """
    return _trace_chart(figure, inspection, inspection.profile, teeth, k_band, magnification)


def helix_chart(
    figure: Figure,
    inspection: Inspection,
    teeth: Sequence[int] | None = None,
    k_band: KBand | None = None,
    magnification: int | None = None,
) -> Figure:
    """Helix traces of all teeth, +z up; otherwise as `profile_chart`."""
    return _trace_chart(figure, inspection, inspection.helix, teeth, k_band, magnification)


def _trace_chart(
    figure: Figure,
    inspection: Inspection,
    found: Evaluation,
    teeth: Sequence[int] | None,
    k_band: KBand | None,
    magnification: int | None,
) -> Figure:
    shown = list(range(inspection.gear.teeth)) if teeth is None else list(teeth)
    rows = [shown[i : i + PER_ROW] for i in range(0, len(shown), PER_ROW)]
    columns = max(max(len(row) for row in rows), 4)
    width = (GROUPS[LEFT][1] - GROUPS[LEFT][0]) / (columns + 2)  # two more: the mean, and U
    scale = magnification or _magnification(found, shown, width)
    low, extent = float(found.station[0]), float(found.station[-1])
    stretch = next((m for m in LENGTHS if m * (extent - low) <= HEIGHT), LENGTHS[-1])
    block = 9.0 + stretch * (extent - low) + 5.5 * ROW + 6.0
    page = sheet(figure, HEAD + len(rows) * block + FOOT)
    _head(page, inspection, found, scale, stretch, k_band)
    top = page.get_ylim()[1] - HEAD
    for row in rows:
        bottom = top - 9.0 - stretch * (extent - low)
        for side in (LEFT, RIGHT):
            _frame(page, side, bottom, row, width, found, low, extent, stretch)
            for place, tooth in enumerate(row):
                _trace(
                    page, GROUPS[side][0] + (place + 0.5) * width, bottom, found, tooth, side, low, scale, stretch, width, k_band
                )
            _mean_trace(page, GROUPS[side][0] + (columns + 0.5) * width, bottom, found, shown, side, low, scale, stretch, width)
        _axis_labels(page, inspection, found, bottom, low, extent, stretch)
        _scale_bar(page, bottom, stretch * (extent - low), scale)
        _table(page, bottom - 5.0, inspection, found, row, width, columns)
        top -= block
    _foot(page, inspection)
    return figure


def _head(page: Axes, inspection: Inspection, found: Evaluation, scale: int, stretch: float, k_band: KBand | None) -> None:
    top, roll = page.get_ylim()[1], found.along == "roll"
    where = found.range
    letter, other = ("\\alpha", "z") if roll else ("\\beta", "L")
    page.text(8, top - 9, "Profile" if roll else "Helix", fontsize=15, fontweight="bold", color=INK, va="baseline")
    page.text(38, top - 9, gear_words(inspection), fontsize=8, color=INK, va="baseline")
    wide = f" (up to {found.cutoff:.2f} where the scan is thin)" if found.cutoff > 1.01 * where.cutoff else ""
    evaluated = f"{'L' if roll else 'z'} {where.start:.2f} … {where.end:.2f} mm  ($L_{letter}$ = {where.length:.2f} mm)"
    line = f"evaluated {evaluated}   ·   Gauss filter λ = {where.cutoff:.3f} mm{wide}   ·   mean of {other} {found.band[0]:.2f} … {found.band[1]:.2f} mm"
    page.text(8, top - 15, line, fontsize=7.5, color=INK, va="baseline")
    up = "tip up" if roll else "+z up"
    line = f"magnification {scale}:1 across, {stretch:g}:1 along   ·   {up}, more material to the right   ·   traces set to their mean line"
    if k_band is not None:
        line += "   ·   K band shaded, outside it red"
    page.text(8, top - 19.5, line, fontsize=7.5, color=INK, va="baseline")
    page.plot([8, WIDTH - 8], [top - 22, top - 22], color=INK, lw=0.8)
    page.text(WIDTH - 8, top - 9, str(inspection.settings.edition), fontsize=8, color=INK, ha="right", va="baseline")
    required = inspection.settings.required_class
    line = f"required class {required}" if required is not None else "no class required"
    page.text(WIDTH - 8, top - 19.5, f"{line}   ·   teeth numbered counter-clockwise seen from +z", fontsize=7, color=MUTED, ha="right", va="baseline")  # fmt: skip


def _frame(
    page: Axes,
    side: int,
    bottom: float,
    row: list[int],
    width: float,
    found: Evaluation,
    low: float,
    extent: float,
    stretch: float,
) -> None:
    """Ground of one group: name, tooth numbers, nominal lines, evaluation range."""
    left, right = GROUPS[side]
    high = bottom + stretch * (extent - low)
    start, end = (bottom + stretch * (v - low) for v in (found.range.start, found.range.end))
    page.fill_between([left, right], end, high, color=RULE, alpha=0.45, lw=0)
    page.fill_between([left, right], bottom, start, color=RULE, alpha=0.45, lw=0)
    page.plot([left, right, right, left, left], [bottom, bottom, high, high, bottom], color=MUTED, lw=0.5)
    for y in (start, end):
        page.plot([left, right], [y, y], color=TEAL, lw=0.7, ls=(0, (6, 3)))
    page.text(0.5 * (left + right), high + 5.0, SIDE_NAMES[side], fontsize=8.5, fontweight="bold", color=INK, ha="center")
    for place in range(len(row)):
        x = left + (place + 0.5) * width
        page.plot([x, x], [bottom, high], color=UNSEEN, lw=0.4)
        page.text(x, high + 1.2, str(row[place] + 1), fontsize=7, color=INK, ha="center")
    page.text(right - 1.5 * width, high + 1.2, "mean", fontsize=6.5, color=MUTED, ha="center")


def _trace(
    page: Axes,
    x: float,
    bottom: float,
    found: Evaluation,
    tooth: int,
    side: int,
    low: float,
    scale: int,
    stretch: float,
    width: float,
    k_band: KBand | None,
) -> None:
    """One trace in its column, with its mean line, its uncertainty and, if asked, its K band."""
    if math.isnan(found.line[tooth, side, 0]):
        middle = bottom + 0.5 * stretch * (found.range.end - low)
        page.text(x, middle, "not seen", fontsize=6.5, color=MUTED, rotation=90, ha="center", va="center")
        return
    height = bottom + stretch * (found.station - low)
    zero = found.line[tooth, side, 0]
    trace = found.filtered[tooth, side]
    half = 0.5 * width
    common, scale = scale, _own_scale(trace - zero, scale, half)
    if scale != common:
        page.text(
            x,
            bottom + stretch * float(found.station[-1] - low) - 3.0,
            f"{scale}:1",
            fontsize=6.5,
            fontweight="bold",
            color=ORANGE,
            ha="center",
        )
    across = scale * (trace - zero)
    shown = np.where(np.abs(across) <= half, across, np.nan)
    wide = 2.0 * scale * found.standard[tooth, side]
    page.fill_betweenx(
        height, x + np.clip(shown - wide, -half, half), x + np.clip(shown + wide, -half, half), color=BLUE, alpha=0.16, lw=0
    )
    if k_band is not None:
        shift, _ = k_band.place(found.station, trace)
        corner = bottom + stretch * (np.array(k_band.station) - low)
        edges = [x + np.clip(scale * (np.array(limit) + shift - zero), -half, half) for limit in (k_band.lower, k_band.upper)]
        page.fill_betweenx(corner, *edges, color=TEAL, alpha=0.14, lw=0)
        for edge in edges:
            page.plot(edge, corner, color=TEAL, lw=0.5)
        lower, upper = (
            np.interp(found.station, k_band.station, limit, np.nan, np.nan) + shift for limit in (k_band.lower, k_band.upper)
        )
        page.plot(
            x + np.where((trace > upper) | (trace < lower), shown, np.nan), height, color=LOST, lw=2.2, solid_capstyle="butt"
        )
    ends = np.array([found.range.start, found.range.end])
    line = scale * (found.line_at(ends)[tooth, side] - zero)
    if np.abs(line).max() <= half:
        page.plot(x + line, bottom + stretch * (ends - low), color=LOST, lw=0.6, ls=(0, (4, 2)))
    page.plot(
        x + np.where(np.abs(across) > half, np.clip(across, -half, half), np.nan), height, color=LOST, lw=0.5, ls=(0, (1, 2))
    )
    page.plot(x + shown, height, color=INK if scale == common else ORANGE, lw=0.8 if scale == common else 1.1)
    _clipped(page, x, height, across, half, scale)


def _clipped(page: Axes, x: float, height: Floats, across: Floats, half: float, scale: int) -> None:
    """Where a trace leaves its column on either side: an arrow and how far it goes."""
    for sign in (-1.0, 1.0):
        out = np.flatnonzero(np.nan_to_num(sign * across) > half)
        if len(out):
            at = out[np.argmax(sign * across[out])]
            y = float(np.clip(height[at], height[0] + 1.0, height[-1] - 3.5))
            page.plot(x + sign * half, y, marker="<" if sign < 0 else ">", ms=3, color=LOST)
            words = f"{1e3 * across[at] / scale:+.0f}".replace("-", "−")
            page.text(x + sign * (half - 0.6), y + 1.2, words, fontsize=5.5, color=LOST, ha="left" if sign < 0 else "right")


def _mean_trace(
    page: Axes,
    x: float,
    bottom: float,
    found: Evaluation,
    shown: list[int],
    side: int,
    low: float,
    scale: int,
    stretch: float,
    width: float,
) -> None:
    """Mean of the traces shown, each set to its mean line; only where all of them were seen."""
    seen = [tooth for tooth in shown if not math.isnan(found.line[tooth, side, 0])]
    if len(seen) < 2:
        return
    mean = (found.filtered[seen, side] - found.line[seen, side, :1]).mean(axis=0)
    common, scale = scale, _own_scale(mean, scale, 0.5 * width)
    if scale != common:
        page.text(
            x,
            bottom + stretch * float(found.station[-1] - low) - 3.0,
            f"{scale}:1",
            fontsize=6.5,
            fontweight="bold",
            color=BLUE,
            ha="center",
        )
    across = np.where(np.abs(scale * mean) <= 0.5 * width, scale * mean, np.nan)
    page.plot([x, x], [bottom, bottom + stretch * float(found.station[-1] - low)], color=UNSEEN, lw=0.4)
    page.plot(x + across, bottom + stretch * (found.station - low), color=BLUE, lw=1.0)


def _axis_labels(
    page: Axes, inspection: Inspection, found: Evaluation, bottom: float, low: float, extent: float, stretch: float
) -> None:
    """Roll length and diameter, or z, beside the groups."""
    base = inspection.gear.base_radius
    roll = found.along == "roll"
    step = nice(12.0 / stretch)
    for value in np.arange(math.ceil(low / step) * step, extent + 1e-9, step):
        y = bottom + stretch * (value - low)
        page.plot([GROUPS[LEFT][0] - 1.2, GROUPS[LEFT][0]], [y, y], color=MUTED, lw=0.5)
        page.text(GROUPS[LEFT][0] - 1.8, y, f"{value:g}", fontsize=6.5, color=INK, ha="right", va="center")
        page.plot([GROUPS[RIGHT][1], GROUPS[RIGHT][1] + 1.2], [y, y], color=MUTED, lw=0.5)
        label = f"{2 * math.hypot(base, value):.2f}" if roll else f"{value:g}"
        page.text(GROUPS[RIGHT][1] + 1.8, y, label, fontsize=6.5, color=INK, ha="left", va="center")
    high = bottom + stretch * (extent - low)
    page.text(GROUPS[LEFT][0] - 1.8, high + 1.5, "L mm" if roll else "z mm", fontsize=6.5, color=MUTED, ha="right")
    page.text(GROUPS[RIGHT][1] + 1.8, high + 1.5, "⌀ mm" if roll else "z mm", fontsize=6.5, color=MUTED, ha="left")


def _scale_bar(page: Axes, bottom: float, height: float, scale: int) -> None:
    """A bar between the groups that is a round number of micrometres long."""
    um = nice(8.0e3 / scale)
    half, x, y = 0.5e-3 * um * scale, 0.5 * (GROUPS[LEFT][1] + GROUPS[RIGHT][0]), bottom + 0.5 * height
    page.plot([x - half, x + half], [y, y], color=INK, lw=1.0, marker="|", ms=5)
    page.text(x, y + 2.2, f"{um:g} µm", fontsize=7.5, color=INK, ha="center")
    page.text(x, y - 4.2, f"{scale}:1", fontsize=7.5, color=INK, ha="center")


def _table(page: Axes, top: float, inspection: Inspection, found: Evaluation, row: list[int], width: float, columns: int) -> None:
    """Values in µm under the traces; grey where U is over 30 % of the tolerance, red where the required class is exceeded."""
    kind, letter = ("profile", "α") if found.along == "roll" else ("helix", "β")
    limits = _limits(inspection)
    parts: list[tuple[str, Estimate, str]] = [
        (SYMBOLS[f"{kind}_{p}"], getattr(found, p), f"{kind}_{p}") for p in ("slope", "form", "total")
    ]
    parts.append((f"C_{letter}", found.crowning, ""))
    middle = 0.5 * (GROUPS[LEFT][1] + GROUPS[RIGHT][0])
    for side in (LEFT, RIGHT):
        left, right = GROUPS[side]
        page.text(right - 0.5 * width, top + 0.6, "U", fontsize=6.5, color=MUTED, ha="center", va="center")
        page.text(right - 1.5 * width, top + 0.6, "mean", fontsize=6.5, color=MUTED, ha="center", va="center")
        for place, tooth in enumerate(row):
            page.text(
                left + (place + 0.5) * width, top + 0.6, str(tooth + 1), fontsize=6.5, color=MUTED, ha="center", va="center"
            )
    for line, (symbol, part, quantity) in enumerate(parts):
        y = top - (line + 1.0) * ROW
        limit = getattr(limits, quantity) if limits is not None and quantity else math.nan
        note = "" if math.isnan(limit) else f" ≤ {1e3 * limit:g}"
        page.text(middle, y, f"{tex(symbol)}{note}", fontsize=7, color=INK, ha="center", va="center")
        for side in (LEFT, RIGHT):
            left, right = GROUPS[side]
            page.plot([left, right], [y + 0.5 * ROW] * 2, color=RULE, lw=0.4)
            for place, tooth in enumerate(row):
                value, expanded = float(part.value[tooth, side]), float(part.expanded[tooth, side])
                over = abs(value) - expanded > limit or (abs(value) > limit and expanded <= RESOLVABLE_SHARE * limit)
                colour = LOST if over else MUTED if expanded > RESOLVABLE_SHARE * limit else INK
                page.text(left + (place + 0.5) * width, y, micrometres(value), fontsize=6.8, color=colour, ha="center", va="center", fontstyle="italic" if colour == MUTED else "normal", fontweight="bold" if over else "normal")  # fmt: skip
            page.text(
                right - 1.5 * width,
                y,
                micrometres(mean_seen(part.value[:, side])),
                fontsize=6.8,
                color=BLUE,
                ha="center",
                va="center",
            )
            page.text(right - 0.5 * width, y, micrometres(median_seen(part.expanded[:, side])), fontsize=6.8, color=MUTED, ha="center", va="center")  # fmt: skip


def _foot(page: Axes, inspection: Inspection) -> None:
    lines = [
        "Values in µm; U (k = 2, median of all flanks) from the scan's scatter, with what noise may add. Shaded band: ± U. Dashed red: least-squares line. Dashed green: ends of the evaluation range.",
        "Orange: a trace too large for the common magnification, drawn at its own. Grey italics: not resolvable (U over 30 % of the tolerance). Bold red: exceeds the required class.",
        "Formulas and ranges of ISO 1328-1 are from memory of the standard; see the report's footnote.",
    ]
    unseen = [note for note in inspection.notes if note.startswith("Not seen")]
    page.text(8, 13.0, "\n".join(lines + unseen[:1])[:900], fontsize=6, color=MUTED, va="top", linespacing=1.35)


def _own_scale(trace: Floats, scale: int, half: float) -> int:
    """The common magnification, or the largest that holds a trace too big for it."""
    size = np.abs(trace[np.isfinite(trace)])
    if not len(size) or scale * float(np.quantile(size, 0.97)) <= half:
        return scale
    return next((m for m in MAGNIFICATIONS if m < scale and m * float(size.max()) <= half), 1)


def _magnification(found: Evaluation, shown: list[int], width: float) -> int:
    """The largest round magnification at which four of five traces stay in their columns."""
    off = np.abs(found.filtered[shown] - found.line[shown][..., :1])
    known = np.isfinite(off).any(axis=-1)
    if not known.any():
        return 100
    reach = float(np.quantile(np.nanmax(off[known], axis=-1), 0.8))
    return next((m for m in MAGNIFICATIONS if m * reach <= 0.5 * width), 1)


def _limits(inspection: Inspection) -> Tolerances | None:
    """Tolerances of the required class, if one is required."""
    required = inspection.settings.required_class
    return None if required is None else tolerances(inspection.size, required, inspection.settings.edition)

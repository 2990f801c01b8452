"""Pitch, index and runout as bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.grading import Finding
from gearwear.inspection.inspection import PITCH_ABOUT, Inspection
from gearwear.inspection.pitch import Runout
from gearwear.report.charts.sheet import A4, SIDE_NAMES, SOURCES, WIDTH, headline, median_seen, micrometres, plain, sheet
from gearwear.report.charts.trace_table import required_tolerances
from gearwear.report.figures.colours import ALARM, BLUE, INK, MUTED, PAPER, RULE, TEAL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEIGHT = 35.0
"""Of the bars, mm of paper."""

COLUMNS = {Side.LEFT: (18.0, 142.0), Side.RIGHT: (165.0, 289.0)}
"""Where the left and the right flanks stand, mm of paper."""

ROWS = (141.0, 84.5, 26.5)
"""Lower edges of single pitch, index and runout, mm of paper."""

GROUND = {"boxstyle": "square,pad=0.05", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.8}
"""Under words that a line may cross."""

DIGIT, LINE = 1.52, 2.95
"""Width of a digit and height of a line of the bars' values, mm of paper."""


def pitch_chart(figure: Figure, inspection: Inspection) -> Figure:
    """Single pitch, index and runout as bars, left and right flanks apart, with U and class.

    Parameters
    ----------
    figure : Figure
        Drawn on; its size is set.
    inspection : Inspection
        What was found.

    Returns
    -------
    Figure
    """
    page = sheet(figure, A4)
    _head(page, inspection)
    pitch = inspection.pitch
    teeth = np.arange(inspection.gear.teeth, dtype=np.float64)
    limits = required_tolerances(inspection)
    for side in Side:
        name = SIDE_NAMES[side].lower()
        single = _axes(figure, ROWS[0], COLUMNS[side])
        limit = math.inf if limits is None else limits.single_pitch
        _bars(single, teeth, pitch.single.value[:, side.index], pitch.single.expanded[:, side.index], BLUE, COLUMNS[side], limit)
        _title(single, f"Single pitch · {name}", inspection, ("single_pitch", "adjacent_pitch"), side)
        index = _axes(figure, ROWS[1], COLUMNS[side])
        _bars(index, teeth, pitch.index.value[:, side.index], pitch.index.expanded[:, side.index], TEAL, COLUMNS[side])
        _title(index, f"Index · {name}", inspection, ("cumulative_pitch", "sector_pitch"), side)
    edges = (COLUMNS[Side.LEFT][0], COLUMNS[Side.RIGHT][1])
    axis = _axes(figure, ROWS[2], edges)
    if inspection.runout is None:
        axis.text(0.5, 0.5, "no ball fits this gear", transform=axis.transAxes, ha="center", color=MUTED)
    else:
        _runout(axis, inspection, inspection.runout, edges)
    return figure


def _head(page: Axes, inspection: Inspection) -> None:
    pitch, radius = inspection.pitch, math.hypot(inspection.gear.base_radius, inspection.pitch.roll)
    headline(page, "Pitch and runout", inspection, A4 - 9)
    page.text(WIDTH - 8, A4 - 9, str(inspection.settings.edition), fontsize=8, color=INK, ha="right", va="baseline")
    low, high = inspection.settings.pitch_band or inspection.profile.band
    line = f"measured at ⌀ {2 * radius:.3f} mm, mean of z {low:.2f} … {high:.2f} mm   ·   arc at the reference circle, + counter-clockwise seen from +z   ·   k = {pitch.sector} pitches of Fpk   ·   whiskers: U (k = 2)"
    page.text(8, A4 - 15, line, fontsize=7.5, color=INK, va="baseline")
    page.plot([8, WIDTH - 8], [A4 - 17.5] * 2, color=INK, lw=0.8)
    words = [
        "Values in µm, U (k = 2) from the scan's scatter. A bar with two strokes across goes on: its value stands at its end. Dashed, where near: ± tolerance of the required class.",
        *(note for note in inspection.notes if note.startswith(PITCH_ABOUT)),
        SOURCES,
    ]
    page.text(8, 13.5, "\n".join(words), fontsize=7, color=MUTED, va="top", linespacing=1.3)


def _axes(figure: Figure, bottom: float, edges: tuple[float, float]) -> Axes:
    left, right = edges
    return figure.add_axes((left / WIDTH, bottom / A4, (right - left) / WIDTH, HEIGHT / A4))


def _runout(axis: Axes, inspection: Inspection, balls: Runout, edges: tuple[float, float]) -> None:
    """A bar for the ball in every space, and the eccentricity that most of them share."""
    count, pitch_angle = inspection.gear.teeth, inspection.gear.pitch_angle
    place = np.arange(count, dtype=np.float64) + np.float64(0.5)
    _bars(axis, place, balls.radial.value, balls.radial.expanded, INK, edges)
    x, y = balls.eccentricity.value

    def wave(tooth: Floats) -> Floats:
        return np.asarray(x * np.cos(tooth * pitch_angle) + y * np.sin(tooth * pitch_angle), dtype=np.float64)

    level = median_seen(balls.radial.value - wave(place))
    round_it: Floats = np.linspace(-0.5, count, 400, dtype=np.float64)
    axis.plot(round_it + 1.0, 1e3 * (level + wave(round_it)), color=ALARM, lw=0.9)
    label = f"Radius over a ball of {balls.pins.diameter:.3f} mm in the spaces, less nominal"
    size = math.hypot(x, y)
    red = f" (red: eccentricity {micrometres(size)} µm)" if math.isfinite(size) else ""
    _title(axis, label + red, inspection, ("runout",), None)
    words = "tooth (a bar between two numbers is the space between those teeth)"
    axis.set_xlabel(words, fontsize=7, color=MUTED, labelpad=1.5)


def _bars(
    axis: Axes,
    place: Floats,
    value: Floats,
    expanded: Floats,
    colour: str,
    edges: tuple[float, float],
    limit: float = math.inf,
) -> None:
    """Bars in µm with whiskers and, beyond these, their values; a bar far longer than the others is broken; ± `limit` where near."""
    um, reach = 1e3 * value, 1e3 * expanded
    column = (edges[1] - edges[0]) / (len(um) + 1.0)
    upright = column < 5.2 * DIGIT
    few = column >= LINE - 0.3  # else only what stands out is labelled
    size = np.sort((np.abs(um) + reach)[np.isfinite(um)])
    usual = float(size[int(0.75 * (len(size) - 1))]) if len(size) else 1.0
    broken = np.abs(um) > 8.0 * usual
    kept = np.isfinite(um) & ~broken
    most = max(float(np.max(um[kept] + reach[kept], initial=0.0)), 0.25)
    least = min(float(np.min(um[kept] - reach[kept], initial=0.0)), -0.25)
    end = np.where(um > 0.0, 1.3 * max(most, -0.5 * least), 1.3 * min(least, -0.5 * most))
    drawn = np.where(broken, end, um)
    ends = drawn[broken]
    most, least = max(most, float(np.max(ends, initial=0.0))), min(least, float(np.min(ends, initial=0.0)))
    if 1e3 * limit <= 2.0 * max(most, -least):
        most, least = max(most, 1e3 * limit), min(least, -1e3 * limit)
        for level in (-1e3 * limit, 1e3 * limit):
            axis.axhline(level, color=ALARM, lw=0.7, ls=(0, (5, 3)), zorder=1.5)
    room = 1.8 + (max((len(micrometres(v)) for v in value), default=1) * DIGIT if upright else LINE)
    per_mm = (most - least) / (HEIGHT - 2.0 * room)
    axis.set_ylim(least - room * per_mm, most + room * per_mm)
    axis.bar(place + 1.0, drawn, width=0.72, color=colour, alpha=0.85, lw=0)
    axis.errorbar((place + 1.0)[kept], um[kept], reach[kept], fmt="none", ecolor=MUTED, elinewidth=0.7, capsize=1.5, capthick=0.6)
    standing = {int(i) for i in (np.argmax(um[kept]), np.argmin(um[kept]))} if kept.any() else set()
    marked = {int(np.flatnonzero(kept)[i]) for i in standing} | set(map(int, np.flatnonzero(broken)))
    for i, (x, y) in enumerate(zip(place + 1.0, um, strict=True)):
        if not math.isfinite(y):
            axis.text(
                x, 0.5, "not seen", fontsize=7, color=MUTED, rotation=90, ha="center", va="center",
                transform=axis.get_xaxis_transform(), bbox=GROUND,
            )  # fmt: skip
            continue
        if broken[i]:
            _break(axis, x, float(drawn[i]), per_mm)
        if few or i in marked:
            tip = float(drawn[i]) if broken[i] else y + math.copysign(float(reach[i]), y)
            axis.annotate(
                micrometres(float(value[i])), (x, tip), (0.0, math.copysign(2.6 if upright and few else 1.5, y)), textcoords="offset points", fontsize=7,
                rotation=90 if upright and few else 0, color=INK, fontweight="bold" if broken[i] else "normal",
                ha="center", va="bottom" if y >= 0.0 else "top",
                bbox=GROUND,
            )  # fmt: skip
    axis.axhline(0.0, color=INK, lw=0.7)
    axis.set_xlim(0.3, math.floor(place[-1]) + 1.9)
    step = next(s for s in (1, 2, 5, 10, 20, 50, 100, 200) if s * column >= 1.5 + DIGIT * len(str(len(place))) or s == 200)
    axis.set_xticks([float(i) for i in range(1, len(place) + 1) if step == 1 or i % step == 0 or (i == 1 and step > 3)])
    axis.tick_params(labelsize=7, length=2, colors=MUTED, labelcolor=INK, pad=2)
    axis.set_ylabel("µm", fontsize=7, color=MUTED)
    axis.grid(axis="y", color=RULE, lw=0.4)
    axis.set_axisbelow(True)
    for spine in ("top", "right"):
        axis.spines[spine].set_visible(False)


def _break(axis: Axes, x: float, end: float, per_mm: float) -> None:
    """Two strokes across a bar that is drawn shorter than it is."""
    for mm in (2.4, 3.4):
        y = end - math.copysign(mm * per_mm, end)
        axis.plot(
            [x - 0.46, x + 0.46], [y - 0.5 * per_mm, y + 0.5 * per_mm], color=PAPER, lw=1.6, solid_capstyle="butt", zorder=4
        )


def _title(axis: Axes, name: str, inspection: Inspection, quantities: tuple[str, ...], side: Side | None) -> None:
    by_quantity = {f.quantity: f for f in inspection.findings if f.side == side and f.quantity in quantities}
    axis.set_title(name, fontsize=8.5, fontweight="bold", color=INK, loc="left", pad=5 + 10 * len(quantities))
    words = "\n".join(_result(by_quantity[q]) for q in quantities if q in by_quantity)
    axis.text(0.0, 1.04, words, transform=axis.transAxes, fontsize=7, color=INK, linespacing=1.35)


def _result(finding: Finding) -> str:
    if math.isnan(finding.value):
        return f"{plain(finding.symbol)}: {finding.statement}"
    limit = finding.grade.tolerance
    against = "" if math.isnan(limit) else f" (tolerance {1e3 * limit:g})"
    where = "" if finding.tooth is None else f" at tooth {finding.tooth + 1}"
    value = f"{micrometres(finding.value)} µm{where}, U {micrometres(finding.expanded)}"
    return f"{plain(finding.symbol)} = {value}{against}: {finding.statement}"

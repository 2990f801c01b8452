"""Pitch, index and runout as bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.profiles import LEFT, RIGHT
from gearwear.measure.inspection.grading import Finding
from gearwear.measure.inspection.inspection import Inspection
from gearwear.report.charts.sheet import SIDE_NAMES, WIDTH, gear_words, median_seen, micrometres, nice, tex
from gearwear.report.colours import BLUE, INK, LOST, MUTED, PAPER, RULE, TEAL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
    figure.clear()
    figure.set_size_inches(WIDTH / 25.4, 200.0 / 25.4)
    figure.set_facecolor(PAPER)
    grid = figure.add_gridspec(3, 2, left=0.06, right=0.975, top=0.845, bottom=0.085, hspace=0.62, wspace=0.11)
    figure.text(8 / WIDTH, 0.95, "Pitch and runout", fontsize=15, fontweight="bold", color=INK)
    figure.text(66 / WIDTH, 0.95, gear_words(inspection), fontsize=8, color=INK)
    figure.text(1 - 8 / WIDTH, 0.95, str(inspection.settings.edition), fontsize=8, color=INK, ha="right")
    pitch, radius = inspection.pitch, math.hypot(inspection.gear.base_radius, inspection.pitch.roll)
    line = f"measured at ⌀ {2 * radius:.3f} mm, mean of z {inspection.profile.band[0]:.2f} … {inspection.profile.band[1]:.2f} mm   ·   arc at the reference circle, + counter-clockwise seen from +z   ·   whiskers: U (k = 2)"
    figure.text(8 / WIDTH, 0.917, line, fontsize=7.5, color=INK)
    teeth = np.arange(inspection.gear.teeth, dtype=np.float64)
    for side in (LEFT, RIGHT):
        single = figure.add_subplot(grid[0, side])
        _bars(single, teeth, pitch.single.value[:, side], pitch.single.expanded[:, side], BLUE)
        _title(single, f"Single pitch · {SIDE_NAMES[side].lower()}", inspection, ("single_pitch", "adjacent_pitch"), side)
        index = figure.add_subplot(grid[1, side])
        _bars(index, teeth, pitch.index.value[:, side], pitch.index.expanded[:, side], TEAL)
        _title(index, f"Index · {SIDE_NAMES[side].lower()}", inspection, ("cumulative_pitch", "sector_pitch"), side)
    balls = inspection.runout
    axis = figure.add_subplot(grid[2, :])
    if balls is None:
        axis.text(0.5, 0.5, "no ball fits this gear", transform=axis.transAxes, ha="center", color=MUTED)
    else:
        _bars(axis, np.asarray(teeth + 0.5, dtype=np.float64), balls.radial.value, balls.radial.expanded, INK)
        x, y = balls.eccentricity.value
        place = np.concatenate([teeth + 0.5, np.linspace(-0.5, inspection.gear.teeth - 0.2, 400)])
        wave = x * np.cos(place * inspection.gear.pitch_angle) + y * np.sin(place * inspection.gear.pitch_angle)
        level = median_seen(balls.radial.value - wave[: len(teeth)])
        axis.plot(place[len(teeth) :] + 1.0, 1e3 * (level + wave[len(teeth) :]), color=LOST, lw=0.9)
        label = f"Radius over a ball of {balls.pins.diameter:.3f} mm in the spaces, less nominal"
        _title(axis, f"{label} (eccentricity {1e3 * math.hypot(x, y):.1f} µm, red)", inspection, ("runout",), None)
    axis.set_xlabel("tooth (a bar between two numbers is the space between those teeth)", fontsize=7, color=MUTED)
    return figure


def _bars(axis: Axes, place: Floats, value: Floats, expanded: Floats, colour: str) -> None:
    """Bars in µm with whiskers; one far beyond the others is cut and its value written."""
    um, reach = 1e3 * value, 1e3 * expanded
    size = np.sort((np.abs(um) + reach)[np.isfinite(um)])
    most, usual = (float(size[-1]), float(size[int(0.75 * (len(size) - 1))])) if len(size) else (1.0, 1.0)
    limit = max(0.5, 1.15 * most if most <= 8.0 * usual else 3.0 * usual)
    axis.bar(place + 1.0, np.clip(um, -limit, limit), width=0.72, color=colour, alpha=0.85, lw=0)
    inside = np.abs(um) <= limit
    axis.errorbar(
        (place + 1.0)[inside], um[inside], reach[inside], fmt="none", ecolor=MUTED, elinewidth=0.7, capsize=1.5, capthick=0.6
    )
    for x, y in zip(place + 1.0, um, strict=True):
        if not math.isfinite(y):
            axis.text(x, 0.0, "not seen", fontsize=6, color=MUTED, rotation=90, ha="center", va="center")
        elif len(um) <= 48:
            _value(axis, x, y, limit, 90 if len(um) > 16 else 0)
    axis.axhline(0.0, color=INK, lw=0.7)
    axis.set_ylim(-limit, limit)
    axis.set_xlim(0.3, math.floor(place[-1]) + 1.9)
    step = 1 if len(place) <= 36 else nice(len(place) / 24)
    axis.set_xticks([1.0 + i for i in range(len(place)) if i % int(step) == 0])
    axis.tick_params(labelsize=6.5, length=2, colors=MUTED, labelcolor=INK)
    axis.set_ylabel("µm", fontsize=7, color=MUTED)
    axis.grid(axis="y", color=RULE, lw=0.4)
    axis.set_axisbelow(True)
    for spine in ("top", "right"):
        axis.spines[spine].set_visible(False)


def _value(axis: Axes, x: float, y: float, limit: float, rotation: int) -> None:
    """The number of a bar: across the zero line from it, or at its end inside it where the bar is cut."""
    up = y > 0.0
    cut = abs(y) > limit
    axis.annotate(
        micrometres(1e-3 * y),
        (x, math.copysign(0.97 * limit, y) if cut else 0.0),
        (0.0, 0.0 if cut else -1.5 if up else 1.5),
        textcoords="offset points",
        fontsize=6.2,
        rotation=rotation,
        color=PAPER if cut else INK,
        fontweight="bold" if cut else "normal",
        ha="center",
        va="top" if up else "bottom",
    )


def _title(axis: Axes, name: str, inspection: Inspection, quantities: tuple[str, ...], side: int | None) -> None:
    found = {f.quantity: f for f in inspection.findings if f.side == side and f.quantity in quantities}
    axis.set_title(name, fontsize=8.5, fontweight="bold", color=INK, loc="left", pad=5 + 10 * len(quantities))
    words = "\n".join(_result(found[q]) for q in quantities if q in found)
    axis.text(0.0, 1.03, words, transform=axis.transAxes, fontsize=7, color=INK, linespacing=1.35)


def _result(finding: Finding) -> str:
    if math.isnan(finding.value):
        return f"{tex(finding.symbol)}: {finding.statement}"
    limit = finding.grade.tolerance
    against = "" if math.isnan(limit) else f" (tolerance {1e3 * limit:g})"
    return f"{tex(finding.symbol)} = {micrometres(finding.value)} µm, U {micrometres(finding.expanded)}{against}: {finding.statement}"

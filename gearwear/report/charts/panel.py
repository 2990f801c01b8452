"""One row of trace columns on a sheet: where things stand on the paper, the ground, the axes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.inspection.evaluation import Evaluation
from gearwear.report.charts.sheet import SIDE_NAMES, nice, strokes
from gearwear.report.figures.colours import INK, MUTED, RULE, TEAL, UNSEEN

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GROUPS = {Side.LEFT: (20.0, 138.0), Side.RIGHT: (162.0, 280.0)}
"""Where the left and the right flanks stand on the paper, mm."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A row of traces, left flanks and right flanks; all lengths in mm of paper.

    Parameters
    ----------
    page : Axes
        The sheet.
    evaluation : Evaluation
        What is drawn.
    teeth : sequence of int
        0-based, from left to right.
    columns : int
        Columns for teeth in either group; two more hold the mean and U.
    bottom : float
        Of the traces.
    scale : int
        Magnification of deviations, paper : part.
    stretch : float
        Magnification along the trace.
    """

    page: Axes
    evaluation: Evaluation
    teeth: Sequence[int]
    columns: int
    bottom: float
    scale: int
    stretch: float

    @property
    def width(self) -> float:
        """Of one column."""
        left, right = GROUPS[Side.LEFT]
        return (right - left) / (self.columns + 2)

    @property
    def top(self) -> float:
        return float(self.y(self.evaluation.station[-1]))

    def x(self, side: Side, place: float) -> float:
        """Middle of a column."""
        return GROUPS[side][0] + (place + 0.5) * self.width

    def y(self, station: float | Floats) -> Floats:
        """Height of a place along the trace."""
        return np.asarray(self.bottom + self.stretch * (np.asarray(station) - self.evaluation.station[0]), dtype=np.float64)


def draw_ground(panel: Panel) -> None:
    """Names, tooth numbers, nominal lines and evaluation range of both groups."""
    page, traces = panel.page, panel.evaluation
    start, end = float(panel.y(traces.range.start)), float(panel.y(traces.range.end))
    for side in Side:
        left, right = GROUPS[side]
        for low, high in ((end, panel.top), (panel.bottom, start)):
            page.fill_between([left, right], low, high, color=RULE, alpha=0.45, lw=0)
        page.plot(
            [left, right, right, left, left],
            [panel.bottom, panel.bottom, panel.top, panel.top, panel.bottom],
            color=MUTED,
            lw=0.5,
        )
        for y in (start, end):
            page.plot([left, right], [y, y], color=TEAL, lw=0.7, ls=(0, (6, 3)))
        page.text(
            0.5 * (left + right), panel.top + 5.0, SIDE_NAMES[side], fontsize=8.5, fontweight="bold", color=INK, ha="center"
        )
        for place, tooth in enumerate(panel.teeth):
            x = panel.x(side, place)
            page.text(x, panel.top + 1.2, str(tooth + 1), fontsize=7, color=INK, ha="center")
        middles = [panel.x(side, place) for place in range(len(panel.teeth))]
        strokes(page, [((x, panel.bottom), (x, panel.top)) for x in middles], UNSEEN, 0.4)
        page.text(panel.x(side, panel.columns), panel.top + 1.2, "mean", fontsize=7, color=MUTED, ha="center")


def draw_axes(panel: Panel, gear: Gear) -> None:
    """Roll length, roll angle and diameter of a profile beside the groups, or z of a helix; and the scale bar between them."""
    low, high = float(panel.evaluation.station[0]), float(panel.evaluation.station[-1])
    step = nice(12.0 / panel.stretch)
    places = [float(v) for v in np.arange(math.ceil(low / step) * step, high + 1e-9, step)]
    if panel.evaluation.along == "roll":
        degrees = math.degrees(1.0 / gear.base_radius)
        turn = nice(12.0 / panel.stretch * degrees)
        angles = np.arange(math.ceil(low * degrees / turn) * turn, high * degrees + 1e-9, turn)
        _ticks(panel, GROUPS[Side.LEFT][0], -1.0, "L mm", places, lambda v: f"{abs(v):g}")  # a ring's run the other way
        _ticks(
            panel,
            GROUPS[Side.RIGHT][0],
            -1.0,
            "roll °",
            [float(v) / degrees for v in angles],
            lambda v: f"{abs(v) * degrees:.4g}",
        )
        _ticks(panel, GROUPS[Side.RIGHT][1], 1.0, "⌀ mm", places, lambda v: f"{2.0 * math.hypot(gear.base_radius, v):.2f}")
    else:
        for side in Side:
            _ticks(panel, GROUPS[side][side.index], -float(side), "z mm", places, lambda v: f"{v:g}")
    _scale_bar(panel)


def _ticks(panel: Panel, x: float, sign: float, name: str, places: Sequence[float], label: Callable[[float], str]) -> None:
    """Ticks at an upright edge, labelled on the side of `sign`."""
    align = "left" if sign > 0.0 else "right"
    for value in places:
        y = float(panel.y(value))
        panel.page.text(x + 1.8 * sign, y, label(value), fontsize=7, color=INK, ha=align, va="center")
    heights = [float(panel.y(value)) for value in places]
    strokes(panel.page, [((x, y), (x + 1.2 * sign, y)) for y in heights], MUTED, 0.5)
    panel.page.text(x + 1.8 * sign, panel.top + 1.5, name, fontsize=7, color=MUTED, ha=align)


def _scale_bar(panel: Panel) -> None:
    """A bar between the groups that is a round number of micrometres long."""
    um = nice(8.0e3 / panel.scale)
    half, x = 0.5e-3 * um * panel.scale, GROUPS[Side.LEFT][1] + 7.5
    y = 0.5 * (panel.bottom + panel.top)
    panel.page.plot([x - half, x + half], [y, y], color=INK, lw=1.0, marker="|", ms=5)
    panel.page.text(x, y + 2.2, f"{um:g} µm", fontsize=7.5, color=INK, ha="center")
    panel.page.text(x, y - 4.2, f"{panel.scale}:1", fontsize=7.5, color=INK, ha="center")

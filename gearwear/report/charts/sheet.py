"""What all charts share: the sheet, the words on it, and how numbers are written."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.inspection import Inspection
from gearwear.report.figures.colours import INK, PAPER

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 297.0
"""Paper width, mm."""

A4 = 210.0
"""Height of a page of that width, mm."""

SOURCES = "ISO 1328-1: what its formulas, ranges and filter were compared with, and what is unconfirmed, is in inspection.json."
"""Said on every chart that holds a tolerance or a range of the standard."""

SIDE_NAMES = {side: f"{side} flanks".capitalize() for side in Side}

MAGNIFICATIONS = tuple(m * 10**e for e in (3, 2, 1, 0) for m in (5, 2, 1))
"""Of deviations, paper : part, falling."""


def sheet(figure: Figure, height: float) -> Axes:
    """An axis over the whole sheet whose unit is a millimetre of paper."""
    figure.clear()
    figure.set_size_inches(WIDTH / 25.4, height / 25.4)
    figure.set_facecolor(PAPER)
    page = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    page.set_xlim(0.0, WIDTH)
    page.set_ylim(0.0, height)
    page.set_axis_off()
    return page


def strokes(page: Axes, lines: Sequence[tuple[tuple[float, float], tuple[float, float]]], colour: str, width: float) -> None:
    """Straight lines as one artist, mm of paper: one by one they take longer than the traces."""
    from matplotlib.collections import LineCollection

    page.add_collection(LineCollection(list(lines), colors=colour, linewidths=width), autolim=False)


def headline(page: Axes, title: str, inspection: Inspection, height: float) -> None:
    """The title of a sheet at a height in mm of paper, and beside it the gear."""
    gear = inspection.gear
    spec = gear.spec
    helix = f"   β = {abs(math.degrees(spec.helix_angle)):g}° {spec.hand}" if spec.helix_angle else ""
    shift = f"   x = {spec.profile_shift:g}" if spec.profile_shift else ""
    words = (
        f"z = {gear.teeth}   m{'n' if helix else ''} = {spec.normal_module:g} mm   α = {math.degrees(spec.normal_pressure_angle):g}°{helix}{shift}"
        f"   d = {2 * gear.reference_radius:.3f} mm   db = {2 * gear.base_radius:.3f} mm   b = {spec.face_width:g} mm"
    )
    name = page.text(8, height, title, fontsize=15, fontweight="bold", color=INK, va="baseline")
    page.annotate(words, (1.0, 0.0), (14, 0), xycoords=name, textcoords="offset points", fontsize=8, color=INK, va="bottom")


def plain(symbol: str) -> str:
    """A symbol such as f_Hα as machines print it: fHα. Set by mathtext, the few symbols took a tenth of all charts' time."""
    return symbol.replace("_", "")


def micrometres(value: float) -> str:
    """µm with three digits that mean something; a dash where not seen."""
    if not math.isfinite(value):
        return "–"
    um = round(1e3 * value, 1) + 0.0  # no −0.0
    return (f"{um:.0f}" if abs(um) >= 100.0 else f"{um:.1f}").replace("-", "−")


def nice(value: float) -> float:
    """The nearest of 1, 2, 5 × 10ⁿ below `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(m for m in (1.0, 2.0, 5.0) if m * power <= value * (1 + 1e-9)) * power


def mean_seen(values: Floats) -> float:
    seen = values[np.isfinite(values)]
    return float(seen.mean()) if len(seen) else math.nan


def median_seen(values: Floats) -> float:
    seen = values[np.isfinite(values)]
    return float(np.median(seen)) if len(seen) else math.nan

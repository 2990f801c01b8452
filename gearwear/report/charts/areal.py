"""Flanks as surfaces: the mean flank, slopes and twist of every flank, orders over all teeth, and rolling with a master."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.composite import Composite
from gearwear.inspection.inspection import Inspection
from gearwear.inspection.laboratory import Laboratory
from gearwear.inspection.radial import STANDARD as RADIAL_STANDARD
from gearwear.inspection.waviness import Waviness
from gearwear.report.charts.sheet import A4, SIDE_NAMES, WIDTH, headline, micrometres, plain, sheet
from gearwear.report.figures.colours import BLUE, INK, MUTED, ORANGE, RULE, TEAL, UNSEEN, ColourScale, colour_scale
from gearwear.report.figures.maps import colours, usual_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = {Side.LEFT: (20.0, 137.0), Side.RIGHT: (164.0, 281.0)}
"""Where the left and the right flanks stand, mm of paper."""

ROWS = ((147.0, 35.0), (98.0, 33.0), (55.0, 28.0), (14.0, 24.0))
"""Lower edge and height of mean flank, parameters, orders and composite deviation, mm of paper."""

PARAMETERS = (
    ("profile_slope", "profile slope", BLUE, "o"),
    ("helix_slope", "helix slope", ORANGE, "s"),
    ("twist", "twist", TEAL, "^"),
)
"""Drawn over the teeth: name, words, colour, mark."""

FAR_ROOM = 0.3
"""Of the height that the many take: room beyond them for the values of flanks far off, up to three a tooth."""


def areal_chart(figure: Figure, inspection: Inspection, examined: Laboratory) -> Figure:
    """Mean flank, areal parameters, spectrum and tight centre distance on one sheet.

    Parameters
    ----------
    figure : Figure
        Drawn on; its size is set.
    inspection : Inspection
        For the words on the gear.
    examined : Laboratory
        What is drawn.

    Returns
    -------
    Figure
    """
    page, areal = sheet(figure, A4), examined.areal
    headline(page, "Surfaces", inspection, A4 - 9)
    roll, z = areal.cell_size
    words = (
        f"deviation along the transverse base tangent, + is more material   ·   cells {roll:.2f} × {z:.2f} mm   ·   points {examined.spacing:.3f} mm"
        " apart on the mean   ·   bars: U (k = 2)   ·   hollow: off the scale, with its value"
    )
    page.text(8, A4 - 15, words, fontsize=7.5, color=INK, va="baseline")
    page.plot([8, WIDTH - 8], [A4 - 17.5] * 2, color=INK, lw=0.8)
    scale = colour_scale(1e3 * areal.mean_flank, floor_um=2.0)
    for side in Side:
        _mean_flank(_axes(figure, 0, COLUMNS[side]), examined, side, scale)
        _over_teeth(_axes(figure, 1, COLUMNS[side]), examined, side)
        _orders(_axes(figure, 2, COLUMNS[side]), examined.waviness, side)
    _bar(figure, scale)
    edges = (COLUMNS[Side.LEFT][0], COLUMNS[Side.RIGHT][1])
    axis = _axes(figure, 3, edges)
    if examined.composite is None:
        axis.text(
            0.5,
            0.5,
            "not rolled: a flank was not seen, or the involute is shorter than a base pitch",
            transform=axis.transAxes,
            ha="center",
            fontsize=8,
            color=MUTED,
        )
    else:
        _composite(axis, examined.composite, inspection)
    return figure


def _axes(figure: Figure, row: int, edges: tuple[float, float]) -> Axes:
    low, height = ROWS[row]
    axis = figure.add_axes((edges[0] / WIDTH, low / A4, (edges[1] - edges[0]) / WIDTH, height / A4))
    axis.tick_params(labelsize=7, colors=INK, length=2)
    for spine in axis.spines.values():
        spine.set_color(RULE)
    return axis


def _title(axis: Axes, words: str) -> None:
    axis.set_title(words, fontsize=8, fontweight="bold", color=INK, loc="left", pad=3)


def _mean_flank(axis: Axes, examined: Laboratory, side: Side, scale: ColourScale) -> None:
    areal = examined.areal
    shown = np.ma.masked_invalid(0.5 + 0.5 * scale.fraction(1e3 * areal.mean_flank[side.index]))
    where, face = areal.profile_range, areal.helix_range
    axis.set_facecolor(UNSEEN)
    axis.imshow(
        shown,
        origin="lower",
        aspect="auto",
        extent=(*where.ends, *face.ends),
        cmap=colours(),
        vmin=0.0,
        vmax=1.0,
    )
    axis.xaxis.set_major_formatter(lambda place, _: f"{abs(place):g}")  # a ring's run the other way
    axis.set_ylabel("z, mm", fontsize=7, color=INK)
    axis.text(1.0, -0.14, "L, mm  (root → tip)", transform=axis.transAxes, fontsize=7, color=MUTED, ha="right", va="top")
    mean = areal.mean.twist.at(side.index)
    _title(axis, f"Mean of {SIDE_NAMES[side].lower()}, about their levels   ·   twist {micrometres(float(mean.value))} ± {micrometres(float(mean.expanded))} µm")  # fmt: skip


def _bar(figure: Figure, scale: ColourScale) -> None:
    low, height = ROWS[0]
    axis = figure.add_axes((285.0 / WIDTH, low / A4, 2.5 / WIDTH, height / A4))
    axis.imshow(np.linspace(0.0, 1.0, 120)[:, None], origin="lower", aspect="auto", extent=(0.0, 1.0, -1.0, 1.0), cmap=colours())
    axis.set_xticks([])
    axis.yaxis.tick_right()
    axis.set_yticks([float(scale.fraction(np.array(tick))) for tick in scale.ticks_um], scale.tick_labels)
    axis.tick_params(labelsize=7, length=2, pad=1)
    axis.text(1.6, -1.22, "µm", fontsize=7, color=INK, ha="center")


def _usual(values: Floats, bars: Floats) -> tuple[float, float]:
    """Ends of an axis, µm: set by the many and their bars, so that no single flank flattens the others."""
    known = values[np.isfinite(values)]
    if not len(known):
        return -1.0, 1.0
    low, high = usual_range(known)
    near = (values >= low) & (values <= high)
    low, high = min(0.0, float(np.min((values - bars)[near]))), max(0.0, float(np.max((values + bars)[near])))
    margin = max(0.06 * (high - low), 0.5)
    return low - margin, high + margin


def _over_teeth(axis: Axes, examined: Laboratory, side: Side) -> None:
    teeth = np.arange(1, len(examined.areal.lowest.value) + 1)
    parts = [examined.areal.flanks.named()[name] for name, *_ in PARAMETERS]
    values, bars = (1e3 * np.array([getattr(part, kind)[:, side.index] for part in parts]) for kind in ("value", "expanded"))
    low, high = _usual(values, bars)
    room = FAR_ROOM * (high - low)
    ends = low - room * bool((values < low).any()), high + room * bool((values > high).any())
    stacked = np.zeros((2, len(teeth)))
    for i, (_, words, colour, mark) in enumerate(PARAMETERS):
        place, far = teeth + 0.22 * (i - 1), (values[i] < low) | (values[i] > high)
        near = np.where(far, np.nan, values[i])
        axis.errorbar(place, near, bars[i], fmt=mark, ms=3.2, color=colour, elinewidth=0.8, capsize=1.5, label=words)
        for tooth in np.flatnonzero(far):  # beyond the many: one above the other, with their values
            up = values[i, tooth] > high
            at = (high, room) if up else (low, -room)
            y = at[0] + at[1] * (0.25 + 0.4 * stacked[int(up), tooth])
            stacked[int(up), tooth] += 1.0
            axis.plot(teeth[tooth] - 0.1, y, mark, ms=3.2, color=colour, mfc="white")
            told = micrometres(float(1e-3 * values[i, tooth]))
            axis.annotate(
                told, (teeth[tooth], y), xytext=(1, 0), textcoords="offset points", fontsize=7, color=colour, va="center"
            )
    axis.set_ylim(*ends)
    axis.axhline(0.0, color=MUTED, lw=0.5)
    axis.set_xlim(0.4, len(teeth) + 0.6)
    axis.set_xticks(teeth[:: max(1, math.ceil(len(teeth) / 20))])
    axis.set_ylabel("µm", fontsize=7, color=INK)
    axis.grid(axis="y", color=RULE, lw=0.4)
    axis.legend(
        fontsize=7, ncols=3, loc="lower right", bbox_to_anchor=(1.0, 0.97), frameon=False, handletextpad=0.1, columnspacing=1.0
    )
    _title(axis, f"By tooth · {SIDE_NAMES[side].lower()}")


def _orders(axis: Axes, waviness: Waviness, side: Side) -> None:
    amplitude, limit = 1e3 * waviness.amplitude[side.index], 1e3 * float(waviness.limit[side.index])
    _title(axis, f"Waves per revolution · {SIDE_NAMES[side].lower()}")
    if not np.isfinite(amplitude).any():
        axis.text(0.5, 0.5, "not seen", transform=axis.transAxes, ha="center", fontsize=8, color=MUTED)
        return
    common = waviness.orders % waviness.teeth == 0
    axis.vlines(waviness.orders[~common], 0.0, amplitude[~common], color=MUTED, lw=0.6)
    axis.vlines(waviness.orders[common], 0.0, amplitude[common], color=BLUE, lw=1.0, label="multiples of z")
    axis.axhline(limit, color=INK, lw=0.7, ls=(0, (4, 2)), label="stands out above")
    ghosts = [wave for wave in waviness.waves[side.index] if waviness.is_ghost(wave)]
    if ghosts:
        axis.plot(
            [wave.order for wave in ghosts],
            [1e3 * wave.amplitude for wave in ghosts],
            "D",
            ms=3.5,
            color=ORANGE,
            label="ghost orders",
        )
    for wave in waviness.waves[side.index][:3]:
        axis.annotate(
            str(wave.order), (wave.order, 1e3 * wave.amplitude), xytext=(2, -1), textcoords="offset points", fontsize=7, color=INK
        )
    axis.set_ylim(0.0, 1.25 * max(limit, float(np.nanmax(amplitude)), *(1e3 * wave.amplitude for wave in ghosts)))
    axis.set_ylabel("amplitude, µm", fontsize=7, color=INK)
    axis.text(1.0, -0.17, "order", transform=axis.transAxes, fontsize=7, color=MUTED, ha="right", va="top")
    axis.legend(
        fontsize=7, ncols=3, loc="lower right", bbox_to_anchor=(1.0, 0.97), frameon=False, handlelength=1.6, columnspacing=1.0
    )


def _composite(axis: Axes, composite: Composite, inspection: Inspection) -> None:
    turned: Floats = np.degrees(composite.rotation)
    axis.plot(turned, 1e3 * composite.double, color=INK, lw=0.9)
    axis.set_xlim(0.0, 360.0)
    axis.set_xticks(np.arange(0, 361, 30))
    axis.grid(color=RULE, lw=0.4)
    axis.set_ylabel("µm", fontsize=7, color=INK)
    axis.text(1.0, -0.2, "rotation of the gear, °", transform=axis.transAxes, fontsize=7, color=MUTED, ha="right", va="top")
    rolled = [
        f"{plain(finding.symbol)} {micrometres(finding.value)} ± {micrometres(finding.expanded)} µm, {finding.statement}"
        for finding in inspection.radial
    ]
    design = "the design without modifications" if inspection.gear.modified else "the design"
    _title(
        axis,
        f"Tight centre distance with a master of {composite.master_teeth} teeth, less that of {design} ({composite.centre_distance:.3f} mm)\n"
        f"{'   ·   '.join(rolled)}   ({RADIAL_STANDARD})",
    )

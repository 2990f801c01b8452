"""Topography of one tooth: a net over each flank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.inspection import Inspection
from gearwear.report.charts.sheet import A4, MAGNIFICATIONS, SIDE_NAMES, WIDTH, headline, sheet
from gearwear.report.figures.colours import INK, MUTED, UNSEEN, ColourScale, colour_scale
from gearwear.report.figures.maps import colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


DEPTH, LIFT = 110.0, 46.0
"""Most height of the face's width and of the deviations on the sheet, mm of paper."""


def topography_chart(figure: Figure, inspection: Inspection, tooth: int) -> Figure:
    """Topography of both flanks of a tooth: the flat design, and the measured net above it along the normal.

    Parameters
    ----------
    figure : Figure
        Drawn on; its size is set.
    inspection : Inspection
        What was found.
    tooth : int
        0-based.

    Returns
    -------
    Figure
    """
    from matplotlib.collections import LineCollection, PolyCollection

    surface, gear = inspection.topography, inspection.gear
    heights = surface.deviation[tooth]
    shades, scale = colours(), colour_scale(1e3 * heights)
    least, most = float(np.nanmin(heights, initial=0.0)), float(np.nanmax(heights, initial=0.0))
    lift = next((m for m in MAGNIFICATIONS if m * (most - least) <= LIFT), 1)
    top = A4 - 24.0
    free = top - 38.0 - lift * (most - least)
    depth = min(DEPTH, free)
    floor = 26.0 - lift * least + 0.5 * (free - depth)
    page = sheet(figure, A4)
    headline(page, f"Topography · tooth {tooth + 1}", inspection, top + 15)
    words = f"deviation {lift}:1, up is more material   ·   cells {surface.roll[1] - surface.roll[0]:.2f} × {surface.z[1] - surface.z[0]:.2f} mm (mean)   ·   grey: the design; gaps were not seen"
    page.text(8, top + 9.0, words, fontsize=7.5, color=INK)
    page.plot([8, WIDTH - 8], [A4 - 17.5] * 2, color=INK, lw=0.8)
    form, tip = (gear.orientation * roll for roll in (gear.form_roll, gear.tip_roll))  # places rise towards the tip
    along, lean, across = 84.0 / (tip - form), 28.0 / gear.face_width, depth / gear.face_width
    for side, x0 in ((Side.LEFT, 22.0), (Side.RIGHT, 164.0)):

        def place(roll: Floats, z: Floats, up: Floats, x0: float = x0) -> Floats:
            x = x0 + along * (roll - form) + lean * z
            return np.stack([x, floor + across * z + up], axis=-1)

        roll, z = np.meshgrid(surface.roll, surface.z)
        flat, net = place(roll, z, np.zeros_like(roll)), place(roll, z, lift * heights[side.index])
        page.add_collection(LineCollection([*flat[::4], *flat.swapaxes(0, 1)[::6]], colors=UNSEEN, linewidths=0.4, zorder=0.6))
        quads = np.stack([net[:-1, :-1], net[1:, :-1], net[1:, 1:], net[:-1, 1:]], axis=2).reshape(-1, 4, 2)
        means = (
            0.25
            * (
                heights[side.index][:-1, :-1]
                + heights[side.index][1:, :-1]
                + heights[side.index][1:, 1:]
                + heights[side.index][:-1, 1:]
            ).ravel()
        )
        seen = np.flatnonzero(np.isfinite(means))[::-1]  # from the far edge to the near one
        faces = shades(0.5 + 0.5 * scale.fraction(1e3 * means[seen]))
        page.add_collection(PolyCollection(list(quads[seen]), facecolors=faces, edgecolors=MUTED, linewidths=0.25))
        corners = place(
            np.array([form, tip, tip, form, form]),
            np.array([0.0, 0.0, 1.0, 1.0, 0.0]) * gear.face_width,
            np.zeros(5),
        )
        page.plot(*corners.T, color=INK, lw=0.6, zorder=0.5)
        if not len(seen):
            page.text(x0 + 56, floor + 0.5 * depth, "not seen", fontsize=8, color=MUTED, ha="center", va="center")
        page.text(x0 + 56, top - 1.0, SIDE_NAMES[side].removesuffix("s"), fontsize=9, fontweight="bold", color=INK, ha="center")
        for at, label, shift, align in ((0, "z = 0", (-1.5, 0), "right"), (3, f"z = {gear.face_width:g} mm", (-1.5, 0), "right")):
            page.text(corners[at, 0] + shift[0], corners[at, 1] + shift[1], label, fontsize=7, color=MUTED, ha=align, va="center")
        for at, label in ((2, f"tip, L = {gear.tip_roll:.2f} mm"), (3, f"form circle, L = {gear.form_roll:.2f} mm")):
            page.text(corners[at, 0], corners[at, 1] + lift * most + 2.5, label, fontsize=7, color=MUTED, ha="center")
    _colour_strip(page, shades(np.linspace(0, 1, 120)), scale)
    return figure


def _colour_strip(page: Axes, colours: Floats, scale: ColourScale) -> None:
    height = page.get_ylim()[1]
    page.imshow(colours[None], extent=(98.0, 198.0, 12.0, 15.0), aspect="auto")
    page.set_xlim(0.0, WIDTH)
    page.set_ylim(0.0, height)
    for tick, label in zip(scale.ticks_um, scale.tick_labels, strict=True):
        x = 148.0 + 50.0 * float(scale.fraction(np.array(tick)))
        page.text(x, 10.8, label, fontsize=7, color=INK, ha="center", va="top")
    page.text(201.0, 12.2, "µm", fontsize=7, color=INK)

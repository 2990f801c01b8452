"""A pair under load: transmission error loaded and rigid, the load over the flank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearwear.loaded.study import LoadedStudy
from gearwear.report.figures.colours import BLUE, MUTED, ORANGE
from gearwear.report.figures.given import check_axis, check_drawn
from gearwear.report.figures.legend import legend_above
from gearwear.report.figures.maps import shade_bar

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def loaded_transmission_error(axis: Axes, study: LoadedStudy) -> Axes:
    """Transmission error over the revolution: under load, rigid, and of the design under the same load."""
    check_axis(axis)
    check_drawn(LoadedStudy, study=study)
    present, design = study.present, study.design
    turn = np.degrees(present.rotation)
    pitches = len(present.rotation) // len(design.rotation)
    axis.plot(turn, np.tile(1e3 * design.transmission_error, pitches), color=MUTED, lw=0.9, label="design, loaded")
    axis.plot(turn, 1e3 * present.rigid_transmission_error, color=ORANGE, lw=0.9, ls=(0, (4, 2)), label="rigid")
    axis.plot(turn, 1e3 * present.transmission_error, color=BLUE, lw=1.1, label="loaded")
    axis.set(xlabel="rotation of the pinion, °", ylabel="transmission error, µm", xlim=(0.0, float(turn[-1] + turn[1])))
    axis.grid()
    legend_above(axis, 3)
    return axis


def mesh_spectrum(axis: Axes, study: LoadedStudy) -> Axes:
    """Amplitudes at multiples of the mesh frequency: rigid, loaded, and the design's under load."""
    check_axis(axis)
    check_drawn(LoadedStudy, study=study)
    series = (
        ("rigid", study.present.harmonics(rigid=True), ORANGE),
        ("loaded", study.present.harmonics(), BLUE),
        ("design, loaded", study.design.harmonics(), MUTED),
    )
    for i, (label, amplitude, colour) in enumerate(series):
        place = np.arange(1, len(amplitude) + 1) + 0.27 * (i - 1)
        axis.bar(place, 1e3 * amplitude, 0.25, color=colour, label=label)
    axis.set(xlabel="harmonic of the mesh", ylabel="amplitude, µm")
    axis.set_xticks(np.arange(1, len(series[0][1]) + 1))
    legend_above(axis, 3)
    return axis


def load_map(axis: Axes, study: LoadedStudy) -> Axes:
    """Greatest load per width over the pinion's flank, the mean of its teeth; root at the left, the upper end above."""
    check_axis(axis)
    check_drawn(LoadedStudy, study=study)
    flanks = study.present.load_map()
    half = 0.5 * study.present.widths
    low, high = flanks.z - half, flanks.z + half
    groove = 1 + np.flatnonzero(low[1:] - high[:-1] > 1e-3 * half[1:])  # between the halves of a double helical gear
    edges = np.concatenate([np.insert(low, groove, high[groove - 1]), high[-1:]])
    values = np.insert(flanks.values.mean(axis=0), groove, np.nan, axis=1)
    shown = axis.pcolormesh(flanks.roll_edges, edges, values.T, cmap="viridis", vmin=0.0, shading="flat")
    shade_bar(axis.inset_axes((1.04, 0.0, 0.04, 1.0)), "viridis", *shown.get_clim(), "load, N/mm")
    axis.set(xlabel="length of roll of the pinion, mm", ylabel="z, mm")
    return axis

"""How the pair ran: the wear over the flank as measured, by the law, and with the effects of running."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearwear.design.given import check_several
from gearwear.report.figures.given import check_axis, check_drawn
from gearwear.report.figures.maps import shade_bar
from gearwear.running.found import SecondLoop

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def wear_maps(axes: Sequence[Axes], loop: SecondLoop) -> None:
    """Mean depth over the flank, root at the left: measured, law and, where effects were found and there is an axis for it, run; one scale for all."""
    check_drawn(SecondLoop, loop=loop)
    for axis in check_several("axes", axes, "axes of matplotlib"):
        check_axis(axis, "one of axes")
    place = loop.map
    maps = [("measured", place.mean), ("wear law alone", loop.law), ("with the effects", loop.depth)][: len(axes)]
    top = 1e3 * max(float(values.max()) for _, values in maps)
    heights = np.linspace(0.0, place.gear.face_width, place.slices + 1)
    for axis, (title, values) in zip(axes, maps, strict=True):
        field = np.full(place.seen.shape, np.nan)
        field[place.seen] = 1e3 * values
        axis.pcolormesh(place.roll_edges, heights, field, cmap="viridis", vmin=0.0, vmax=top, shading="flat")
        axis.set(xlabel="length of roll, mm", title=title)
    axes[0].set_ylabel("z, mm")
    shade_bar(axes[-1].inset_axes((1.05, 0.0, 0.06, 1.0)), "viridis", 0.0, top, "depth, µm")

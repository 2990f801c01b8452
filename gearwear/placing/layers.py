"""Layers of a scan that lie apart: views that were put together before and do not fit, in one file that no longer tells which point is of which.

Where two layers lie on each other's place the points of a cell scatter by what they are apart, on flanks and on the lands between them alike. Rough wear
does so on flanks alone, a burr on tips alone.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, TIP
from gearwear.placing.cells import Cells

LOUD = 2.0
"""How many times as much as on a quiet quarter of the gear points scatter there: with a view that is out of scale up to 3.2 times on the flanks and 7 on
the tips of benchmarks/families, without one, and on 17 real gears, on fewer than a tenth of the teeth."""
LEAST_SHARE = 0.1
"""Share of the teeth on which they do, on a flank and on the tip: one tooth may be damaged."""
FEWEST = 3
"""Points that tell their scatter; numerical."""


def layers_apart(cells: Cells) -> Bools:
    """Teeth with a flank on which layers of the scan lie apart, (teeth,); none where tips do not show it too.

    Parameters
    ----------
    cells : Cells
        As first binned: what goes up and down within a cell is in their scatter.
    """
    teeth, points = cells.grid.gear.teeth, cells.points
    known = np.where(cells.count >= FEWEST, cells.scatter, np.nan)

    def loud(places: list[Bools]) -> Bools:
        """On which of some places points scatter so many times as much as on a quiet quarter of them."""
        typical = np.array([_median(known[at]) for at in places])
        quiet = float(np.nanquantile(typical, 0.25)) if np.isfinite(typical).any() else np.inf
        return np.asarray(np.nan_to_num(typical) > LOUD * quiet, dtype=np.bool_)

    on_flank, on_tip = points.surface == FLANK, points.surface == TIP
    # Each side against its own: one of both may have been ground more finely.
    sides = [loud([on_flank & (points.tooth == tooth) & (points.side == side) for tooth in range(teeth)]) for side in Side]
    flanks: Bools = np.logical_or(*sides)
    tips = loud([on_tip & (points.tooth == tooth) for tooth in range(teeth)])
    return flanks if float((flanks & tips).mean()) >= LEAST_SHARE else np.zeros(teeth, dtype=np.bool_)


def _median(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else np.nan


def said_of_layers(cells: Cells, apart: Bools) -> tuple[str, ...]:
    """A sentence where layers lie apart on some teeth, (teeth,)."""
    if not apart.any():
        return ()
    known = np.where((cells.points.surface == FLANK) & (cells.count >= FEWEST), cells.scatter, np.nan)
    there = apart[cells.points.tooth]
    here, elsewhere = (1e3 * _median(known[at]) for at in (there, ~there))
    return (
        f"on {int(apart.sum())} of {len(apart)} teeth points scatter by {here:.0f} µm within a cell, on the others by {elsewhere:.0f} µm: "
        "views that do not lie on each other were put together in this scan, and what is missing on those teeth may be that",
    )

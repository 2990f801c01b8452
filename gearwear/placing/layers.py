"""Layers of a scan that lie apart: views that were put together before and do not fit, in one file that no longer tells which point is of which.

Where two layers lie on each other's place the points of a cell scatter by what they are apart, on flanks and on the lands between them alike. Rough wear
does so on flanks alone, a burr on tips alone.
"""

from __future__ import annotations

import math

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.design.surface import TIP
from gearwear.placing.cells import Cells

LOUD = 2.0
"""How many times as much as on a quiet quarter of the gear points scatter there: with a view that is out of scale up to 3.2 times on the flanks and 7 on
the tips of benchmarks/families, without one, and on 17 real gears, on fewer than a tenth of the teeth."""
UNEASY = 1.25
"""The same from which on views may lie apart a little: in one file made of views 5 to 30 µm out of place on 16 of 20 teeth in a hundred and more, in 28 scans of
one view on none."""
LEAST_SHARE = 0.1
"""Share of the teeth on which they do, on a flank and on the tip: one tooth may be damaged."""
FEWEST = 3
"""Points that tell their scatter; numerical."""


def layers_apart(cells: Cells, loud: float = LOUD) -> Bools:
    """Teeth with a flank on which layers of the scan lie apart, (teeth,); none where tips do not show it too.

    Parameters
    ----------
    cells : Cells
        As first binned: what goes up and down within a cell is in their scatter.
    loud : float
        How many times as much as on a quiet quarter points scatter there; `UNEASY` where they may lie apart.
    """
    grid, known = cells.grid, _known_scatter(cells)
    teeth = grid.gear.teeth
    start, size = grid.blocks[TIP]
    # Each side against its own: one of both may have been ground more finely.
    flanks: Bools = np.logical_or(*(_loud(grid.flank_shape(known)[:, side.index].reshape(teeth, -1), loud) for side in Side))
    tips = _loud(known[start : start + size].reshape(teeth, -1), loud)
    tips &= _told(cells.count[start : start + size].reshape(teeth, -1), loud)  # of all surfaces these have the fewest points
    return flanks if float((flanks & tips).mean()) >= LEAST_SHARE else np.zeros(teeth, dtype=np.bool_)


def how_far_apart(cells: Cells) -> float:
    """How far layers that may lie apart (`UNEASY`) lie from their mean, root mean square, mm; 0 where there are none.

    What points of a cell scatter on the flanks of these teeth beyond a quiet quarter of them, the median.
    """
    grid, known, apart = cells.grid, _known_scatter(cells), layers_apart(cells, UNEASY)
    beyond = list[float]()
    for side in Side if apart.any() else ():
        typical, quiet = _typical(grid.flank_shape(known)[:, side.index].reshape(grid.gear.teeth, -1))
        own = typical[apart & (typical > UNEASY * quiet)]
        beyond += (own**2 - quiet**2).tolist()
    return math.sqrt(float(np.median(beyond))) if beyond else 0.0


def said_of_layers(cells: Cells, apart: Bools) -> tuple[str, ...]:
    """A sentence where layers lie apart on some teeth, (teeth,)."""
    if not apart.any():
        return ()
    flanks = cells.grid.flank_shape(_known_scatter(cells))
    here = 1e3 * float(np.nanmedian(flanks[apart]))
    others = "" if apart.all() else f", on the others by {1e3 * float(np.nanmedian(flanks[~apart])):.0f} µm"
    return (
        f"on {int(apart.sum())} of {len(apart)} teeth points scatter by {here:.0f} µm within a cell{others}: "
        "views that do not lie on each other were put together in this scan, and what is missing on those teeth may be that",
    )


def _known_scatter(cells: Cells) -> Floats:
    """Scatter of the cells with points enough, (m,) mm; nan in the others."""
    return np.where(cells.count >= FEWEST, cells.scatter, np.nan)


def _told(count: Floats, loud: float) -> Bools:
    """On which teeth points enough tell such a ratio from chance, by the points (teeth, n) of their cells: a median of scatters from so many points
    beyond one a cell is known to 1.25 / √(2 free), and two of that are less: flanks and tips of several teeth must say the same."""
    free = np.where(count >= FEWEST, count - 1.0, 0.0).sum(axis=1)
    return np.asarray(2.0 * 1.25 / np.sqrt(2.0 * np.maximum(free, 1.0)) < loud - 1.0)


def _loud(scatter: Floats, loud: float) -> Bools:
    """On which teeth points scatter so many times as much as on a quiet quarter of them, by the cells of each, (teeth, n)."""
    typical, quiet = _typical(scatter)
    return np.asarray(typical > loud * quiet, dtype=np.bool_)


def _typical(scatter: Floats) -> tuple[Floats, float]:
    """Typical scatter of the cells of each tooth, from (teeth, n), nan where none is known, and that of a quiet quarter of the teeth."""
    seen, typical = np.isfinite(scatter).any(axis=1), np.full(len(scatter), np.nan)
    if not seen.any():
        return typical, math.nan
    typical[seen] = np.nanmedian(scatter[seen], axis=1)
    return typical, float(np.quantile(typical[seen], 0.25))

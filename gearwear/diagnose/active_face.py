"""The stretch of the face over which the mate ran, where flanks that no mate touched stand beside it.

A pinion is mostly wider than its gear. What no mate touches does not wear: at one end or both of the worn flanks a strip stands as it was made, and ends at
a ledge. No cutter leaves one: heights of a made flank go smoothly along the face, as a polynomial does, and a polynomial follows no ledge. So each side is
asked by one cost, that of `worn_sides`, whether a stretch lies low beside smooth heights, or smoother ones explain them as well.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legvander

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells
from gearwear.robust import NORMAL_MAD

SMOOTH, SMOOTHER = 4, 10
"""Degree of what a flank has along the face beside a ledge, and up to which heights without one may have it; numerical."""
FEWEST_ROWS = 12
"""Rows of cells that show both; numerical."""
OF_MEDIAN = math.sqrt(0.5 * math.pi)
"""Standard deviation of a median of many values in that of their mean, for normal scatter."""
NONE = -1
"""For the row of a ledge, at an end without one; numerical."""


@dataclass(frozen=True, slots=True)
class ActiveFace:
    """Where the mate ran on the flanks of a side.

    Parameters
    ----------
    side : Side
    low, high : float
        Heights between which it ran, mm: those of the ends where flanks show no ledge there.
    """

    side: Side
    low: float
    high: float

    def worn(self, points: SurfacePoints, height: float) -> Bools:
        """Which points of its flanks and fillets, means over cells of a `height` in mm, have any part of the stretch in them, (n,)."""
        z = points.position[:, 2]
        within = (z > self.low - height) & (z < self.high + height)
        return np.asarray((points.side == int(self.side)) & within)

    def at_both_ends(self, gear: Gear) -> bool:
        """Whether flanks stand beside it at either end of the face."""
        return self.low > 0.0 and self.high < gear.face_width

    def margins(self, cells: Cells) -> Bools:
        """Cells of its flanks that lie beside the stretch, (m,)."""
        points = cells.points
        own = (points.surface == FLANK) & (points.side == int(self.side))
        return np.asarray(cells.seen & own & ~self.worn(points, cells.grid.row_height))


def active_faces(cells: Cells) -> tuple[ActiveFace, ...]:
    """Where the mate ran, of each side that shows it; none of a planar section or a double helical gear."""
    grid = cells.grid
    if grid.rows < FEWEST_ROWS or grid.groove_rows:
        return ()
    heights = _heights(cells)
    found = []
    for side in Side:
        stretch = _stretch(heights[:, side.index])
        if stretch is not None:
            low, high = (float(end) * grid.row_height for end in stretch)
            found.append(ActiveFace(side, low, high))
    return tuple(found)


def _heights(cells: Cells) -> Floats:
    """Mean height of each row of each flank over those of its side's columns, (teeth, 2, rows) mm; nan where less than half of a row was seen."""
    shape = cells.grid.flank_shape
    heights = np.where(shape(cells.seen), shape(cells.points.deviation), np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # rows and columns nobody saw
        heights = heights - np.nanmedian(heights, axis=(0, 2))[None, :, None, :]
        often = np.isfinite(heights).mean(axis=3) > rules().known_flank
        rows = np.where(often, np.nanmean(heights, axis=3), np.nan)
        return np.asarray(rows - np.nanmedian(rows, axis=2, keepdims=True))


def _stretch(heights: Floats) -> tuple[float, float] | None:
    """Between which places, in rows from the lower end, the flanks of a side lie low beside smooth heights, from those of each, (teeth, rows) mm; None
    where smooth ones explain them as well."""
    often = np.isfinite(heights).sum(axis=0)
    seen = np.flatnonzero(often >= max(rules().pattern_teeth, rules().known_flank * often.max(initial=0)))
    if len(seen) < FEWEST_ROWS:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        common = np.nanmedian(heights, axis=0)[seen]
        scatter = NORMAL_MAD * OF_MEDIAN * np.nanmedian(np.abs(heights[:, seen] - common), axis=0) / np.sqrt(often[seen])
    weight = 1.0 / np.maximum(scatter, 1e-3 * float(scatter.max()) + 1e-12) ** 2
    place = 2.0 * (seen + 0.5) / heights.shape[1] - 1.0
    smooth = legvander(place, min(SMOOTHER, len(seen) - 3))
    first, last = _ends(seen, heights.shape[1])
    within = (seen > first[:, None]) & (seen < last[:, None])
    told = weight * (seen != first[:, None]) * (seen != last[:, None])  # how far a row of a ledge is worn it alone tells
    fitted, misfit = _fitted(
        np.concatenate([np.broadcast_to(smooth[:, : SMOOTH + 1], (*within.shape, SMOOTH + 1)), -1.0 * within[..., None]], axis=2),
        told,
        common,
    )
    misfit[fitted[:, -1] <= 0.0] = math.inf  # a ledge up to the rest is none
    best = int(np.argmin(misfit))
    # What neither explains is the unit of both.
    ledges = int((first[best] >= 0) + (last[best] < heights.shape[1]))
    unit = max(float(misfit[best]) / max(len(seen) - SMOOTH - 2 - ledges, 1), 1.0)
    price = rules().parameter_penalty
    ledged = float(misfit[best]) / unit + price * (SMOOTH + 1.0 + ledges * (1.0 + rules().shape_price))
    without = min(
        float(_fitted(smooth[None, :, : degree + 1], weight[None], common)[1][0]) / unit + price * degree
        for degree in range(1, smooth.shape[1])
    )
    if not without - ledged > rules().effect_penalty + rules().close or not _on_most(
        heights[:, seen], within[best], told[best] > 0.0
    ):
        return None
    # A row in which a ledge lies is worn from there on.
    worn = np.clip((smooth[:, : SMOOTH + 1] @ fitted[best, :-1] - common) / fitted[best, -1], 0.0, 1.0)
    share = dict(zip(seen.tolist(), worn.tolist(), strict=True))
    low = 0.0 if first[best] < 0 else first[best] + 1.0 - share[int(first[best])]
    high = float(heights.shape[1]) if last[best] >= heights.shape[1] else last[best] + share[int(last[best])]
    return float(low), float(high)


def _ends(seen: Ints, rows: int) -> tuple[Ints, Ints]:
    """Rows in which ledges may lie, (k,) each: below and above a stretch; NONE and `rows` where there is none. They leave so much of the face that it shows."""
    margin = math.ceil(rules().margin_rows)
    first, last = (each.ravel() for each in np.meshgrid([NONE, *seen[margin:]], [*seen[:-margin], rows], indexing="ij"))
    some = (last - first > margin) & ((first >= 0) | (last < rows))
    return first[some], last[some]


def _fitted(columns: Floats, weight: Floats, target: Floats) -> tuple[Floats, Floats]:
    """Amplitudes of least squares, (k, p), and what they leave, (k,): of columns (k, n, p) at weights (k, n) to the target (n,)."""
    weighted = columns * weight[..., None]
    gram = np.einsum("knp,knq->kpq", weighted, columns)
    gram += 1e-12 * np.einsum("kpp->k", gram)[:, None, None] * np.eye(gram.shape[1])
    moment = weighted.transpose(0, 2, 1) @ target
    amplitudes = np.linalg.solve(gram, moment[..., None])[..., 0]
    return amplitudes, np.asarray((weight * target**2).sum(axis=1) - (amplitudes * moment).sum(axis=1))


def _on_most(heights: Floats, within: Bools, told: Bools) -> bool:
    """Whether a stretch of the rows, (rows,), lies low on nearly every flank, at least half as far as on most, (teeth, rows) mm, beside a line; by the rows that are `told`."""
    columns = np.column_stack([np.ones(len(within)), np.linspace(-1.0, 1.0, len(within)), -1.0 * within])
    lower = []
    for flank in heights:
        known = np.isfinite(flank) & told
        if known.mean() > rules().known_flank and np.ptp(columns[known, -1]) > 0.0:
            lower.append(float(np.linalg.lstsq(columns[known], flank[known])[0][-1]))
    less = np.array(lower) < 0.5 * np.median(lower) if lower else np.zeros(0)
    return len(lower) >= rules().pattern_teeth and float(less.mean()) <= rules().blank_flanks

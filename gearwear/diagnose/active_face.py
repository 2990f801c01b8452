"""The stretch of the face over which the mate ran, where flanks that no mate touched stand beside it.

A pinion is mostly wider than its gear. What no mate touches does not wear: at one end or both of the worn flanks a strip stands as it was made, and ends at
a ledge. No cutter leaves one: heights of a made flank go smoothly along the face, as a polynomial does, and a polynomial follows no ledge. So each side is
asked by one cost, that of `worn_sides`, whether a stretch lies low beside smooth heights, or smoother ones explain them as well. Where tips or bottom lands have
the same ledge, a scanner stitched there.
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
from gearwear.design.surface import FLANK, ROOT, TIP, SurfacePoints
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import Cells
from gearwear.robust import scale_about

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
    rows = {side: _Rows.of(heights[:, side.index]) for side in Side}
    found = {side: stretch for side, one in rows.items() if (stretch := one.stretch()) is not None}
    for side, one in rows.items():
        if side not in found and side.opposite in found:  # one mate ran on both
            known = one.stretch(found[side.opposite])
            found |= {} if known is None else {side: known}
    height, elsewhere = grid.row_height, [_Rows.of(heights) for heights in _untouched(cells)]
    return tuple(
        ActiveFace(side, one.low * height, one.high * height if one.last < grid.rows else grid.gear.face_width)
        for side, one in sorted(found.items(), reverse=True)
        if not any(rows.stretch(one) for rows in elsewhere)
    )


def _heights(cells: Cells) -> Floats:
    """Mean height of each row of each flank over those of its side's columns, (teeth, 2, rows) mm; nan where less than half of a row was seen."""
    shape = cells.grid.flank_shape
    heights = np.where(shape(cells.seen), shape(cells.points.deviation), np.nan)
    return np.stack([_row_means(heights[:, side.index]) for side in Side], axis=1)


def _untouched(cells: Cells) -> list[Floats]:
    """The same of tips and of bottom lands, (teeth, rows) mm each, which no mate touches: where they go up and down with the flanks, the scanner did it."""
    grid, deviation = cells.grid, np.where(cells.seen, cells.points.deviation, np.nan)
    blocks = (deviation[start : start + size] for start, size in (grid.blocks[surface] for surface in (TIP, ROOT)))
    return [_row_means(block.reshape(grid.gear.teeth, grid.rows, -1)) for block in blocks]


def _row_means(heights: Floats) -> Floats:
    """Mean of each row, (teeth, rows) mm, of heights (teeth, rows, columns) about those of their columns; nan where less than half of a row was seen."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # rows and columns nobody saw
        heights = heights - np.nanmedian(heights, axis=(0, 1))
        often = np.isfinite(heights).mean(axis=2) > rules().known_flank
        rows = np.where(often, np.nanmean(heights, axis=2), np.nan)
        return np.asarray(rows - np.nanmedian(rows, axis=1, keepdims=True))


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Rows in which ledges lie, `first` below and `last` above; and where in them, in rows from the lower end."""

    first: int
    last: int
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class _Rows:
    """The flanks of a side, row by row.

    Parameters
    ----------
    heights : (teeth, n) float
        Of the rows that were seen on most flanks, mm.
    common, weight : (n,) float
        Their median, mm, and how well it is known, 1 / mm²: all scatter alike.
    seen : (n,) int
        Which rows these are.
    count : int
        Rows in all.
    """

    heights: Floats
    common: Floats
    weight: Floats
    seen: Ints
    count: int

    @classmethod
    def of(cls, heights: Floats) -> _Rows:
        """From the heights of all rows of each flank, (teeth, rows) mm, nan where not seen."""
        often = np.isfinite(heights).sum(axis=0)
        seen = np.flatnonzero(often >= max(rules().pattern_teeth, rules().known_flank * often.max(initial=0)))
        heights, often, count = heights[:, seen], often[seen], heights.shape[1]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            common = np.nanmedian(heights, axis=0) if len(seen) else np.zeros(0)
        scatter = max(OF_MEDIAN * scale_about(heights - common), 1e-12)
        weight = often / scatter**2
        return cls(heights, common, weight, seen, count)

    def stretch(self, known: _Stretch | None = None) -> _Stretch | None:
        """Which stretch lies low beside smooth heights, any or a `known` one; None where smooth heights explain the flanks as well."""
        if len(self.seen) < FEWEST_ROWS:
            return None
        ends = self._ends() if known is None else (np.array([known.first]), np.array([known.last]))
        smooth: Floats = np.asarray(
            legvander(2.0 * (self.seen + 0.5) / self.count - 1.0, min(SMOOTHER, len(self.seen) // 2 - 1)), np.float64
        )
        fits = [self._beside(smooth[:, : degree + 1], *ends) for degree in range(1, SMOOTH + 1)]
        for fitted, misfit in fits:
            misfit[fitted[:, -1] <= 0.0] = math.inf  # a ledge up to the rest is none
        least = int(np.argmin(fits[-1][1]))
        if not math.isfinite(fits[-1][1][least]):
            return None
        # What neither explains is the unit of both.
        ledges = (ends[0] >= 0).astype(np.float64) + (ends[1] < self.count)
        unit = max(float(fits[-1][1][least]) / max(len(self.seen) - SMOOTH - 2 - float(ledges[least]), 1.0), 1.0)
        price, place = rules().parameter_penalty, rules().shape_price if known is None else 0.0
        costs = np.array(
            [misfit / unit + price * (degree + 1.0 + ledges * (1.0 + place)) for degree, (_, misfit) in enumerate(fits, 1)]
        )
        degree, best = np.unravel_index(int(np.argmin(costs)), costs.shape)
        plain = (
            _fitted(smooth[None, :, : n + 1], self.weight[None], self.common)[1][0] / unit + price * n
            for n in range(1, smooth.shape[1])
        )
        sure = rules().close + (rules().effect_penalty if known is None else 0.0)
        first, last = (int(end[best]) for end in ends)
        if not min(plain) - costs[degree, best] > sure or not self._on_most(first, last):
            return None
        # A row in which a ledge lies is worn from there on.
        amplitudes = fits[degree][0][best]
        worn = np.clip((smooth[:, : degree + 2] @ amplitudes[:-1] - self.common) / amplitudes[-1], 0.0, 1.0)
        low = first + 1.0 - float(worn[self.seen == first].sum()) if first >= 0 else 0.0
        return _Stretch(first, last, low, last + float(worn[self.seen == last].sum()))

    def _ends(self) -> tuple[Ints, Ints]:
        """Rows in which ledges may lie, (k,) each: below and above a stretch, NONE and `count` where there is none; beside them so many rows that they show."""
        margin, seen = rules().margin_rows, self.seen.tolist()
        first, last = (end.ravel() for end in np.meshgrid([NONE, *seen[margin:]], [*seen[:-margin], self.count], indexing="ij"))
        some = (last - first > rules().active_face * self.count) & ((first >= 0) | (last < self.count))
        return first[some], last[some]

    def _beside(self, smooth: Floats, first: Ints, last: Ints) -> tuple[Floats, Floats]:
        """`_fitted` of smooth heights and a stretch that lies low; how far a row of a ledge is worn it alone tells."""
        rows = self.seen
        within = (rows > first[:, None]) & (rows < last[:, None])
        told = self.weight * (rows != first[:, None]) * (rows != last[:, None])
        columns = np.concatenate([np.broadcast_to(smooth, (len(first), *smooth.shape)), -1.0 * within[..., None]], axis=2)
        return _fitted(columns, told, self.common)

    def _on_most(self, first: int, last: int) -> bool:
        """Whether a stretch lies low on nearly every flank, at least half as far as on most, beside a line."""
        within, told = (self.seen > first) & (self.seen < last), (self.seen != first) & (self.seen != last)
        columns = np.column_stack([np.ones(len(within)), np.linspace(-1.0, 1.0, len(within)), -1.0 * within])
        lower = []
        for flank in self.heights:
            known = np.isfinite(flank) & told
            if known.mean() > rules().known_flank and np.ptp(columns[known, -1]) > 0.0:
                lower.append(float(np.linalg.lstsq(columns[known], flank[known])[0][-1]))
        less = np.array(lower) < 0.5 * np.median(lower) if lower else np.zeros(0)
        return len(lower) >= rules().pattern_teeth and float(less.mean()) <= rules().blank_flanks


def _fitted(columns: Floats, weight: Floats, target: Floats) -> tuple[Floats, Floats]:
    """Amplitudes of least squares, (k, p), and what they leave, (k,): of columns (k, n, p) at weights (k, n) to the target (n,)."""
    weighted = columns * weight[..., None]
    gram = np.einsum("knp,knq->kpq", weighted, columns)
    gram += 1e-12 * np.einsum("kpp->k", gram)[:, None, None] * np.eye(gram.shape[1])
    moment = weighted.transpose(0, 2, 1) @ target
    amplitudes = np.linalg.solve(gram, moment[..., None])[..., 0]
    return amplitudes, np.asarray((weight * target**2).sum(axis=1) - (amplitudes * moment).sum(axis=1))

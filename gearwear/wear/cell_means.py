"""What the surface of a tooth side is made from: the means of its cells, without those that a surface must not bend to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import LEAST_SHARE, SideMaps, cell_offsets
from gearwear.robust import scale_about
from gearwear.wear.stiffness import AsStiff
from gearwear.wear.surface import FEWEST_SEEN, SideSurface

FEW, LONE = 3, 5.0
"""Points of a cell that cannot outvote a stray among them; scatters of points, or of the cells of a column, by which one may lie off what is round it."""

BESIDE = 2
"""Cells round one that must have been seen for the others not to count."""

At = tuple[int, int, slice, slice]
"""Tooth, side, rows and columns."""


@dataclass(frozen=True, slots=True)
class CellMeans:
    """Cells of all tooth sides, laid flat.

    Parameters
    ----------
    deviation : (teeth, 2, rows, columns) float
        Means as measured, mm.
    count : (teeth, 2, rows, columns) float
        Points in each cell.
    variance : (teeth, 2, rows, columns) float
        Of the means by noise and texture, mm².
    offset : (2, teeth, 2, rows, columns) float
        Where the points of a cell lie on average from its centre, along z and along the profile, in cells.
    held : (teeth, 2, rows, columns) bool
        Cells that tell of the surface.
    shown : (teeth, 2, rows, columns) bool
        Cells that were seen, and not as strays alone.
    """

    deviation: Floats
    count: Floats
    variance: Floats
    offset: Floats
    held: Bools
    shown: Bools

    @classmethod
    def of(cls, cells: Cells, sheets: SideMaps, filled: Floats, noise: float, loop: Loop | None, where: Ints) -> CellMeans:
        """Of a scan.

        Parameters
        ----------
        cells, sheets : Cells, SideMaps
            Deviations from the as-made gear, and the same laid flat.
        filled : (teeth, 2, rows, columns) float
            The same with the unseen cells filled, mm.
        noise : float
            Scatter of points, mm.
        loop : Loop or None
            What tells of the texture.
        where : (k, 2) int
            Tooth and side of those whose surface is wanted.
        """
        count, deviation = cells.grid.sides(cells.count), cells.grid.sides(cells.points.deviation)
        texture = 0.0 if loop is None else loop.covariance.texture
        variance = noise**2 / np.maximum(count, 1.0) + texture
        strays = _strays(filled, cells, noise)
        held = (count > 0) & ~strays
        for half in where:
            # A cell of one point counts, but where the others are many.
            here = held[tuple(half)]
            if here.any():
                here &= count[tuple(half)] >= LEAST_SHARE * float(np.median(count[tuple(half)][here]))
        return cls(deviation, count, variance, cell_offsets(cells), held, sheets.seen & ~strays)

    def surface(
        self, at: At, wide: Bools, about: SideSurface | None = None, fewest: int = FEWEST_SEEN, as_stiff: AsStiff | None = None
    ) -> SideSurface | None:
        """Of the cells `at`; `wide` of them, (rows, columns), say how stiff it is, where `as_stiff` does not. None where fewer than `fewest` hold
        points."""
        means = np.where(self.held[at], self.deviation[at], np.nan)
        return SideSurface.of(
            means, self.count[at], self.variance[at], self.offset[(slice(None), *at)], wide, about, fewest, as_stiff
        )


@dataclass(frozen=True, slots=True)
class CommonSurface:
    """The surface that the flanks of a side have in common, and the share of each flank in it, (teeth, rows, columns)."""

    surface: SideSurface
    share: Floats

    @classmethod
    def of(cls, means: CellMeans, half: int, part: slice, wide: Bools, as_stiff: AsStiff | None = None) -> CommonSurface | None:
        """Of all points of the columns `part` of side `half` within `wide` (teeth, 2, rows, columns), as if they lay on one; `as_stiff` as it is, where
        that is known. None where they are too few."""
        at = (slice(None), half, slice(None), part)
        number = np.where(means.held[at] & np.isfinite(means.deviation[at]) & wide[at], means.count[at], 0.0)
        whole = number.sum(axis=0)
        share = number / np.maximum(whole, 1e-300)
        mean = np.where(whole > 0.0, (share * np.nan_to_num(means.deviation[at])).sum(axis=0), np.nan)
        error = np.where(whole > 0.0, (share**2 * means.variance[at]).sum(axis=0), 1.0)
        place = (share * np.nan_to_num(means.offset[(slice(None), *at)])).sum(axis=1)
        surface = SideSurface.of(mean, whole, error, place, np.asarray(wide[at].any(axis=0)), as_stiff=as_stiff)
        return None if surface is None else cls(surface, share)


def _strays(filled: Floats, cells: Cells, noise: float) -> Bools:
    """Cells that a surface must not bend to, (teeth, 2, rows, columns): of one or two points, or of a few that do not agree, farther off the cells
    round them than these are from each other. Of so few nobody knows which are strays.

    Both are told beyond what the flanks of a side have in common, for where wear is steep the cells round a stray lie far apart; how far such cells
    scatter in a column is allowed to them.
    """
    count, deviation, scatter = (cells.grid.sides(values) for values in (cells.count, cells.points.deviation, cells.scatter))
    common = np.median(filled, axis=0)
    beyond, own = filled - common, np.where(count > 0, deviation, np.nan) - common
    beside = np.ones((1, 1, 3, 3), dtype=np.bool_)
    beside[..., 1, 1] = False
    # Of the cells round it those that were seen, where some were: the others are filled from the stray as well.
    some = ndimage.convolve((count > 0).astype(np.int8), beside.astype(np.int8), mode="constant") >= BESIDE
    low, high = (
        np.where(
            some,
            *(of(values, footprint=beside, mode="constant", cval=end) for values in (np.where(count > 0, own, end), beyond)),
        )
        for of, end in ((ndimage.minimum_filter, np.inf), (ndimage.maximum_filter, -np.inf))
    )
    usual = np.fmax(np.apply_along_axis(scale_about, 1, np.moveaxis(own, 0, 2).reshape(len(Side), -1, own.shape[3])), noise)
    off = np.fmax(low - own, own - high) > high - low + LONE * usual[:, None]
    apart = (count < FEW) | ((count <= FEW) & (np.nan_to_num(scatter) > LONE * noise))
    if cells.far is not None:  # where pits are known to be, lone points are none
        apart &= ~cells.grid.sides(cells.far.hung).any(axis=(2, 3), keepdims=True)
    return np.asarray((count > 0) & off & apart)

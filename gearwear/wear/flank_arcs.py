"""The worn flanks at the radius where thickness is measured, as surfaces along the face: they rest on the points of the whole flank.

How far a surface may be trusted hangs on what its cells scatter. Noise and texture are known of the scan; where wear is steep the profile bends
within a cell besides, and the mean of its few points hangs on where these happen to lie.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import infill, make_side_maps, rim
from gearwear.robust import scale_about
from gearwear.wear.cell_means import CellMeans, CommonSurface
from gearwear.wear.section_sums import SectionBand
from gearwear.wear.surface import at_places

ACROSS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
"""Places across the band, in its half widths; numerical."""
MANY = 0.25
"""Share of the flanks of a side that must be worn to tell what their cells scatter: of few it may be the form of one."""
BESIDE, EXPECTED = 1, 2.0
"""Columns beside that of the radius in which points tell that a flank was seen there, and cells with points that are to be expected for that."""


@dataclass(frozen=True, slots=True)
class FlankArcs:
    """Arcs drawn for a flank, mm: of all those in parts of the band together no more than is asked, and by their coefficients along the face, which are
    fewer than sections.

    Parameters
    ----------
    at_radius, over_band : (draws, n) float
        At the radius, and the mean of the parts of the band.
    expected : (1 + k, n_z) float
        Means over the draws, at the radius and in each part.
    at : (n_z, n) float
        What each coefficient weighs in each section.
    shared : (1 + k, n_z) float
        What flanks have in common, which is taken off.
    """

    at_radius: Floats
    over_band: Floats
    expected: Floats
    at: Floats
    shared: Floats

    @classmethod
    def of(cls, arcs: Floats, at: Floats) -> FlankArcs:
        """Of the coefficients of arcs at the radius and in parts of the band, (1 + k, draws, n)."""
        expected = arcs.mean(axis=1) @ at.T
        return cls(arcs[0].copy(), arcs[1:].mean(axis=0), expected, at, np.zeros_like(expected))

    def without(self, shared: Floats) -> FlankArcs:
        """The same less what flanks have in common, (1 + k, n_z)."""
        return replace(self, expected=self.expected - shared, shared=self.shared + shared)

    def drawn(self) -> tuple[Floats, Floats]:
        """In each section, (draws, n_z): at the radius, and over the band."""
        return self.at_radius @ self.at.T - self.shared[0], self.over_band @ self.at.T - self.shared[1:].mean(axis=0)


@dataclass(frozen=True, slots=True)
class WornArcs:
    """The flanks of worn teeth along the face, beyond what they were made with.

    Parameters
    ----------
    of : mapping
        From tooth and side to its arcs; of those that have a surface.
    seen : (teeth, 2, n_z) bool
        Sections in which a flank has points about the radius.
    worn : (teeth, 2) bool
        Flanks with wear.
    """

    of: Mapping[tuple[int, Side], FlankArcs]
    seen: Bools
    worn: Bools

    def flanks(self, tooth: int) -> list[FlankArcs]:
        """Those of a tooth that have a surface, left first."""
        return [self.of[tooth, side] for side in Side if (tooth, side) in self.of]

    def measurable(self) -> Bools:
        """(teeth, n_z) sections in which every worn flank of a tooth was seen."""
        return np.asarray((self.seen | ~self.worn[:, :, None]).all(axis=1))


def drawn(flanks: Sequence[FlankArcs]) -> Floats:
    """What surfaces drawn for the flanks of a tooth are off the expected ones at the radius, (draws, n_z) mm: both have the same random numbers, and
    turned these are independent."""
    off = [flank.drawn()[0] - flank.expected[0] for flank in flanks]
    return np.asarray(sum(np.roll(values, (len(values) // 4) * place, axis=0) for place, values in enumerate(off)))


def worn_arcs(
    cells: Cells, mask: Bools, worn: frozenset[Side], band: SectionBand, noise: float, loop: Loop | None
) -> WornArcs | None:
    """Of both flanks of the teeth that are worn; None where there is none.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    mask : (teeth, 2, rows, columns) bool
        Worn cells.
    worn : frozenset of Side
        Sides worn throughout.
    band : SectionBand
        Where thickness is measured.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        What tells of the texture.
    """
    grid, gear = cells.grid, cells.grid.gear
    teeth = np.flatnonzero(mask.any(axis=(1, 2, 3)))
    if not len(teeth):
        return None
    sheets = make_side_maps(cells)
    where = np.array([(tooth, side.index) for tooth in teeth for side in Side])
    means, flank, wide = CellMeans.of(cells, sheets, infill(sheets), noise, loop, where), slice(grid.fillet, None), rim(mask)
    means = replace(means, variance=_as_they_scatter(means, flank, mask))
    common = {side.index: CommonSurface.of(means, side.index, flank, wide) for side in worn}
    edges = gear.form_roll**2, gear.tip_roll**2
    # The radius itself, and the middles of equal parts of the band.
    low, high = sorted((gear.form_roll, gear.tip_roll))  # a ring's run the other way
    reaches = np.array([band.reach, *(band.reach + band.half * ACROSS)]).clip(low, high)
    columns, rows = grid.flank * (reaches**2 - edges[0]) / (edges[1] - edges[0]), grid.place_of(band.heights)
    found, at = dict[tuple[int, Side], FlankArcs](), at_places(grid.rows, rows)
    for tooth, side in product(teeth.tolist(), Side):
        about = common.get(side.index)
        surface = means.surface(
            (tooth, side.index, slice(None), flank), wide[tooth, side.index, :, flank], None if about is None else about.surface
        )
        if surface is not None:
            found[tooth, side] = FlankArcs.of(gear.arc_per_depth * surface.along(columns), at)
    row = np.clip(rows.astype(np.int64), 0, grid.rows - 1)
    seen = _seen(means.held[..., grid.fillet :], int(grid.flank_column(band.reach)))
    return WornArcs(found, seen[..., row], np.asarray(mask.any(axis=(2, 3))))


def _seen(held: Bools, column: int) -> Bools:
    """Rows in which flanks were seen about a column, (teeth, 2, rows), by the cells with points (teeth, 2, rows, columns): where the points of a flank
    lie apart, within as many rows as would have `EXPECTED` such cells."""
    about = held[..., max(column - BESIDE, 0) : column + BESIDE + 1]
    share = held.sum(axis=(2, 3)) / np.maximum(held.any(axis=3).sum(axis=2) * held.shape[3], 1)
    reach = np.ceil(0.5 * (EXPECTED / np.maximum(share * about.shape[3], 1e-9) - 1.0)).clip(0, held.shape[2]).astype(np.int64)
    result = np.any(about, axis=3)
    for tooth, half in np.argwhere(reach > 0):
        result[tooth, half] = ndimage.maximum_filter1d(result[tooth, half], 2 * int(reach[tooth, half]) + 1, mode="nearest")
    return np.asarray(result)


def _as_they_scatter(means: CellMeans, flank: slice, mask: Bools) -> Floats:
    """Variance of the means of cells, (teeth, 2, rows, columns) mm², with what those of worn flanks scatter along the face beyond noise.

    Where wear is steep the profile bends within a cell, and its mean hangs on where its few points happen to lie. By the second differences along
    the face, robustly over all cells of a column of the worn flanks of a side: what a few flanks have there is form.
    """
    variance = means.variance.copy()
    for side in Side:
        teeth = np.flatnonzero(mask[:, side.index].any(axis=(1, 2)))
        if len(teeth) < MANY * len(mask):
            continue
        at = (teeth, side.index, slice(None), flank)
        held = means.held[at]
        mean = np.where(held, means.deviation[at], np.nan)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            profile = np.nanmedian(mean, axis=1, keepdims=True)
        lean = np.gradient(profile, axis=2) if mean.shape[2] > 1 else np.zeros_like(profile)
        mean = mean - np.nan_to_num(lean) * means.offset[(1, *at)]
        bend = mean[:, :-2] - 2.0 * mean[:, 1:-1] + mean[:, 2:]
        known = variance[at]
        usual = bend / np.sqrt(known[:, :-2] + 4.0 * known[:, 1:-1] + known[:, 2:])
        beyond = np.array([scale_about(column.ravel()) for column in np.moveaxis(usual, 2, 0)])
        variance[at] *= np.fmax(beyond, 1.0) ** 2
    return variance

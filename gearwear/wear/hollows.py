"""Hollows that sections hide: how far the bottom of a worn flank lies below the mean over the band and the height that points are taken from.

The surface of a flank (`surface`) rests on all of its points, not on those next to the radius alone. Only how it runs along the face is asked of
it, of a side that is worn throughout beyond what its flanks have in common: its level there, next to the ridge that wear leaves at the pitch point,
is that of the sections.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import ndimage
from scipy.sparse import csr_array

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import infill, make_side_maps, rim
from gearwear.wear.cell_means import CellMeans, CommonSurface
from gearwear.wear.section_sums import SectionSums
from gearwear.wear.surface import at_places

ACROSS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
"""Places across the band, in its half widths; numerical."""


@dataclass(frozen=True, slots=True)
class Hollows:
    """Of some teeth, about each section.

    Parameters
    ----------
    teeth : (k,) int
        0-based.
    depth : (k, n_z) float
        By how much the least arc there, up to half way to the next place that is looked at, is less than what the points of the section have, mm.
    std : (k, n_z) float
        Its standard deviation, mm.
    spread : (k, 2, n_z) float
        Standard deviation of each flank's arc among these points, about their straight line, mm.
    """

    teeth: Ints
    depth: Floats
    std: Floats
    spread: Floats


def find_hollows(
    cells: Cells, mask: Bools, worn: frozenset[Side], pooled: Ints, sections: SectionSums, made: Floats, noise: float, loop: Loop | None
) -> Hollows | None:  # fmt: skip
    """Of the worn teeth.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    mask : (teeth, 2, rows, columns) bool
        Worn cells.
    worn : frozenset of Side
        Sides worn throughout.
    pooled : (teeth,) int
        Neighbouring sections whose points are taken together, odd.
    sections : SectionSums
        Their points.
    made : (teeth, n_z) float
        Arcs of the as-made gear, mm: crowned flanks are thinner towards the ends, too.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        What tells of the texture.

    Returns
    -------
    Hollows or None
        None where there is no such tooth. One with pits is left out: a surface that is smooth does not follow them.
    """
    grid = cells.grid
    pits = np.zeros(len(mask), dtype=np.bool_) if cells.far is None else grid.sides(cells.far.hung).any(axis=(1, 2, 3))
    teeth = np.flatnonzero(~pits & mask.any(axis=(1, 2, 3)))
    if not len(teeth):
        return None
    sheets = make_side_maps(cells)
    where = np.array([(tooth, side.index) for tooth in teeth for side in Side])
    means, flank, wide = CellMeans.of(cells, sheets, infill(sheets), noise, loop, where), slice(grid.fillet, None), rim(mask)
    common = {side.index: CommonSurface.of(means, side.index, flank, wide) for side in worn}
    gear, band, number = grid.gear, sections.band, sections.moments[0].reshape(grid.gear.teeth, 2, -1)
    edges = gear.form_roll**2, gear.tip_roll**2
    # The radius itself, and the middles of equal parts of the band.
    reaches = np.array([band.reach, *(band.reach + band.half * ACROSS)]).clip(gear.form_roll, gear.tip_roll)
    columns, rows = grid.flank * (reaches**2 - edges[0]) / (edges[1] - edges[0]), grid.place_of(band.heights)
    along, at = dict[tuple[int, Side], _Arcs](), at_places(grid.rows, rows)
    for tooth, side in product(teeth.tolist(), Side):
        about = common.get(side.index)
        surface = means.surface(
            (tooth, side.index, slice(None), flank), wide[tooth, side.index, :, flank], None if about is None else about.surface
        )
        if surface is not None:
            along[tooth, side] = _Arcs.of(gear.arc_per_depth * surface.along(columns), at)
    # No smooth surface follows the ridge at the pitch point, which is more or less sharp along the face; the flanks of a side have it in common.
    for side in worn:
        own = [tooth for tooth in teeth.tolist() if (tooth, side) in along]
        shared = np.median(np.stack([along[tooth, side].expected for tooth in own]), axis=0) if own else np.zeros(0)
        for tooth in own:
            along[tooth, side] = along[tooth, side].without(shared)
    known = [tooth for tooth in teeth.tolist() if all((tooth, side) in along for side in Side)]
    if not known:
        return None
    found = [_within([along[tooth, side] for side in Side], number[tooth], made[tooth], int(pooled[tooth])) for tooth in known]
    return Hollows(np.array(known), *(np.stack(values) for values in zip(*found, strict=True)))


@dataclass(frozen=True, slots=True)
class _Arcs:
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
    def of(cls, arcs: Floats, at: Floats) -> _Arcs:
        """Of the coefficients of arcs at the radius and in parts of the band, (1 + k, draws, n)."""
        expected = arcs.mean(axis=1) @ at.T
        return cls(arcs[0].copy(), arcs[1:].mean(axis=0), expected, at, np.zeros_like(expected))

    def without(self, shared: Floats) -> _Arcs:
        """The same less what flanks have in common, (1 + k, n_z)."""
        return replace(self, expected=self.expected - shared, shared=self.shared + shared)

    def drawn(self) -> tuple[Floats, Floats]:
        """In each section, (draws, n_z): at the radius, and over the band."""
        return self.at_radius @ self.at.T - self.shared[0], self.over_band @ self.at.T - self.shared[1:].mean(axis=0)


def _within(flanks: Sequence[_Arcs], number: Floats, made: Floats, width: int) -> tuple[Floats, Floats, Floats]:
    """Depth and its standard deviation, (n_z,), and spread of each flank, (2, n_z), of arcs drawn for the two flanks beyond those they were made with,
    (n_z,): at the radius, and in parts of the band. Sections have `number` (2, n_z) points."""
    arcs = [arc.drawn() for arc in flanks]
    (draws, n), half = arcs[0][0].shape, width // 2
    at = np.arange(n)[:, None] + np.arange(-half, half + 1)
    inside, at = (at >= 0) & (at < n), at.clip(0, n - 1)
    over_band, spread = [], []
    for arc, (_, over), points in zip(flanks, arcs, number, strict=True):
        share = inside * (points[at] + 1e-6)  # the mean is that of the points
        windows = csr_array(
            ((share / share.sum(axis=1, keepdims=True)).ravel(), at.ravel(), np.arange(n + 1) * at.shape[1]), (n, n)
        )

        def mean(values: Floats, windows: csr_array = windows) -> Floats:
            """Over each window of values (k, n_z)."""
            return np.asarray((windows @ values.T).T, dtype=np.float64)

        over_band.append(mean(over + 0.5 * made))
        drawn = arc.expected[1:]
        about = drawn - np.outer(ACROSS, ACROSS @ drawn) / (ACROSS @ ACROSS)  # the straight line is taken out
        spread.append(np.sqrt(np.maximum(mean(about**2).mean(axis=0) - mean(about).mean(axis=0) ** 2, 0.0)))
    # Windows side by side may leave a gap of up to half of one.
    reach = 2 * (half + (width - 1) // 4) + 1
    expected = sum(arc.expected[0] for arc in flanks) + made
    # Of the surface that is expected: the least of one that is drawn is lower by its luck.
    depth = sum(band.mean(axis=0) for band in over_band) - ndimage.minimum_filter1d(expected, reach, mode="nearest")
    # Both flanks have the same random numbers: turned, they are independent; either way, as neither flank comes first.
    quarter, variance, by_chance = draws // 4, np.zeros(n), np.zeros(n)
    for turned, still in ((0, 1), (1, 0)):
        at_radius, band = (
            np.roll(values[turned], quarter, axis=0) + values[still]
            for values in ([at_radius for at_radius, _ in arcs], over_band)
        )
        variance += 0.5 * (band - ndimage.minimum_filter1d(at_radius + made, reach, axis=1, mode="nearest")).var(axis=0)
        even = (band - band.mean(axis=0)) - ndimage.minimum_filter1d(
            at_radius - at_radius.mean(axis=0), reach, axis=1, mode="nearest"
        )
        by_chance += 0.5 * (even**2).mean(axis=0)
    # A flank that is even along the face has a lowest place too, by chance: what is hollow beyond that, as squares add. Where points lie lower than all that
    # there is about them, nothing was looked for.
    depth = np.where(depth > 0.0, np.sqrt(np.maximum(depth**2 - by_chance, 0.0)), depth)
    return depth, np.sqrt(variance), np.stack(spread)

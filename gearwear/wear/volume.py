"""Volumes of worn regions and how well they are known: of the surface that the cells of a side show (`surface`), with the errors of the cells
(`uncertainty`), and where the same sum scatters more on tooth sides without wear, what it scatters there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import LEAST_SHARE, SideMaps, cell_offsets
from gearwear.wear.surface import SideSurface
from gearwear.wear.uncertainty import edge_covariance, noise_covariance, region_weights, torn_beyond

DEEPEST_OVER = 0.5
"""Edge of the square, mm, over whose mean the deepest wear is stated."""
FEWEST_PLACEBOS, FEWEST_SIDES = 5, 3
"""Sides without wear from which on they are compared whole; sides with any unworn cells of a region from which on those say something."""


@dataclass(frozen=True, slots=True)
class Volumes:
    """Volumes of regions, each on one tooth side, in the order of their places.

    Parameters
    ----------
    value : (k,) float
        mm³.
    chance : (k, k) float
        Covariance by chance where nothing is worn, mm⁶.
    covariance : (k, k) float
        Their own: with what only wear has, steep places between the points and in holes.
    filled : (teeth, 2, rows, columns) float
        Deviations as measured, mm, with the surface where nothing was seen.
    deepest : (k, 2) float
        Greatest mean depth over `DEEPEST_OVER` on the flank as its surface has it, and the standard deviation of that, mm; nan without a surface.
    """

    value: Floats
    chance: Floats
    covariance: Floats
    filled: Floats
    deepest: Floats


@dataclass(frozen=True, slots=True)
class _Common:
    """The surface that the flanks of a side have in common, and the share of each flank in it, (teeth, rows, columns)."""

    surface: SideSurface
    share: Floats

    @classmethod
    def of(cls, deviation: Floats, count: Floats, variance: Floats, offset: Floats, wide: Bools) -> _Common | None:
        """Of all points of the flanks, (teeth, rows, columns), as if they lay on one; None where they are too few."""
        number = np.where(np.isfinite(deviation) & wide, count, 0.0)
        whole = number.sum(axis=0)
        share = number / np.maximum(whole, 1e-300)
        mean = np.where(whole > 0.0, (share * np.nan_to_num(deviation)).sum(axis=0), np.nan)
        error = np.where(whole > 0.0, (share**2 * variance).sum(axis=0), 1.0)
        place = (share * np.nan_to_num(offset)).sum(axis=1)
        surface = SideSurface.of(mean, whole, error, place, np.asarray(wide.any(axis=0)))
        return None if surface is None else cls(surface, share)


def region_volumes(
    cells: Cells,
    sheets: SideMaps,
    filled: Floats,
    mask: Bools,
    wide: Bools,
    noise: float,
    loop: Loop | None,
    worn: frozenset[Side] = frozenset(),
) -> Volumes:
    """Volumes of the sides with worn cells.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    sheets : SideMaps
        The same, laid flat.
    filled : (teeth, 2, rows, columns) float
        The same with the unseen cells filled (`infill`), mm.
    mask, wide : (teeth, 2, rows, columns) bool
        Worn cells; with the rim that is summed with them.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        Where the as-made gear comes from.
    worn : frozenset of Side
        Sides worn throughout. Their flanks are alike, so each bends about the surface that they have in common, not about a flat one: a flank of
        few points would read too shallow where wear is steep, and every flank of the side alike.
    """
    where, filled = np.argwhere(mask.any(axis=(2, 3))), filled.copy()
    number = len(where)
    if not number:
        return Volumes(np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)), filled, np.zeros((0, 2)))
    deepest = np.full((number, 2), np.nan)
    height = cells.grid.row_height if cells.grid.rows > 1 else 1.0  # as `area` has it
    window = (DEEPEST_OVER / height, DEEPEST_OVER * height / float(sheets.area[-1]))
    value, hidden, weights = np.zeros(number), np.zeros(number), np.zeros((number, *wide.shape))
    left = dict[int, Floats]()
    count, deviation, offset = cells.grid.sides(cells.count), cells.grid.sides(cells.points.deviation), cell_offsets(cells)
    torn, slope = torn_beyond(sheets, filled, noise)
    variance = noise**2 / np.maximum(count, 1.0) + (0.0 if loop is None else loop.covariance.texture)
    held = count > 0
    for half in where:
        # A cell of one point counts, but where the others are many.
        here = held[tuple(half)]
        if here.any():
            here &= count[tuple(half)] >= LEAST_SHARE * float(np.median(count[tuple(half)][here]))
    flank = slice(sheets.fillet, None)
    common = {
        j: _Common.of(
            np.where(held, deviation, np.nan)[:, j, :, flank], count[:, j, :, flank], variance[:, j, :, flank],
            offset[:, :, j, :, flank], wide[:, j, :, flank],
        )
        for j in (side.index for side in worn)
    }  # fmt: skip
    for i, place in enumerate(where):
        side = (int(place[0]), int(place[1]))
        area = wide[side] * sheets.area
        # The form circle is an edge that the wear has too: fillet and flank have each their own surface.
        for part in (slice(0, sheets.fillet), flank):
            at = (*side, slice(None), part)
            if not wide[at].any():
                continue
            about = common.get(side[1]) if part.start else None
            surface = SideSurface.of(
                np.where(held[at], deviation[at], np.nan), count[at], variance[at], offset[(slice(None), *at)], wide[at],
                None if about is None else about.surface,
            )  # fmt: skip
            if surface is not None:
                filled[at] = np.where(sheets.seen[at], filled[at], surface.value)
                weights[(i, *at)], spread = surface.shares(area[:, part])
                volume = -float((surface.value * area[:, part]).sum())
                if about is not None:
                    left[i] = surface.left_to_before(area[:, part])
                if part.start and mask[at].any():
                    least, deepest[i, 1] = surface.deepest(window, mask[at] & sheets.seen[at])
                    deepest[i, 0] = -least
            else:
                volume, weights[(i, *at)], spread = _without_surface(sheets, at, wide[at])
            value[i] += volume
            hidden[i] += spread
    shape = np.diag(hidden)
    for j, shared_surface in common.items():
        among = [i for i in left if where[i, 1] == j]
        if shared_surface is not None and among:
            passed, unknown = shared_surface.surface.passed_on(np.stack([left[i] for i in among]))
            weights[among, :, j, :, flank] += passed[:, None] * shared_surface.share
            shape[np.ix_(among, among)] += unknown
    known = noise_covariance(cells, noise, loop, weights)
    # What the model of the errors does not know: the same cells on sides without wear; failing those, the unworn cells of all sides.
    white = (weights**2 * (noise**2 / np.maximum(count, 1.0))).sum(axis=(1, 2, 3, 4))
    shared, scatter = np.zeros(number), np.zeros(number)
    for i, (tooth, half) in enumerate(where):
        placebo, expected = _placebo(sheets, mask, wide, wide[tooth, half], noise)
        if len(placebo) >= FEWEST_SIDES:
            shared[i], scatter[i] = placebo.mean(), placebo.var() - expected
    chance = known + np.diag(np.maximum(scatter - (np.diag(known) - white), 0.0)) + np.outer(shared, shared)
    steep = shape + edge_covariance(sheets, torn, slope, weights) + unexplained_covariance(loop, weights)
    return Volumes(value, chance, chance + steep, filled, deepest)


def unexplained_covariance(loop: Loop | None, weights: Floats) -> Floats:
    """Covariance, mm⁶, by patterns round the gear that have no name: drawn on under the wear of a flank from those beside it, they may be off by
    their own size there. A pattern that all teeth share is known from the other teeth."""
    rms = 0.0 if loop is None else math.sqrt(sum(pattern.rms**2 for pattern in loop.patterns if pattern.order > 0))
    offset = rms * weights.sum(axis=(3, 4)).reshape(len(weights), -1)
    return np.asarray(offset @ offset.T, dtype=np.float64)


def _without_surface(sheets: SideMaps, at: tuple[int, int, slice, slice], own: Bools) -> tuple[float, Floats, float]:
    """Volume, weights and variance by what is hidden on a sheet of a few cells: what was not seen is as what was, or as far off as that scatters."""
    region = np.zeros((1, *sheets.count.shape), dtype=bool)
    region[(0, *at)] = own
    weights = region_weights(sheets, region)[(0, *at)]
    seen = own & sheets.seen[at]
    if not seen.any():
        return 0.0, weights, 0.0
    unseen = float(((own & ~seen) * sheets.area[at[-1]]).sum())
    values = sheets.deviation[at][seen]
    return -float(weights[seen] @ values), weights, float(values.var()) * unseen**2


def _placebo(sheets: SideMaps, mask: Bools, wide: Bools, own: Bools, noise: float) -> tuple[Floats, float]:
    """What the cells `own` of a side come to, mm³, on each side without wear; and the variance of that by the noise of the points, mm⁶."""
    sound = ~mask.any(axis=(2, 3)) & (sheets.seen.mean(axis=(2, 3)) > 0.5)
    if sound.sum() >= FEWEST_PLACEBOS:
        free = own & sound[..., None, None] & sheets.seen
    else:
        free = own & ~wide & sheets.seen
    area = free * sheets.area
    known = area.sum(axis=(2, 3))
    whole = np.where(known > 0.0, float((own * sheets.area).sum()) / np.maximum(known, 1e-300), 0.0)
    sums = -whole * (area * np.nan_to_num(sheets.deviation)).sum(axis=(2, 3))
    white = whole**2 * (area**2 * noise**2 / np.maximum(sheets.count, 1.0)).sum(axis=(2, 3))
    there = known > 0.0
    return sums[there], float(white[there].mean()) if there.any() else 0.0

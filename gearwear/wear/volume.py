"""Volumes of worn regions and how well they are known: of the surface that the cells of a side show (`surface`), with the errors of the cells
(`uncertainty`), and where the same sum scatters more on tooth sides without wear, what it scatters there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import LEAST_SHARE, SideMaps, cell_offsets, infill
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


def region_volumes(cells: Cells, sheets: SideMaps, mask: Bools, wide: Bools, noise: float, loop: Loop | None) -> Volumes:
    """Volumes of the sides with worn cells.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    sheets : SideMaps
        The same, laid flat.
    mask, wide : (teeth, 2, rows, columns) bool
        Worn cells; with the rim that is summed with them.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        Where the as-made gear comes from.
    """
    where, filled = np.argwhere(mask.any(axis=(2, 3))), infill(sheets)
    number = len(where)
    if not number:
        return Volumes(np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)), filled, np.zeros((0, 2)))
    deepest = np.full((number, 2), np.nan)
    height = cells.grid.row_height if cells.grid.rows > 1 else 1.0  # as `area` has it
    window = (DEEPEST_OVER / height, DEEPEST_OVER * height / float(sheets.area[-1]))
    value, hidden, weights = np.zeros(number), np.zeros(number), np.zeros((number, *wide.shape))
    count, deviation, offset = cells.grid.sides(cells.count), cells.grid.sides(cells.points.deviation), cell_offsets(cells)
    torn, slope = torn_beyond(sheets, filled, noise)
    variance = noise**2 / np.maximum(count, 1.0) + (0.0 if loop is None else loop.covariance.texture)
    for i, place in enumerate(where):
        side = (int(place[0]), int(place[1]))
        area = wide[side] * sheets.area
        held = count[side] > 0
        # A cell of one point counts, but where the others are many.
        if held.any():
            held &= count[side] >= LEAST_SHARE * float(np.median(count[side][held]))
        # The form circle is an edge that the wear has too: fillet and flank have each their own surface.
        for part in (slice(0, sheets.fillet), slice(sheets.fillet, None)):
            at = (*side, slice(None), part)
            if not wide[at].any():
                continue
            surface = SideSurface.of(
                np.where(held, deviation[side], np.nan)[:, part], count[at], variance[at], offset[(slice(None), *at)], wide[at]
            )
            if surface is not None:
                filled[at] = np.where(sheets.seen[at], filled[at], surface.value)
                weights[(i, *at)], spread = surface.shares(area[:, part])
                volume = -float((surface.value * area[:, part]).sum())
                if part.start and mask[at].any():
                    least, deepest[i, 1] = surface.deepest(window, mask[at] & sheets.seen[at])
                    deepest[i, 0] = -least
            else:
                volume, weights[(i, *at)], spread = _without_surface(sheets, at, wide[at])
            value[i] += volume
            hidden[i] += spread
    known = noise_covariance(cells, noise, loop, weights)
    # What the model of the errors does not know: the same cells on sides without wear; failing those, the unworn cells of all sides.
    white = (weights**2 * (noise**2 / np.maximum(count, 1.0))).sum(axis=(1, 2, 3, 4))
    shared, scatter = np.zeros(number), np.zeros(number)
    for i, (tooth, half) in enumerate(where):
        placebo, own = _placebo(sheets, mask, wide, wide[tooth, half], noise)
        if len(placebo) >= FEWEST_SIDES:
            shared[i], scatter[i] = placebo.mean(), placebo.var() - own
    chance = known + np.diag(np.maximum(scatter - (np.diag(known) - white), 0.0)) + np.outer(shared, shared)
    worn = np.diag(hidden) + edge_covariance(sheets, torn, slope, weights) + unexplained_covariance(loop, weights)
    return Volumes(value, chance, chance + worn, filled, deepest)


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

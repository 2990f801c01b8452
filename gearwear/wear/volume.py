"""Volumes of worn regions and how well they are known: of the surface that the cells of a side show (`surface`), with the errors of the cells
(`uncertainty`), and where the same sum scatters more on tooth sides without wear, what it scatters there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy import ndimage
from scipy.special import ndtri

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.side_maps import SideMaps
from gearwear.wear.cell_means import FEW, CellMeans, CommonSurface
from gearwear.wear.made_apart import made_apart
from gearwear.wear.stiffness import AsStiff
from gearwear.wear.surface import FEWEST_SEEN, SideSurface
from gearwear.wear.uncertainty import CellErrors, edge_covariance, ending_below, region_weights, torn_beyond
from gearwear.wear.weights import SideWeights, by_side

DEEPEST_OVER = 0.5
"""Edge of the square, mm, over whose mean the deepest wear is stated."""
ALARM = 0.05
"""Chance that any place of a scan is called a pit that is none."""
FEWEST_PLACEBOS, FEWEST_SIDES = 5, 3
"""Sides without wear from which on they are compared whole; sides with enough unworn cells of a region from which on those say something."""
FEWEST_OF_FILLET = 12
"""Cells of a fillet from which on they say how it runs, and how stiff it is: it has a few columns, and little of it is worn."""
LEAST_PLACEBO = 0.5
"""Share of a flank that is unworn on another side from which on it stands for the whole: less, blown up, is nothing but noise."""

StiffnessOf = Mapping[tuple[int, int, bool], AsStiff]
"""How stiff surfaces are: by tooth, side, and whether it is the flank or the fillet; by `COMMON` the surface that the flanks of a side have in common."""
COMMON = -1
"""Tooth of that surface."""


@dataclass(frozen=True, slots=True)
class Volumes:
    """Volumes of regions, each on one tooth side, in the order of their places.

    Parameters
    ----------
    value : (k,) float
        mm³.
    certainty : (k,) float
        Volume of the worn cells and their rim alone, in its own standard deviations where nothing is worn.
    together : (k,) float
        The same of all regions of its side in one.
    covariance : (k, k) float
        Of `value`, mm⁶: with what only wear has, steep places between the points and in holes.
    filled : (teeth, 2, rows, columns) float
        Deviations as measured, mm, with the surface where nothing was seen, or strays alone.
    deepest : (k, 2) float
        Greatest mean depth over `DEEPEST_OVER` on the flank as its surface has it, and the standard deviation of that, mm; nan without a surface.
    pitted : (k,) bool
        Whether cells lie deeper than that surface by more than chance.
    rest : (k,) float
        Share of what the rest of the flank seems to have lost that is in `value` (`share_of_rest`).
    apart : (2,) float
        How far the flanks of a side worn throughout were made apart, mm (`made_apart`).
    as_stiff : StiffnessOf
        How stiff the surfaces are.
    """

    value: Floats
    certainty: Floats
    together: Floats
    covariance: Floats
    filled: Floats
    deepest: Floats
    pitted: Bools
    rest: Floats
    apart: Floats
    as_stiff: StiffnessOf = field(default_factory=dict)


def region_volumes(
    cells: Cells,
    sheets: SideMaps,
    filled: Floats,
    mask: Bools,
    wide: Bools,
    allowed: Bools,
    noise: float,
    loop: Loop | None,
    worn: frozenset[Side] = frozenset(),
    known: bool = True,
    as_stiff: StiffnessOf | None = None,
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
    mask, wide, allowed : (teeth, 2, rows, columns) bool
        Worn cells; with the rim that is summed with them; what may be summed at all.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        Where the as-made gear comes from.
    worn : frozenset of Side
        Sides worn throughout. Their flanks are alike, so each bends about the surface that they have in common, not about a flat one: a flank of
        few points would read too shallow where wear is steep, and every flank of the side alike.
    known : bool
        Whether to work out the covariance; nan without.
    as_stiff : StiffnessOf or None
        How stiff the surfaces are of which that is known; the others say it themselves.
    """
    where, filled = np.argwhere(mask.any(axis=(2, 3))), filled.copy()
    number = len(where)
    if not number:
        nothing, none = np.zeros(0), np.zeros((0, 0))
        return Volumes(
            value=nothing, certainty=nothing, together=nothing, covariance=none, filled=filled, deepest=np.zeros((0, 2)),
            pitted=np.zeros(0, dtype=np.bool_), rest=nothing, apart=np.zeros(len(Side)),
        )  # fmt: skip
    torn, slope = torn_beyond(sheets, filled, noise, worn)
    ending = ending_below(sheets, filled, noise, worn, cells.grid.gear.undercut)
    by_cells = CellErrors.of(cells, noise, loop)
    apart = made_apart(by_cells, sheets, cells.grid, loop) if known and loop is not None else np.zeros(len(Side))
    errors = _Errors(
        cells=cells,
        known=by_cells,
        sheets=sheets,
        mask=mask,
        wide=wide,
        noise=noise,
        loop=loop,
        torn=torn,
        slope=slope,
        ending=ending,
        apart=apart,
    )
    surfaces = _Surfaces.of(cells, sheets, mask, wide, where, filled, noise, loop, worn, as_stiff or {})
    near = wide[tuple(where.T)].astype(np.float64)
    alone = surfaces.over(near)
    chance = errors.by_chance(alone, near)
    certainty = alone.value / np.maximum(np.sqrt(np.diag(chance)), 1e-300)
    alike = (where[:, 1:] == where[:, 1]).astype(np.float64)
    together = alike @ alone.value / np.maximum(np.sqrt(np.einsum("ki,ij,kj->k", alike, chance, alike)), 1e-300)
    # What stands out of the scatter may be the deepest places only of what is worn: the rest of the flank counts as far as it shows that.
    rest = np.zeros_like(near)
    if cells.grid.rows > 1:
        rest[..., sheets.fillet :] = np.where(allowed[tuple(where.T)], 1.0 - near, 0.0)[..., sheets.fillet :]
    share = doubt = np.zeros(number)
    if rest.any():
        beyond = surfaces.over(rest)
        doubt = np.diag(errors.by_chance(beyond, rest, LEAST_PLACEBO))
        share = share_of_rest(beyond.value, doubt)
    summed, support = alone, near
    if share.any():
        support = near + share[:, None, None] * rest
        summed = surfaces.over(support)
        chance = errors.by_chance(summed, support, LEAST_PLACEBO) if known else chance
    covariance = np.full((number, number), np.nan)
    if known:
        covariance = chance + errors.of_wear(summed, support) + np.diag(share * (1.0 - share) * doubt)
    return Volumes(
        value=summed.value, certainty=certainty, together=together, covariance=covariance, filled=filled, deepest=surfaces.deepest,
        pitted=surfaces.pitted, rest=share, apart=apart, as_stiff=surfaces.as_stiff,
    )  # fmt: skip


def share_of_rest(more: Floats, variance: Floats) -> Floats:
    """How much of what the rest of a flank seems to have lost besides its worn cells is taken for lost, 0 … 1.

    Parameters
    ----------
    more : (k,) float
        What it seems to have lost, mm³.
    variance : (k,) float
        Of that where the rest is as made, mm⁶: chance alone. How far wear may be another than the few points on it show is no reason that it is none.

    Notes
    -----
    Empirical Bayes: the true loss is expected to be N(0, τ²) with τ² as makes what is seen most likely, ``max(more² − variance, 0)``; then the expected
    loss is the share ``τ² / (τ² + variance)`` of what is seen, and its variance that share of `variance`. Wear takes nothing on: less than nothing is none.
    """
    square = np.where(more > 0.0, more, 0.0) ** 2
    return np.where(square > variance, 1.0 - variance / np.maximum(square, 1e-300), 0.0)


@dataclass(frozen=True, slots=True)
class _Integral:
    """Integrals over regions: `value` (k,) mm³, `weights` mm², what each cell takes from them, `shape` (k, k) mm⁶, what the
    surfaces leave open of them."""

    value: Floats
    weights: SideWeights
    shape: Floats


@dataclass(frozen=True, slots=True)
class _Surfaces:
    """The surfaces of the fillets and flanks of regions.

    Parameters
    ----------
    sheets : SideMaps
    where : (k, 2) int
        Tooth and side of each region.
    parts : tuple of (region, columns, surface or None)
        The form circle is an edge that the wear has too: fillet and flank have each their own surface.
    common : dict of CommonSurface or None
        By side, of those worn throughout.
    deepest, pitted : (k, 2) float, (k,) bool
        As in `Volumes`.
    """

    sheets: SideMaps
    where: Ints
    parts: tuple[tuple[int, slice, SideSurface | None], ...]
    common: dict[int, CommonSurface | None]
    deepest: Floats
    pitted: Bools

    @classmethod
    def of(
        cls, cells: Cells, sheets: SideMaps, mask: Bools, wide: Bools, where: Ints, filled: Floats, noise: float,
        loop: Loop | None, worn: frozenset[Side], as_stiff: StiffnessOf,
    ) -> _Surfaces:  # fmt: skip
        """Of the regions; `filled` gets them where nothing was seen."""
        height = cells.grid.row_height if cells.grid.rows > 1 else 1.0  # as `area` has it
        window = (DEEPEST_OVER / height, DEEPEST_OVER * height / float(sheets.area[-1]))
        texture = 0.0 if loop is None else loop.covariance.texture
        means = CellMeans.of(cells, sheets, filled, noise, loop, where)
        flank = slice(sheets.fillet, None)
        common = {
            side.index: CommonSurface.of(means, side.index, flank, wide, as_stiff.get((COMMON, side.index, True)))
            for side in worn
        }
        parts, deepest = [], np.full((len(where), 2), np.nan)
        pits, scatter = np.full(len(where), -np.inf), cells.grid.sides(cells.scatter)
        around = max(1, round(DEEPEST_OVER / cells.grid.size))
        for i, place in enumerate(where):
            side = (int(place[0]), int(place[1]))
            for part in (slice(0, sheets.fillet), flank):
                at = (*side, slice(None), part)
                if not part.start and not wide[at].any():
                    continue
                about = common.get(side[1]) if part.start else None
                fewest = FEWEST_SEEN if part.start else FEWEST_OF_FILLET
                known = as_stiff.get((*side, bool(part.start)))
                surface = means.surface(at, wide[at], None if about is None else about.surface, fewest, known)
                parts.append((i, part, surface))
                if surface is not None and wide[at].any():
                    filled[at] = np.where(means.shown[at], filled[at], surface.value)
                    if part.start and mask[at].any():
                        there = mask[at]
                        least, deepest[i, 1] = surface.deepest(window, there)
                        deepest[i, 0] = -least
                        deeper = np.where(means.held[at], surface.value - means.deviation[at], 0.0)
                        number = np.where(means.held[at], means.count[at], 0.0)
                        pits[i] = _deepest_pit(deeper, number, scatter[at], noise, texture, around, there)
        places = max(float(mask[tuple(where.T)][..., sheets.fillet :].sum()) / around**2, 1.0)
        return cls(sheets, where, tuple(parts), common, deepest, pits > float(ndtri(1.0 - ALARM / places)))

    @property
    def as_stiff(self) -> StiffnessOf:
        """How stiff they are."""
        own = {
            (int(self.where[i, 0]), int(self.where[i, 1]), bool(part.start)): one.as_stiff
            for i, part, one in self.parts
            if one is not None
        }
        return own | {(COMMON, side, True): one.surface.as_stiff for side, one in self.common.items() if one is not None}

    def over(self, support: Floats) -> _Integral:
        """Integrals over `support` (k, rows, columns), the share of each cell that counts."""
        sheets, number = self.sheets, len(self.where)
        value, hidden, weights = np.zeros(number), np.zeros(number), np.zeros(support.shape)
        left = dict[int, Floats]()
        for i, part, surface in self.parts:
            share = support[i][:, part]
            if not share.any():
                continue
            side = (int(self.where[i, 0]), int(self.where[i, 1]))
            if surface is not None:
                area = share * sheets.area[part]
                weights[i][:, part], spread = surface.shares(area)
                volume = -float((surface.value * area).sum())
                if part.start and self.common.get(side[1]) is not None:
                    left[i] = surface.left_to_before(area)
            else:
                volume, weights[i][:, part], spread = _without_surface(sheets, (*side, slice(None), part), share)
            value[i] += volume
            hidden[i] += spread
        shape, passed, shares = np.diag(hidden), dict[int, Floats](), dict[int, Floats]()
        for j, shared_surface in self.common.items():
            among = [i for i in left if self.where[i, 1] == j]
            if shared_surface is not None and among:
                before = (*[(0, 0)] * 2, (sheets.fillet, 0))  # fillets have no surface in common
                passed[j] = np.zeros(weights.shape)
                flanks, unknown = shared_surface.surface.passed_on(np.stack([left[i] for i in among]))
                passed[j][among] = np.pad(flanks, before)
                shares[j] = np.pad(shared_surface.share, before)
                shape[np.ix_(among, among)] += unknown
        return _Integral(value, SideWeights(self.where, weights, passed, shares), shape)


@dataclass(frozen=True, slots=True)
class _Errors:
    """What the errors of cells make of integrals over regions: those that are `known`, and what else; `torn` and `slope` as `torn_beyond` gives them,
    `ending` as `ending_below`, `apart` as `made_apart`, the others as `region_volumes` has them."""

    cells: Cells
    known: CellErrors
    sheets: SideMaps
    mask: Bools
    wide: Bools
    noise: float
    loop: Loop | None
    torn: Floats
    slope: Floats
    ending: Floats
    apart: Floats

    def by_chance(self, integral: _Integral, support: Floats, least: float = 0.0) -> Floats:
        """Covariance, mm⁶, where nothing is worn, of integrals over `support` (k, rows, columns); sides without wear are asked of which more than the
        share `least` of it is seen."""
        weights, number = integral.weights, len(support)
        known, white = self.known.covariance_of(weights), np.zeros(number)
        # What the model of the errors does not know: the same cells on sides without wear; failing those, the unworn cells of all sides.
        for side, which, values in weights.by_side():
            of_points = self.noise**2 / np.maximum(self.cells.grid.side(self.cells.count, *side), 1.0)
            white[which] += (values**2 * of_points).sum(axis=(1, 2))
        shared, scatter = np.zeros(number), np.zeros(number)
        for i, here in enumerate(support):
            placebo, expected = _placebo(self.cells.grid, self.sheets, self.mask, self.wide, here, self.noise, least)
            if len(placebo) >= FEWEST_SIDES:
                shared[i], scatter[i] = placebo.mean(), placebo.var() - expected
        return np.asarray(known + np.diag(np.maximum(scatter - (np.diag(known) - white), 0.0)) + np.outer(shared, shared))

    def of_wear(self, integral: _Integral, support: Floats) -> Floats:
        """Covariance, mm⁶, by what only wear has, of integrals over `support`: steep places between the points and in holes, where it ends below the
        form circle, and no unworn place on its side."""
        weights = integral.weights
        areas = SideWeights(weights.where, support * self.sheets.area, {}, {})
        return (
            integral.shape
            + edge_covariance(self.sheets, self.torn, self.slope, weights)
            + edge_covariance(self.sheets, self.ending, self.slope, areas)
            + unexplained_covariance(self.loop, weights)
            + self._of_made(weights)
        )

    def _of_made(self, weights: SideWeights) -> Floats:
        """Covariance, mm⁶, by how high sides worn throughout may stand as they were made (`Loop.made`), and their flanks apart."""
        if self.loop is None or self.loop.made is None:
            return np.zeros((len(weights), len(weights)))
        teeth, std = self.cells.grid.gear.teeth, [self.loop.made.of(side) for side in Side]
        level, own = np.zeros((len(weights), len(Side))), np.zeros((len(Side), len(weights), teeth))
        for (tooth, half), which, values in weights.by_side():
            level[which, half] += std[half] * values[..., self.sheets.fillet :].sum(axis=(1, 2))
            own[half, which, tooth] += self.apart[half] * values.sum(axis=(1, 2))
        own -= own.mean(axis=2, keepdims=True)  # about the mean of their side
        return np.asarray(level @ level.T + np.einsum("sik,sjk->ij", own, own), dtype=np.float64)


def unexplained_rms(loop: Loop | None) -> float:
    """How far patterns that have no name may be off under wear, mm: by their own size, as they are drawn on from beside it. One that all teeth share is
    known from the other teeth, and a wave in space from all of them."""
    return 0.0 if loop is None else math.sqrt(sum(pattern.rms**2 for pattern in loop.patterns if not pattern.known_everywhere))


def unexplained_covariance(loop: Loop | None, weights: Floats | SideWeights) -> Floats:
    """Covariance of sums, mm⁶, by patterns that have no name (`unexplained_rms`)."""
    rms = unexplained_rms(loop)
    result = np.zeros((len(weights), len(weights)))
    for _, which, values in by_side(weights) if rms > 0.0 else ():
        offset = rms * values.sum(axis=(1, 2))
        result[np.ix_(which, which)] += np.outer(offset, offset)
    return result


def _deepest_pit(
    deeper: Floats, count: Floats, scatter: Floats, noise: float, texture: float, around: int, inside: Bools
) -> float:
    """By how many of its standard deviations the mean of some window of cells lies deeper than the surface, at most.

    Parameters
    ----------
    deeper, count, scatter : (rows, columns) float
        By how much the cells' means lie deeper, mm; their points, and the scatter of these, mm.
    noise, texture : float
        Scatter of points, mm, and variance of what hangs together over a window, mm².
    around : int
        Cells to an edge of the window.
    inside : (rows, columns) bool
        Cells of which more than half of a window must be.

    Notes
    -----
    The points of a window tell themselves how far their mean is known: a stray among n of them moves it by no more than about that. Of one or two
    points nobody knows whether they are strays.
    """

    def summed(values: Floats) -> Floats:
        return np.asarray(ndimage.uniform_filter(values, around, mode="constant"), dtype=np.float64) * around**2

    own = np.where(count > 1.0, np.nan_to_num(scatter) ** 2 * (count - 1.0), 0.0)
    number = summed(count)
    among = summed(inside.astype(np.float64)) > 0.5 * around**2  # the same whichever end is up, even where no cell is the middle
    many = among & (number > FEW - 0.5)
    mean = summed(count * deeper) / np.maximum(number, 1.0)
    square = (summed(own + count * deeper**2) - number * mean**2) / np.maximum(number - 1.0, 1.0)
    std = np.sqrt(np.maximum(square, noise**2) / np.maximum(number, 1.0) + texture)
    return float((mean / std)[many].max(initial=-np.inf))


def _without_surface(sheets: SideMaps, at: tuple[int, int, slice, slice], shares: Floats) -> tuple[float, Floats, float]:
    """Volume, weights and variance by what is hidden on a sheet of a few cells, `shares` of each: what was not seen is as what was, or as far off as that
    scatters."""
    region = np.zeros((1, *sheets.count.shape))
    region[(0, *at)] = shares
    weights = region_weights(sheets, region)[(0, *at)]
    seen = (shares > 0.0) & sheets.seen[at]
    if not seen.any():
        return 0.0, weights, 0.0
    unseen = float((shares * ~seen * sheets.area[at[-1]]).sum())
    values = sheets.deviation[at][seen]
    return -float(weights[seen] @ values), weights, float(values.var()) * unseen**2


def _placebo(
    grid: CellGrid, sheets: SideMaps, mask: Bools, wide: Bools, shares: Floats, noise: float, least: float
) -> tuple[Floats, float]:
    """What `shares` of the cells of a side come to, mm³, on each side without wear on which more than the share `least` of them is seen; and
    the variance of that by the noise of the points, mm⁶."""
    sound = ~mask.any(axis=(2, 3)) & (sheets.seen[:, :, grid.toothed].mean(axis=(2, 3)) > 0.5)
    if sound.sum() >= FEWEST_PLACEBOS:
        free = shares * (sound[..., None, None] & sheets.seen)
    else:
        free = shares * (~wide & sheets.seen)
    area = free * sheets.area
    known = area.sum(axis=(2, 3))
    whole = np.where(known > 0.0, float((shares * sheets.area).sum()) / np.maximum(known, 1e-300), 0.0)
    sums = -whole * (area * np.nan_to_num(sheets.deviation)).sum(axis=(2, 3))
    white = whole**2 * (area**2 * noise**2 / np.maximum(sheets.count, 1.0)).sum(axis=(2, 3))
    there = known > least * float((shares * sheets.area).sum())
    return sums[there], float(white[there].mean()) if there.any() else 0.0

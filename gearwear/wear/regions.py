"""Where metal is missing beyond what the scan's own scatter can explain, and how much.

A region is all the wear of one tooth side. It is found on means over 3 × 3 cells, judged against the spread those means
have on the better half of the gear, corrected for the number of places looked at. Its volume (`volume`) is the signed integral of depth over the
region and a rim round it: signed sums are unbiased, one-sided ones collect noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.card import Card, CardRow, few, measured
from gearwear.design.quantity import NORMAL_95, counted
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.placing.side_maps import SideMaps, rim
from gearwear.threads import on_one_thread
from gearwear.wear.alike import alike
from gearwear.wear.burr import TipBurr
from gearwear.wear.edges import seen_sides
from gearwear.wear.least import least_mean
from gearwear.wear.limits import FlankLimit, faint_sides, faint_wear, flank_limits, upper_limit
from gearwear.wear.places import LaidFlat, lay_flat, standing_out
from gearwear.wear.ridge import PitchRidge
from gearwear.wear.volume import DEEPEST_OVER, StiffnessOf, Volumes, region_volumes, unexplained_rms

LEAST_VOLUME = 5.0
"""Least volume of a region in the standard deviations of its own cells."""
BEYOND_CHANCE = 3.0
"""The same in all of its standard deviation, with what pose and effects add, which cells have in common; or of its deepest place in that one's. Of the
volume of pits, which are known by their number, the 95 % interval lies above nothing."""
LEAST_VOLUME_OF_WORN_SIDE = 2.0
"""The same of all flanks of a side that is known to be worn throughout, together: no flank of it need prove it by itself, and to leave out those that
do not would leave out what they lost."""
LEAST_VOLUME_OF_WORN_FLANK = 3.0
"""The same of a flank that is known to be worn all over, by its level: beyond chance."""
LEAST_VOLUME_OF_PITS = 1.0
"""The same where more points lie far below than strays can: that something is missing is known by their number."""
LEAST_SHARE_OF_PITS = 0.15
"""Share of a region's volume that points far below stand for, where it is made of pits or grooves."""

UNIT = {False: "mm³", True: "mm²"}
"""Unit of what is lost, on a planar section or not."""


@dataclass(frozen=True, slots=True, repr=False)
class WearRegion(Card):
    """The wear of one tooth side.

    Parameters
    ----------
    tooth : int
        0-based.
    side : Side
    volume, volume_std : float
        mm³ (mm² for a planar section).
    max_depth : float
        Largest mean over 0.5 × 0.5 mm, mm, without the bias of having looked for the largest.
    mean_depth, area : float
        mm, mm².
    centroid : (3,) float
        Depth-weighted, in the design frame, mm.
    patches : int
        Number of pieces.
    max_depth_std : float
        Its standard deviation, mm.
    planar : bool
        True on a planar section, which has one row: `volume` is an area there, and `area` a length of flank, both per mm of height.
    """

    tooth: int
    side: Side
    volume: float
    volume_std: float
    max_depth: float
    mean_depth: float
    area: float
    centroid: Floats
    patches: int
    planar: bool = False
    max_depth_std: float = math.nan

    @property
    def size(self) -> str:
        """Volume with its standard deviation and unit."""
        return measured(self.volume, self.volume_std, UNIT[self.planar])

    def headline(self) -> str:
        return f"tooth {self.tooth + 1} {self.side}, {self.size}"

    def rows(self) -> list[CardRow]:
        x, y, z = self.centroid
        extent = f"{self.area:.2f} mm" if self.planar else f"{self.area:.1f} mm²"
        return [
            ("depth", f"{1e3 * self.max_depth:.1f} µm at most, {1e3 * self.mean_depth:.1f} µm on average"),
            ("length" if self.planar else "area", f"{extent} in {counted(self.patches, 'piece')}"),
            ("centre", f"x {x:z.2f}, y {y:z.2f}, z {z:z.2f} mm"),
        ]


@dataclass(frozen=True, slots=True, repr=False)
class Wear(Card):
    """All wear of a scan.

    Parameters
    ----------
    regions : tuple of WearRegion
        Largest volume first.
    volume, volume_std : float
        Their sum, mm³, and its standard deviation.
    side_maps : SideMaps
        The deviations it was found on.
    mask : (teeth, 2, rows, columns) bool
        Cells of the regions: those that stand out, or the flank where most of what the rest of it lacks is counted (`volume.share_of_rest`).
    depth : (teeth, 2, rows, columns) float
        Missing depth in the regions with holes filled, mm; 0 elsewhere.
    spread : float
        Standard deviation of 3 × 3 cell means where there is no wear, mm.
    limit : float
        Mean depth over 3 × 3 cells from which wear is seen, mm.
    flanks : tuple of FlankLimit
        From what depth on a patch of wear would have been found, flank by flank.
    hidden_pits : float
        What pits or grooves may come to at most (95 %) on flanks where they are too few to be told from strays, mm³; 0 where none were found.
    faint : float
        What wear too faint to be found may come to at most (95 %), and worn flanks that count as made low (`own_level`), mm³.
    burrs : tuple of TipBurr
        Metal pushed over the tip edges of worn sides; it is taken off the deviations, and not off the volume.
    edges : int
        Flanks that lack metal at an end of the face alone: rounded, deburred or nicked edges, which are no wear and not in `regions`.
    edge_depth : float
        Depth of the deepest cell of those, mm.
    unseen : float
        What would be missing besides, mm³, where flanks of `regions` are worn up to the edge of what was seen on any flank, if they were as deep beyond
        it as at their deepest place.
    proud : (float, float)
        How far left and right flanks that are worn throughout stand above the gear as made where they are highest, mm (`standing_proud`); wear is
        counted from there.
    level_open : (float, float)
        By how much less and by how much more that may be, mm, as there may be a ridge at the pitch line (`ridge`).
    ridges : tuple of PitchRidge
        Metal that stands at the pitch line of such a side: it is no thicker tooth, and not taken off the volume.
    unsure : float
        What flanks of sides worn throughout may have lost at most (95 %) whose loss is not sure, mm³ (`limits.upper_limit`).
    apart : (float, float)
        How far the flanks of left and right, worn throughout, were made apart, mm (`made_apart`).
    as_stiff : StiffnessOf
        How stiff the surfaces are of the flanks and fillets that were looked at.
    """

    regions: tuple[WearRegion, ...]
    volume: float
    volume_std: float
    side_maps: SideMaps
    mask: Bools
    depth: Floats
    spread: float
    limit: float
    flanks: tuple[FlankLimit, ...] = ()
    hidden_pits: float = 0.0
    faint: float = 0.0
    burrs: tuple[TipBurr, ...] = ()
    edges: int = 0
    edge_depth: float = 0.0
    unseen: float = 0.0
    proud: tuple[float, float] = (0.0, 0.0)
    level_open: tuple[float, float] = (0.0, 0.0)
    ridges: tuple[PitchRidge, ...] = ()
    unsure: float = 0.0
    apart: tuple[float, float] = (0.0, 0.0)
    as_stiff: StiffnessOf = field(default_factory=dict)

    @property
    def would_have_shown(self) -> FlankLimit | None:
        """The flank on which the least could be seen, of those of which anything can be said; None without any."""
        return max((flank for flank in self.flanks if flank.says), key=lambda flank: flank.depth, default=None)

    @property
    def planar(self) -> bool:
        """Whether it was found on a planar section: volumes are areas, mm², there."""
        return int(self.mask.shape[2]) == 1

    @property
    def drive_side(self) -> Side:
        """Side that lost more: the one that carries; left where nothing is lost."""
        lost = {side: sum(region.volume for region in self.regions if region.side == side) for side in Side}
        return max(Side, key=lambda side: lost[side])

    def flanks_seen(self, side: Side) -> int:
        """How many flanks of a side were seen: no others have regions."""
        return int(seen_sides(self.side_maps)[:, side.index].sum())

    @property
    def least_seen(self) -> tuple[float, float]:
        """Depth, mm, and volume, mm³, from which on wear is seen: the limit, over 3 × 3 cells."""
        return self.limit, 9.0 * self.limit * float(self.side_maps.area[-1])

    def headline(self) -> str:
        size = f"{measured(self.volume, self.volume_std, UNIT[self.planar])} in {counted(len(self.regions), 'region')}"
        return f"{size if self.regions else 'none found'}, seen from {1e3 * self.limit:.1f} µm on"

    def rows(self) -> list[CardRow]:
        return few(
            [
                (
                    f"tooth {region.tooth + 1} {region.side}",
                    f"{region.size}, {1e3 * region.max_depth:.1f} µm deep",
                )
                for region in self.regions
            ]
        )


@on_one_thread
def find_wear(
    cells: Cells,
    noise: float,
    worn: frozenset[Side] = frozenset(),
    loop: Loop | None = None,
    limits: bool = True,
    gone: Bools | None = None,
    errors: bool = True,
    as_stiff: StiffnessOf | None = None,
) -> Wear:
    """Find the worn regions of a scan.

    Parameters
    ----------
    cells : Cells
        Deviations from the as-made gear.
    noise : float
        Scatter of points, mm.
    worn : frozenset of Side
        Sides whose flanks are known to be worn throughout: there a region is the whole flank, else what
        lies below the limit near the pitch point would be lost (2 % of sliding wear).
    loop : Loop or None
        Where the as-made gear comes from; with it the standard deviations hold texture, pose and effects as well.
    limits : bool
        Whether to work out from what depth on wear would have been found (`Wear.flanks`).
    gone : (teeth, 2, rows, columns) bool or None
        Cells that are broken off: neither worn nor anything else.
    errors : bool
        Whether to work out how well volumes and depths are known, and what wear too faint to be found may come to; without, they are nan.
    as_stiff : StiffnessOf or None
        How stiff the surfaces are of which that is known (`Wear.as_stiff`); the others say it themselves.
    """
    if gone is None:
        gone = np.zeros(cells.grid.side_shape, dtype=bool)
    laid = lay_flat(cells.without(cells.grid.on_cells(gone)) if gone.any() else cells, noise, loop, worn)
    places = standing_out(laid, noise, loop, worn, gone)
    cells, sheets = laid.cells, laid.sheets
    volumes = region_volumes(
        cells, sheets, laid.filled, places.mask, places.wide, places.allowed, noise, loop, worn, errors, as_stiff
    )  # fmt: skip
    where = np.argwhere(places.mask.any(axis=(2, 3)))
    at = tuple(where.T)
    covariance = volumes.covariance + np.diag(laid.burr_std[where[:, 1]] ** 2)
    # A place may be low by texture alone: what the same cells come to on sides without wear decides.
    on_worn = np.isin(where[:, 1], [side.index for side in worn])
    least = np.where(places.by_level, LEAST_VOLUME_OF_WORN_FLANK, np.where(places.pitted, LEAST_VOLUME_OF_PITS, LEAST_VOLUME))[at]
    whole_side = on_worn & (volumes.together > LEAST_VOLUME_OF_WORN_SIDE)
    sure = (volumes.certainty > least) | whole_side | (places.hollowed[at] & (volumes.value > 0.0))
    stds = np.sqrt(np.diag(covariance))
    beyond_chance = np.where(least == LEAST_VOLUME_OF_PITS, NORMAL_95, BEYOND_CHANCE) * stds
    counted = np.zeros_like(places.mask)
    whole = places.mask[at]
    whole[..., sheets.fillet :] |= (volumes.rest > 0.5)[:, None, None] & places.allowed[at][..., sheets.fillet :]
    area = (whole * sheets.area).sum(axis=(1, 2))
    peaks = deepest_to_mean(volumes.deepest[:, 0], volumes.value / area, where[:, 1])
    common = common_level_std(covariance, area, where[:, 1]) * peaks
    if loop is not None:
        common = np.maximum(common, np.take(loop.as_made_std, where[:, 1]))
    level = np.hypot(np.hypot(common, volumes.apart[where[:, 1]]), unexplained_rms(loop))
    regions = list[WearRegion]()
    for i in map(int, np.flatnonzero(sure)):
        one = tuple(where[i])
        flank = _Flank.of(laid, volumes, i, places.mask[one], whole[i], where[i])
        region = flank.region(float(stds[i]), noise, loop, errors, float(level[i]))
        # A patch too narrow for its surface to have a deepest place is known by its volume alone.
        deep = bool(np.isfinite(volumes.deepest[i]).all()) and region.max_depth > BEYOND_CHANCE * region.max_depth_std
        sure[i] = places.by_level[one] or whole_side[i] or deep or region.volume > beyond_chance[i]
        if sure[i]:
            regions.append(region)
            counted[one] = whole[i]
    if errors:
        by_side = [([one for one in regions if one.side is side], common[where[:, 1] == side.index]) for side in Side]
        regions = [one for own, known in by_side for one in _alike(own, known, worn, volumes.apart)]
    regions.sort(key=lambda region: -region.volume)
    looked_at = ~(rim(counted, places.around) | rim(places.at_ends, places.around))
    faint = faint_wear(sheets, looked_at, noise, places.spread) if errors else math.nan
    if errors and loop is not None:
        faint = max(faint, faint_sides(cells, noise, loop, ~looked_at, sheets.area))
    unsure = sum(upper_limit(volumes.value, covariance, on_worn & ~sure & (where[:, 1] == side.index)) for side in worn)
    flanks = flank_limits(
        cells, sheets, counted, noise, places.spread, places.limit, LEAST_VOLUME, places.around, loop, gone
    ) if limits else ()  # fmt: skip
    return Wear(
        regions=tuple(regions), volume=sum(region.volume for region in regions), volume_std=math.sqrt(float(covariance[np.ix_(sure, sure)].sum())),
        side_maps=sheets, mask=counted, depth=np.where(counted, -volumes.filled, 0.0), spread=places.spread, limit=places.limit, flanks=flanks,
        hidden_pits=_hidden_pits(cells, sheets, counted, regions), faint=faint + laid.perhaps, burrs=laid.burrs, edges=int(places.edges.sum()),
        edge_depth=places.edge_depth, unseen=sum(region.max_depth * float(places.beyond[region.tooth, region.side.index].sum()) for region in regions),
        proud=laid.proud, level_open=laid.level_open, ridges=laid.ridges, unsure=unsure, apart=(float(volumes.apart[0]), float(volumes.apart[1])),
        as_stiff=volumes.as_stiff,
    )  # fmt: skip


def _alike(regions: list[WearRegion], common: Floats, worn: frozenset[Side], apart: Floats) -> list[WearRegion]:
    """The regions of one side, whose levels are known to `common` all together, and made `apart`, mm: if it is worn throughout, each as deep as the others
    make likely."""
    if not regions or regions[0].side not in worn:
        return regions
    shared, level = float(common.max()), float(apart[regions[0].side.index])

    def each(name: str) -> Floats:
        return np.array([getattr(one, name) for one in regions])

    own = np.sqrt(np.maximum(each("max_depth_std") ** 2 - shared**2 - level**2, 0.0))
    mean_std = np.sqrt(np.maximum((each("volume_std") / each("area")) ** 2 - shared**2, 0.0))
    value, own = alike(each("max_depth"), own, each("mean_depth"), mean_std, level)
    # No less than what the flank says of itself: looking for its deepest place is wrong alike on all, by about as much.
    return [
        replace(one, max_depth=float(deep), max_depth_std=max(math.hypot(known, shared), one.max_depth_std))
        for one, deep, known in zip(regions, value, own, strict=True)
    ]


def common_level_std(covariance: Floats, area: Floats, side: Ints) -> Floats:
    """How well is known how high the flanks of each region's side stand all together, as their volumes have it.

    Parameters
    ----------
    covariance : (k, k) float
        Of the volumes, mm⁶.
    area : (k,) float
        Of the regions, mm².
    side : (k,) int

    Returns
    -------
    (k,) float
        Standard deviation, mm: what volumes of two flanks of a side have in common, over their areas; 0 where a side has one region, or nothing is known.
    """
    result = np.zeros(len(area))
    per_area = covariance / np.outer(area, area)
    for which in np.unique(side):
        own = np.flatnonzero(side == which)
        if len(own) > 1:
            together = per_area[np.ix_(own, own)]
            shared = (together.sum() - np.trace(together)) / (len(own) * (len(own) - 1))
            result[own] = math.sqrt(shared) if shared > 0.0 else 0.0
    return result


def deepest_to_mean(deepest: Floats, mean: Floats, side: Ints) -> Floats:
    """How much deeper flanks of each region's side are at their deepest place than on average, (k,), in the median; at least 1. What they are wrong by in
    common, a form of the side as it was made, may have the shape of the loss."""
    ratio = np.where((mean > 0.0) & np.isfinite(deepest), deepest / np.maximum(mean, 1e-300), 1.0)
    return np.array([max(float(np.median(ratio[side == which])), 1.0) for which in side])


def _hidden_pits(cells: Cells, sheets: SideMaps, mask: Bools, regions: list[WearRegion]) -> float:
    """`Wear.hidden_pits`: the points far below on flanks without wear, less those far above, at the volume that such a point stands for on flanks
    with pits; with 1.96 of Poisson's standard deviations."""
    if cells.far is None:
        return 0.0
    below, above, points = (cells.grid.sides(n).sum(axis=(2, 3)) for n in (cells.far.below, cells.far.above, cells.count))
    area = (sheets.area * sheets.seen).sum(axis=(2, 3)) / np.maximum(points, 1.0)
    volume = known = 0.0
    for region in regions:
        side = (region.tooth, region.side.index)
        excess = float(below[side] - above[side])
        # A hollow has low points too, at its edge; what is lost there is not lost in pits.
        if excess * cells.far.depth * area[side] > LEAST_SHARE_OF_PITS * region.volume:
            volume, known = volume + region.volume, known + excess
    if known <= 0.0:
        return 0.0
    sound = ~mask.any(axis=(2, 3))
    more, scatter = float((below - above)[sound].sum()), math.sqrt(float((below + above)[sound].sum()))
    return max(volume / known * (more + NORMAL_95 * scatter), 0.0)


@dataclass(frozen=True, slots=True)
class _Flank:
    """One tooth side: its cells (rows, columns) that stand out, and those that count as worn."""

    sheets: SideMaps
    filled: Floats
    standing: Bools
    whole: Bools
    tooth: int
    side: Side
    size: float
    volume: float
    surface: Floats
    pitted: bool

    @classmethod
    def of(cls, laid: LaidFlat, volumes: Volumes, which: int, standing: Bools, whole: Bools, place: Ints) -> _Flank:
        """The side at `place`, tooth and half, of which `volumes` has the `which`-th volume."""
        tooth, half = (int(i) for i in place)
        return cls(
            laid.sheets, volumes.filled[tooth, half], standing, whole, tooth, tuple(Side)[half], laid.cells.grid.size,
            float(volumes.value[which]), volumes.deepest[which], bool(volumes.pitted[which]),
        )  # fmt: skip

    def region(self, std: float, noise: float, loop: Loop | None, errors: bool, level: float) -> WearRegion:
        """The wear of the side, its volume known to `std` and its level to `level`, mm: its deepest place and pieces are of the cells that stand out."""
        deepest, deep_std = float(self.surface[0]), math.nan
        if errors or self.pitted or not np.isfinite(self.surface).all():
            deepest, deep_std = self._deepest(noise, loop, level)
        patches = int(ndimage.label(self.standing, np.ones((3, 3)))[1])
        at, area_of = (self.tooth, self.side.index), self.sheets.area
        depth = np.where(self.whole, -self.filled, 0.0)
        weight = np.where(self.whole & self.sheets.seen[at], np.maximum(depth, 0.0) * area_of, 0.0)
        position = np.nan_to_num(self.sheets.position[at])
        centroid = (position * weight[..., None]).sum(axis=(0, 1)) / max(float(weight.sum()), 1e-300)
        area = float((self.whole * area_of).sum())
        mean = float((depth * area_of).sum()) / area
        return WearRegion(
            tooth=self.tooth,
            side=self.side,
            volume=self.volume,
            volume_std=std,
            max_depth=deepest,
            mean_depth=mean,
            area=area,
            centroid=centroid,
            patches=patches,
            planar=len(self.standing) == 1,
            max_depth_std=deep_std,
        )

    def _deepest(self, noise: float, loop: Loop | None, level: float) -> tuple[float, float]:
        """Depth of the deepest place among the cells that stand out, and its standard deviation, mm."""
        standing, deviation = self.standing, np.where(self.standing, self.filled, 0.0)
        window = max(1, round(DEEPEST_OVER / self.size))
        rows = min(window, len(standing))
        white = noise / np.sqrt(np.maximum(self.sheets.count[self.tooth, self.side.index], 1.0))
        if loop is None:
            least, deep_std, usual_std = least_mean(deviation, standing, white, (rows, window))
        else:
            known = loop.covariance
            steps = (known.row_step, known.column_step)
            least, deep_std, usual_std = least_mean(deviation, standing, white, (rows, window), known.texture, steps)
            deep_std, usual_std = (math.hypot(std, level) for std in (deep_std, usual_std))
        deepest = -least
        if np.isfinite(self.surface).all():
            # How steep the surface may be it takes from the flank as a whole: where cells lie deeper than chance has it that is a pit. Half of what the
            # two differ by is in the standard deviation, and a window of cells says how sure it can be at best: any one, for what the deepest of them
            # would say hangs on luck, and of two scans the noisier one could look better known.
            expected, deep_std, apart = (
                float(self.surface[0]),
                max(usual_std, float(self.surface[1])),
                abs(deepest - float(self.surface[0])),
            )
            if not self.pitted:
                deepest = expected
            deep_std = max(deep_std, 0.5 * apart)
        return deepest, deep_std

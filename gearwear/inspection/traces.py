"""Profile and helix traces of every flank from the located points of a scan.

A scan has no traces; it has points all over the flank. A trace is made of the points in a stated band, averaged
in narrow bins. What was not seen stays nan. Cost: two sorts and a few histograms, whatever the number of teeth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.inspection.ranges import profile_ends
from gearwear.robust import NORMAL_MAD

Area = tuple[tuple[float, float], tuple[float, float]]
"""Part of every flank: L to L and z to z, mm."""

CELLS = (8, 16)
"""Cells per flank, along z and along L, in which stray points are looked for and coverage is counted."""

STRAY_LIMIT = 5.0
"""A point farther from its cell's median than this many scaled MADs may be stray."""

STRAY_SHARE = 0.05
"""Where more of a cell than this lies beyond the limit it is the surface (an edge of wear, a pit), not stray points."""

STRATA = 16
"""Pieces across a trace's band inside which the scatter of single points is taken."""

CELL_POINTS = 3
"""A cell with fewer points does not count as seen."""

SLICES = 40
"""Pieces of the helix range in which it is looked whether the flanks are whole."""

ROUNDED = 0.03
"""Depth in modules from which the end of a flank on both sides is a rounded edge."""

USUAL_POINTS = 12
"""Points a cell holds on average, where the scan is thin: fewer than `CELL_POINTS` are in it by chance in 1 of 1,900."""


@dataclass(frozen=True, slots=True)
class FlankSamples:
    """The points of all flanks, stray ones left out.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    flank : (n,) int
        2 · tooth + side, side 0 left, 1 right.
    roll, z, deviation : (n,) float
        Place along the profile (`ranges.profile_place`: L, on a ring −L), z and δ in mm; δ is + for too much material.
    noise : float
        Scatter of single points over a short range (robust standard deviation inside a cell), mm.
    stray : int
        Points left out.
    """

    gear: Gear
    flank: Ints
    roll: Floats
    z: Floats
    deviation: Floats
    noise: float
    stray: int

    def __len__(self) -> int:
        return len(self.deviation)

    @property
    def hand(self) -> float:
        """Sign of helix slopes: −1 on a gear of left hand, so that + is too large a helix angle; else +1."""
        return -1.0 if self.gear.helix_angle < 0.0 else 1.0

    @property
    def is_section(self) -> bool:
        """All points at one height."""
        return len(self.z) > 0 and float(np.ptp(self.z)) <= 1e-3

    @property
    def per_flank(self) -> float:
        """Points that the usual flank has, of those that have any; 0 without."""
        count = np.bincount(self.flank)
        return float(np.median(count[count > 0])) if len(self) else 0.0

    def along(self, way: str) -> tuple[Floats, Floats]:
        """Places along traces of this way ("roll" or "z") and across them, mm."""
        return (self.roll, self.z) if way == "roll" else (self.z, self.roll)

    def by_flank(self) -> list[Ints]:
        """Numbers of the points of each flank, (2 · teeth) arrays."""
        order = np.argsort(self.flank, kind="stable")
        return np.split(order, np.searchsorted(self.flank[order], np.arange(1, 2 * self.gear.teeth)))

    def inside(self, roll: tuple[float, float], z: tuple[float, float]) -> FlankSamples:
        """The points in an area, L to L and z to z, mm."""
        return self.take((self.roll >= roll[0]) & (self.roll <= roll[1]) & (self.z >= z[0]) & (self.z <= z[1]))

    def on_flanks(self, wanted: Bools) -> FlankSamples:
        """The points on the flanks marked in `wanted` (teeth, 2)."""
        return self.take(wanted.ravel()[self.flank])

    def take(self, keep: Bools | Ints) -> FlankSamples:
        """The points marked in `keep` (n,), or of these numbers."""
        return replace(self, flank=self.flank[keep], roll=self.roll[keep], z=self.z[keep], deviation=self.deviation[keep])


@dataclass(frozen=True, slots=True)
class Traces:
    """One trace of every flank.

    Parameters
    ----------
    along : str
        "roll" (profile) or "z" (helix).
    band : (float, float)
        The points taken: z of a profile, L of a helix, mm.
    step : float
        Width of a bin, mm.
    centre : (n,) float
        Middle of each bin, mm.
    station : (teeth, 2, n) float
        Mean place of the bin's points, mm; nan in a gap. Means belong here, not to the middle: a line stays a line.
    deviation, standard_error : (teeth, 2, n) float
        Mean δ and its standard error in mm; nan in a gap.
    count : (teeth, 2, n) int
        Points in each bin.
    across : (teeth, 2, n) float
        Mean place of the bin's points across the trace (z of a profile, L of a helix), mm.
    """

    along: str
    band: tuple[float, float]
    step: float
    centre: Floats
    station: Floats
    deviation: Floats
    standard_error: Floats
    count: Ints
    across: Floats


@dataclass(frozen=True, slots=True)
class Topography:
    """Mean deviation on a regular grid of every flank.

    Parameters
    ----------
    roll, z : (n_L,), (n_z,) float
        Middle of the cells, mm.
    deviation : (teeth, 2, n_z, n_L) float
        mm; nan where nothing was seen.
    count : (teeth, 2, n_z, n_L) int
        Points per cell.
    """

    roll: Floats
    z: Floats
    deviation: Floats
    count: Ints


def flank_samples(points: SurfacePoints, gear: Gear) -> FlankSamples:
    """Pick the flank points of a scan and leave stray ones out.

    Parameters
    ----------
    points : SurfacePoints
        Located on `gear`.
    gear : Gear
        The nominal gear.

    Returns
    -------
    FlankSamples

    Notes
    -----
    ISO 1328-1 measures along the transverse base tangent: δ / cos β_b of the deviation along the normal in space.

    A point is stray where it is more than `STRAY_LIMIT` scaled MADs from the median of its cell (at least the MAD common to all
    cells) and it is one of a few: a cell in which more than `STRAY_SHARE` of the points is that far off has an edge
    in it, and keeps all of them.
    """
    on = (points.surface == FLANK) & np.isfinite(points.deviation) & (points.side != 0)
    cosine = gear.base_helix_cosine
    deviation = points.deviation[on] / cosine
    # Plumb in the point's own section: there the foot lies by δ (1/cos β_b − cos β_b) lower than that in space, at the point's own height.
    # A ring's roll falls towards the tip; places along a profile rise (`ranges.profile_place`).
    roll, z = gear.orientation * points.roll[on] - (1.0 / cosine - cosine) * points.deviation[on], points.own_height[on]
    flank = 2 * points.tooth[on].astype(np.int64) + np.where(points.side[on] == Side.LEFT, Side.LEFT.index, Side.RIGHT.index)
    if not len(deviation):
        return FlankSamples(gear, flank, roll, z, deviation, np.nan, 0)
    cell, number = _cells(_whole(gear), gear, flank, roll, z, CELLS)
    count = np.bincount(cell, minlength=number)
    off = np.abs(deviation - _medians(cell, deviation, count)[cell])
    small = count / np.maximum(count - 0.8, 0.2)  # a MAD of few points is too small (Croux and Rousseeuw 1992)
    scale = NORMAL_MAD * small * _medians(cell, off, count)
    noise = _common_scale(scale, count)
    far = off > STRAY_LIMIT * np.maximum(scale, noise)[cell]
    few = np.bincount(cell[far], minlength=number) <= np.maximum(1.0, STRAY_SHARE * count)
    keep = ~(far & few[cell])
    return FlankSamples(gear, flank[keep], roll[keep], z[keep], deviation[keep], noise, int(len(keep) - keep.sum()))


def profile_traces(
    samples: FlankSamples,
    band: tuple[float, float],
    step: float,
    noise: float | None = None,
    sample_factor: float = 1.0,
) -> Traces:
    """Deviation along the roll length, averaged over a band of z.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    band : (float, float)
        From z to z, mm. A narrow one gives the trace at one height.
    step : float
        Width of a bin, mm.
    noise : float or None
        Standard deviation of one point in mm; None: the scatter found in the bins.
    sample_factor : float
        How many points carry the information of one independent point (≥ 1); the squares of all standard errors grow by it.

    Returns
    -------
    Traces
        From the form circle to the end of the involute.
    """
    return _traces(samples, "roll", band, step, noise, sample_factor)


def helix_traces(
    samples: FlankSamples,
    band: tuple[float, float],
    step: float,
    noise: float | None = None,
    sample_factor: float = 1.0,
) -> Traces:
    """Deviation along z, averaged over a band of roll length; parameters as for `profile_traces`, band from L to L in mm."""
    return _traces(samples, "z", band, step, noise, sample_factor)


def topography(
    samples: FlankSamples, along_z: int = CELLS[0], along_roll: int = CELLS[1], area: Area | None = None
) -> Topography:
    """Mean deviation of every flank in `along_z` × `along_roll` equal cells; of an `area` (L to L and z to z, mm) only the points in it."""
    gear = samples.gear
    limits = _whole(gear) if area is None else area
    if area is not None:
        samples = samples.inside(*area)
    cell, number = _cells(limits, gear, samples.flank, samples.roll, samples.z, (along_z, along_roll))
    shape = (gear.teeth, 2, along_z, along_roll)
    count = np.bincount(cell, minlength=number)
    total = np.bincount(cell, samples.deviation, number)
    mean = np.divide(total, count, out=np.full(number, np.nan), where=count > 0)
    roll, z = (
        low + (np.arange(number) + 0.5) / number * (high - low)
        for (low, high), number in zip(limits, (along_roll, along_z), strict=True)
    )
    return Topography(roll, z, mean.reshape(shape), count.reshape(shape))


def flank_coverage(samples: FlankSamples, area: Area | None = None) -> Floats:
    """Share of each flank's cells that hold at least `CELL_POINTS` points; of a planar section, one.

    The cells (`CELLS`) are as many as leave a flank with the scan's usual number of points `USUAL_POINTS` in each, so that chance empties none.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    area : ((float, float), (float, float)) or None
        The part of the flank that should be seen, L to L and z to z, mm; None: all of it.

    Returns
    -------
    (teeth, 2) float
    """
    gear = samples.gear
    limits = area or _whole(gear)
    if samples.is_section:
        return np.asarray((topography(samples).count > 0).any(axis=2).mean(axis=2), dtype=np.float64)
    part = samples.inside(*limits)
    share = min(1.0, math.sqrt(part.per_flank / USUAL_POINTS / (CELLS[0] * CELLS[1])))
    n_z, n_roll = (max(1, round(share * number)) for number in CELLS)
    cell, cells = _cells(limits, gear, part.flank, part.roll, part.z, (n_z, n_roll))
    number = np.bincount(cell, minlength=cells)
    return np.asarray((number.reshape(gear.teeth, 2, -1) >= CELL_POINTS).mean(axis=2), dtype=np.float64)


def seen_face(samples: FlankSamples, roll: tuple[float, float], z: tuple[float, float]) -> tuple[float, float] | None:
    """The part of the range `z` in which the flanks are whole, mm: without ends that were not seen or are rounded off.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    roll, z : (float, float)
        L to L and z to z that are looked at, mm.

    Returns
    -------
    (float, float) or None
        None where it is all of the range, or less than three quarters of it.

    Notes
    -----
    A slice at an end does not count where the median point of either side lies lower than its flank by more than `ROUNDED`
    modules, or where there are next to none; and the slice beside it.
    """
    part = samples.inside(roll, z)
    gear, pieces = samples.gear, SLICES
    if not len(part):
        return None
    middle = np.array([np.median(part.deviation[mine]) if len(mine) else 0.0 for mine in part.by_flank()])
    off = part.deviation - middle[part.flank]
    piece = np.minimum((pieces * (part.z - z[0]) / (z[1] - z[0])).astype(np.int64), pieces - 1)
    whole = np.zeros(pieces, dtype=bool)
    for side in (0, 1):
        mine = part.flank % 2 == side
        usual = mine.sum() / pieces
        for k in range(pieces):
            in_slice = off[mine & (piece == k)]
            whole[k] |= len(in_slice) > max(0.1 * usual, 1.0) and float(np.median(in_slice)) > -ROUNDED * gear.spec.normal_module
    low = high = pieces // 2
    while low > 0 and whole[low - 1]:
        low -= 1
    while high < pieces and whole[high]:
        high += 1
    low, high = low + (low > 0), high - (high < pieces)
    if (low, high) == (0, pieces) or high - low < 0.75 * pieces:
        return None
    step = (z[1] - z[0]) / pieces
    return z[0] + low * step, z[0] + high * step


def seen_from(samples: FlankSamples, z: tuple[float, float]) -> float | None:
    """Place along the profile from which on most flanks are seen, mm; None where that is the form circle, or past the middle of the involute.

    A stretch of 10 % of the involute is seen on a flank where it holds at least a third of the points that a stretch holds on average, and one at least.
    """
    gear, pieces = samples.gear, 10
    form, tip = profile_ends(gear)
    limits = ((form, tip), z)
    part = samples.inside(*limits)
    if not len(part):
        return None
    cell, cells = _cells(limits, gear, part.flank, part.roll, part.z, (1, pieces))
    count = np.bincount(cell, minlength=cells).reshape(-1, pieces)
    count = count[count.sum(axis=1) > 0]
    seen = (count >= np.maximum(count.mean(axis=1, keepdims=True) / 3.0, 1.0)).mean(axis=0) >= 0.75
    missing = np.flatnonzero(~seen[: pieces // 2])
    first = int(missing[-1]) + 1 if len(missing) else 0
    if first == 0 or not seen[pieces // 2]:
        return None
    return float(form + first / pieces * (tip - form))


def _whole(gear: Gear) -> Area:
    return profile_ends(gear), (0.0, gear.face_width)


def _cells(area: Area, gear: Gear, flank: Ints, roll: Floats, z: Floats, shape: tuple[int, int]) -> tuple[Ints, int]:
    """Number of every point's cell, and how many cells there are; points past an edge belong to the cell at the edge."""
    n_z, n_roll = shape
    (first, last), (low, high) = area
    i = np.clip(((z - low) * (n_z / (high - low))).astype(np.int64), 0, n_z - 1)
    j = ((roll - first) * (n_roll / (last - first))).astype(np.int64)
    return (flank * n_z + i) * n_roll + np.clip(j, 0, n_roll - 1), 2 * gear.teeth * n_z * n_roll


def _medians(cell: Ints, value: Floats, count: Ints) -> Floats:
    """Median of `value` in every cell, nan in an empty one: one sort of the key cell + fraction of the value's range."""
    low = value.min()
    width = (value.max() - low) * (1.0 + 1e-9) + 1e-300
    key = np.sort(cell + (value - low) / width)
    start = np.cumsum(count) - count
    seen = count > 0
    middle = [np.minimum(start[seen] + place[seen], len(key) - 1) for place in ((count - 1) // 2, count // 2)]
    fraction = 0.5 * (key[middle[0]] + key[middle[1]]) - np.flatnonzero(seen)
    out = np.full(len(count), np.nan)
    out[seen] = low + fraction * width
    return out


def _common_scale(scale: Floats, count: Ints) -> float:
    """Median of the cells' scales; cells with few points only where there are no others."""
    for least in (8, 2, 1):
        usable = scale[count >= least]
        if len(usable):
            return float(np.median(usable))
    return float("nan")


def _traces(
    samples: FlankSamples, along: str, band: tuple[float, float], step: float, noise: float | None, sample_factor: float
) -> Traces:
    if not step > 0.0:
        raise ValueError(f"step must be positive, got {step} mm")
    if not sample_factor >= 1.0:
        raise ValueError(f"sample_factor must be at least 1, got {sample_factor}")
    limits = _whole(samples.gear)[0 if along == "roll" else 1]
    x, across = samples.along(along)
    n = max(1, round((limits[1] - limits[0]) / step))
    width = (limits[1] - limits[0]) / n
    inside: Bools = (across >= band[0]) & (across <= band[1]) & (x >= limits[0]) & (x <= limits[1])
    x, delta = x[inside], samples.deviation[inside]
    place = np.minimum(((x - limits[0]) / width).astype(np.int64), n - 1)
    cell = samples.flank[inside] * n + place
    number = 2 * samples.gear.teeth * n
    count = np.bincount(cell, minlength=number)
    seen = count > 0
    safe = np.maximum(count, 1)
    station: Floats = np.where(seen, np.bincount(cell, x, number) / safe, np.nan)
    mean: Floats = np.where(seen, np.bincount(cell, delta, number) / safe, np.nan)
    if noise is None:
        squares, freedom = _scatter(cell, delta, (across[inside] - band[0]) / (band[1] - band[0]), number)
        variance = _steady_variance(squares.reshape(-1, n), freedom.reshape(-1, n), samples.noise).ravel()
    else:
        variance = np.full(number, noise**2)
    error: Floats = np.where(seen, np.sqrt(sample_factor * variance / safe), np.nan)
    shape = (samples.gear.teeth, 2, n)
    centre: Floats = np.asarray(limits[0] + (np.arange(n) + 0.5) * width, dtype=np.float64)
    return Traces(
        along=along,
        band=band,
        step=width,
        centre=centre,
        station=station.reshape(shape),
        deviation=mean.reshape(shape),
        standard_error=error.reshape(shape),
        count=count.reshape(shape),
        across=np.where(seen, np.bincount(cell, across[inside], number) / safe, np.nan).reshape(shape),
    )


def _scatter(cell: Ints, delta: Floats, place: Floats, number: int) -> tuple[Floats, Floats]:
    """Squares and degrees of freedom of every bin about the means of its `STRATA` pieces across the band (`place` from 0 to 1).

    What changes across the band is the flank's shape, evenly sampled, and no uncertainty of the mean.
    """
    piece = cell * STRATA + np.minimum((place * STRATA).astype(np.int64), STRATA - 1)
    count = np.bincount(piece, minlength=number * STRATA)
    mean = np.bincount(piece, delta, number * STRATA) / np.maximum(count, 1)
    squares = np.bincount(cell, (delta - mean[piece]) ** 2, number)
    freedom = np.maximum(count - 1, 0).reshape(number, STRATA).sum(axis=1)
    return squares.astype(np.float64), freedom.astype(np.float64)


def _steady_variance(squares: Floats, freedom: Floats, noise: float) -> Floats:
    """Variance of one point per bin (flanks × bins), drawn towards its flank's own so that a bin of two points has a sane one."""
    prior = 6.0
    floor = noise**2 if np.isfinite(noise) else 0.0
    flank = (squares.sum(axis=1, keepdims=True) + prior * floor) / (freedom.sum(axis=1, keepdims=True) + prior)
    return np.asarray((squares + prior * flank) / (freedom + prior), dtype=np.float64)

"""Areal parameters of every flank, and of the mean flank: slopes, crownings and twist of one surface, and what departs from it locally.

A trace is a line on the flank or a mean over a band. Here the flank is evaluated as the surface it is: means of equal cells, and through
them, by least squares, a surface of second order. What that leaves has its deepest and its highest place: a pit that no trace crosses, and that
every mean over the face hides, is seen there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.inspection.estimate import DRAWS, Estimate, first_end, of_statistic
from gearwear.inspection.ranges import Range
from gearwear.inspection.registered import motion_errors
from gearwear.inspection.traces import USUAL_POINTS, FlankSamples

FEWEST_CELLS, MOST_CELLS = (4, 6), (32, 48)
"""Cells of the evaluated area along z and along L, of a thin scan and of a dense one; between them `USUAL_POINTS` points lie in a cell."""

LEAST_SEEN = 0.7
"""Share of the cells of a flank that must hold a point; with less the flank has no areal parameters."""

SURFACE_TERMS = 6
"""Coefficients of a surface of second order."""

LOCAL_POINTS = 4
"""Points of a cell that may be the deepest or the highest one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealParameters:
    """Parameters of surfaces, mm; estimates of any one shape.

    Parameters
    ----------
    profile_slope : Estimate
        Rise of the surface over the profile evaluation range, in the middle of the face; + is more material at the tip.
    helix_slope : Estimate
        Rise over the helix evaluation range, in the middle of the profile; signs as `evaluation` has them for traces.
    profile_crowning, helix_crowning : Estimate
        Height of the parabola over the evaluation range, + is more material in the middle.
    twist : Estimate
        Profile slope at the upper end of the helix evaluation range less that at the lower end, + is more material at the tip towards +z.
    """

    profile_slope: Estimate
    helix_slope: Estimate
    profile_crowning: Estimate
    helix_crowning: Estimate
    twist: Estimate

    def named(self) -> dict[str, Estimate]:
        """The parameters by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Areal:
    """Every flank as a surface; arrays are (teeth, 2), left first; nan where too little was seen.

    Parameters
    ----------
    profile_range, helix_range : Range
        Places along the profile (`ranges.profile_place`) and z of the evaluated area.
    flanks : ArealParameters
        Of every flank, (teeth, 2).
    mean : ArealParameters
        Of the mean flank of either side, (2,).
    roll, z : (n_L,), (n_z,) float
        Middle of the cells, mm.
    cells, cell_standard : (teeth, 2, n_z, n_L) float
        Deviation in the middle of each cell, the mean of its points led there along the surface of second order, and its standard uncertainty from
        noise, mm.
    mean_flank, mean_standard : (2, n_z, n_L) float
        Mean deviation of all flanks of a side about each flank's own level, and its standard uncertainty from noise, mm.
    lowest, highest : Estimate
        The most that a cell lies below (−) and above (+) the flank's own surface of second order, mm.
    lowest_at, highest_at : (teeth, 2, 2) float
        Where: L and z, mm.
    """

    profile_range: Range
    helix_range: Range
    flanks: ArealParameters
    mean: ArealParameters
    roll: Floats
    z: Floats
    cells: Floats
    cell_standard: Floats
    mean_flank: Floats
    mean_standard: Floats
    lowest: Estimate
    highest: Estimate
    lowest_at: Floats
    highest_at: Floats

    @property
    def cell_size(self) -> tuple[float, float]:
        """Along L and along z, mm."""
        return self.profile_range.length / len(self.roll), self.helix_range.length / len(self.z)


def evaluate_areal(samples: FlankSamples, profile: Range, helix: Range, noise: float, covariance: Floats | None = None) -> Areal:
    """Evaluate every flank as a surface.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    profile, helix : Range
        L and z of the evaluated area.
    noise : float
        Standard deviation of one point with what hangs together, mm.
    covariance : (6, 6) float or None
        Of the registration (`registered.motion_errors`); None: the pose is taken as known.

    Notes
    -----
    With u and v from −1 to 1 over the ranges, ``δ = a + ½ f_Hα u ± ½ f_Hβ v − c_α u² − c_β v² + ¼ S u v``, least squares over the cells' means
    (of δ and of every term alike), each cell with the same weight: a place that was scanned twice is no larger for that. The parameters are linear in
    the means, so their uncertainty is exact. Lowest and highest are greatest values of noisy numbers: `estimate.of_statistic`.
    """
    gear, area = samples.gear, (profile.ends, helix.ends)
    inside = samples.inside(*area)
    shape = _cells(inside)
    cells = _CellMeans.of(inside, profile, helix, shape)
    centre = surface_terms(*(index.ravel() for index in np.meshgrid(_middles(shape[1]), _middles(shape[0]))))
    sides = np.broadcast_to(np.array(Side, dtype=np.float64), (gear.teeth, 2))
    size = np.array([2.0, 2.0, -1.0, -1.0, 4.0])  # of the coefficients, in mm of each parameter
    values, spread = np.full((2, gear.teeth, 2, 5), np.nan)
    shared = None if covariance is None else np.full((gear.teeth, 2, 5, len(covariance)), np.nan)
    lowest, highest = (Estimate.empty((gear.teeth, 2)) for _ in range(2))
    lowest_at, highest_at = np.full((2, gear.teeth, 2, 2), np.nan)
    local, level = np.full(cells.mean.shape, np.nan), np.full((gear.teeth, 2), np.nan)
    moved = None
    if covariance is not None:
        roll, z = (
            r.middle + 0.5 * r.length * np.where(cells.seen, cells.terms[..., i], 0.0) for r, i in ((profile, 1), (helix, 2))
        )
        moved = motion_errors(gear, roll, z, covariance)
    normal = np.random.default_rng(0).standard_normal((DRAWS, cells.mean.shape[-1]))
    for flank in np.ndindex(gear.teeth, 2):
        seen = cells.seen[flank]
        if seen.mean() < LEAST_SEEN:
            continue
        columns = cells.terms[flank][seen]
        solve = np.linalg.pinv(columns)
        mean, error = cells.mean[flank][seen], noise / np.sqrt(cells.count[flank][seen])
        solution = solve @ mean
        values[flank], spread[flank] = size * solution[1:], np.abs(size) * np.sqrt((solve[1:] ** 2) @ error**2)
        if shared is not None and moved is not None:
            shared[flank] = size[:, None] * (solve[1:] @ moved[flank][seen])
        off = mean - columns @ solution
        local[flank][seen] = centre[seen] @ solution + off
        level[flank] = solution[0]
        known = cells.count[flank][seen] >= min(LOCAL_POINTS, int(np.median(cells.count[flank][seen])))
        way = first_end(cells.mean[flank].reshape(shape))
        errors = (normal.reshape(DRAWS, *shape)[:, ::way].reshape(DRAWS, -1)[:, seen] * error)[:, known]
        for sign, place, part in ((-1.0, lowest_at, lowest), (1.0, highest_at, highest)):
            at = int(np.argmax(np.where(known, sign * off, -np.inf)))
            estimate = of_statistic(_most, sign * off[known], errors)
            part.value[flank], part.standard[flank], part.noise[flank] = sign * estimate.value, estimate.standard, estimate.noise
            place[flank] = [r.middle + 0.5 * r.length * columns[at, i] for r, i in ((profile, 1), (helix, 2))]
    turned = np.stack([np.ones((gear.teeth, 2)), samples.hand * sides, *np.ones((3, gear.teeth, 2))], axis=-1)
    values = values * turned
    if shared is not None:
        shared = shared * turned[..., None]
    whole = local.reshape(gear.teeth, 2, *shape)
    middle = whole - level[..., None, None]
    count = np.isfinite(middle).sum(axis=0)
    standard = np.where(cells.seen, noise / np.sqrt(np.maximum(cells.count, 1)), np.nan).reshape(middle.shape)
    error = np.where(np.isfinite(middle), standard**2, 0.0).sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean_flank, mean_standard = (
            np.nansum(middle, axis=0) / np.where(count, count, np.nan),
            np.sqrt(error) / np.where(count, count, np.nan),
        )
    (first, last), (low, high) = area
    return Areal(
        profile_range=profile,
        helix_range=helix,
        flanks=_parameters(values, spread, shared),
        mean=_mean_of_flanks(values, spread, shared),
        roll=first + (np.arange(shape[1]) + 0.5) / shape[1] * (last - first),
        z=low + (np.arange(shape[0]) + 0.5) / shape[0] * (high - low),
        cells=whole,
        cell_standard=standard,
        mean_flank=mean_flank,
        mean_standard=mean_standard,
        lowest=lowest,
        highest=highest,
        lowest_at=lowest_at,
        highest_at=highest_at,
    )


def _most(values: Floats) -> Floats:
    """How far the highest stands above the surface."""
    return np.asarray(np.maximum(values.max(axis=-1), 0.0))


def surface_terms(u: Floats, v: Floats) -> Floats:
    """Terms of a surface of second order at places (n,) from −1 to 1, (n, `SURFACE_TERMS`)."""
    return np.column_stack([np.ones_like(u), u, v, u * u, v * v, u * v])


def _middles(number: int) -> Floats:
    """Middles of so many equal cells from −1 to 1."""
    return (2.0 * np.arange(number) + 1.0) / number - 1.0


@dataclass(frozen=True, slots=True)
class _CellMeans:
    """Mean deviation (teeth, 2, cells) and mean terms of the surface (teeth, 2, cells, 6) of every cell's points."""

    mean: Floats
    terms: Floats
    count: Ints

    @property
    def seen(self) -> Bools:
        return self.count > 0

    @classmethod
    def of(cls, samples: FlankSamples, profile: Range, helix: Range, shape: tuple[int, int]) -> _CellMeans:
        u, v = profile.from_middle(samples.roll), helix.from_middle(samples.z)
        j, i = (np.clip((0.5 * (x + 1.0) * n).astype(np.int64), 0, n - 1) for x, n in ((u, shape[1]), (v, shape[0])))
        cell = (samples.flank * shape[0] + i) * shape[1] + j
        number = 2 * samples.gear.teeth * shape[0] * shape[1]
        count = np.bincount(cell, minlength=number)
        means = [
            np.where(count, np.bincount(cell, values, number) / np.maximum(count, 1), np.nan)
            for values in (samples.deviation, *surface_terms(u, v).T)
        ]
        flanks = (samples.gear.teeth, 2, shape[0] * shape[1])
        return cls(means[0].reshape(flanks), np.stack(means[1:], axis=-1).reshape(*flanks, -1), count.reshape(flanks))


def _cells(samples: FlankSamples) -> tuple[int, int]:
    """Cells along z and along L, so many that the usual flank has `USUAL_POINTS` points in each."""
    share = math.sqrt(samples.per_flank / USUAL_POINTS / (MOST_CELLS[0] * MOST_CELLS[1]))
    n_z, n_roll = (int(np.clip(round(share * most), fewest, most)) for fewest, most in zip(FEWEST_CELLS, MOST_CELLS, strict=True))
    return n_z, n_roll


def _parameters(values: Floats, errors: Floats, shared: Floats | None) -> ArealParameters:
    """Of arrays whose last axis are the parameters (and behind it, of `shared`, the motions)."""
    names = [field.name for field in fields(ArealParameters)]
    return ArealParameters(**{
        name: Estimate.plain(values[..., i], errors[..., i], None if shared is None else shared[..., i, :]) for i, name in enumerate(names)
    })  # fmt: skip


def _mean_of_flanks(values: Floats, errors: Floats, shared: Floats | None) -> ArealParameters:
    """The mean flank's are the mean of the flanks': the parameters are linear in the surface."""
    count = np.isfinite(values).sum(axis=0).astype(np.float64)
    count[count == 0.0] = np.nan
    mean = np.nansum(values, axis=0) / count
    error = np.sqrt(np.nansum(errors**2, axis=0)) / count
    return _parameters(mean, error, None if shared is None else np.nansum(shared, axis=0) / count[..., None])

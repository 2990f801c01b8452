"""The worn flanks as smooth surfaces: what the mean of a cell says of them beyond its own noise.

Rigid contact lives on the highest places of a flank. Of cells whose noise is as large as the wear it would touch the noise, and two gears
would seem to lose nothing. So each flank takes the penalised least-squares surface (Eilers and Marx, P-splines; Wood, tensor products)

    minimise  Σ (y − f)² / σ² + λ_z Σ (D_z f)² + λ_L Σ (D_L f)²

with D second differences along z and along the profile; those along the profile leave a straight line over 1 / L alone, as sliding wear is
one. Both stiffnesses are those of greatest restricted likelihood of the flank itself. Flanks of a side are much alike, so it is their median
that is made smooth first, and then what each of them departs from it by: level, slopes and twist, which nothing penalises, then have the
variance that they show beyond their noise. Else each flank would have the noise of its own cells in them, and a range over all teeth shows
the flanks that happen to have most. In the eigenvectors of both penalties the
covariance is diagonal, so that surface, likelihood and posterior are closed forms; texture enters by its variance in each of them, as noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import ndimage

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.covariance import CellCovariance
from gearwear.placing.cells import CellGrid
from gearwear.placing.side_maps import infill
from gearwear.wear.least import correlation
from gearwear.wear.profiles import LEAST_ALIKE
from gearwear.wear.regions import Wear

DECADES = np.arange(-4.0, 9.0)
"""Stiffness, in units of 1 / noise variance, among which is searched; then to a third of a decade."""
PATCH_LIMIT_STDS = 4.0
"""Standard deviations of 3 × 3 means from which on a place is a patch of its own on a flank that else is like the others."""
PATCH_SOFTNESS_DECADES = 1.0
"""Decades by which a flank must be softer than its side's usual one before it is looked at for patches."""
MAX_PATCH_SHARE = 0.8
"""Share of a flank that a patch may take."""
MAX_ROUNDS = 20
MEDIAN_VARIANCE = 0.5 * np.pi
"""Times the variance of a mean that of a median."""


@dataclass(frozen=True, slots=True)
class WornSurface:
    """Depth of wear as a surface, and how it may as well be.

    Parameters
    ----------
    depth : (teeth, 2, rows, fillet + flank) float
        Missing depth along the normal, mm; 0 outside the worn regions. May be below zero by what the noise leaves.
    draws : (n, teeth, 2, rows, fillet + flank) float
        Surfaces drawn from its posterior distribution, mm.
    """

    depth: Floats
    draws: Floats


@dataclass(frozen=True, slots=True)
class _Modes:
    """Eigenvectors of both penalties, and the variance of noise in each pair of them."""

    along: Floats  # (rows, rows)
    across: Floats  # (columns, columns)
    bend: tuple[Floats, Floats]  # their eigenvalues
    noise: Floats  # (rows, columns), mm²
    free: Floats  # (rows, columns), mm²: variance of the surface where nothing is penalised; of what bends it is 1 / its penalty

    @classmethod
    def of(cls, rows: int, place: Floats, white: float, covariance: CellCovariance | None) -> _Modes:
        """For `rows` along z, and columns that leave straight lines over `place` alone; `white` is the noise of a cell, mm²."""
        a, along = _eigen(np.arange(float(rows)))
        b, across = _eigen(place)
        noise = np.full((rows, len(place)), white)
        if covariance is not None and covariance.texture > 0.0:
            steps = ((along, covariance.row_step), (across, covariance.column_step))
            shares = [np.einsum("ij,ik,kj->j", vectors, correlation(step, len(vectors)), vectors) for vectors, step in steps]
            noise = noise + covariance.texture * np.outer(*shares)
        return cls(along, across, (a, b), noise, np.full_like(noise, np.inf))

    def of_typical(self, flanks: int) -> _Modes:
        """Those of the median of so many flanks."""
        return replace(self, noise=MEDIAN_VARIANCE / flanks * self.noise)

    def of_departures(self, departures: Floats) -> _Modes:
        """Those of how far flanks differ from a typical one, (flanks, rows, columns) mm: where nothing is penalised they differ by as much as they
        scatter beyond their noise."""
        square = np.array([self.taken(one) for one in departures]) ** 2
        return replace(self, free=np.maximum(square.sum(axis=0) / (len(square) - 1) - self.noise, 0.0))

    def prior(self, stiffness: Floats) -> Floats:
        """Variance of the surface in each pair, mm²: (…, rows, columns) for log10 stiffness (…, 2)."""
        weight = 10.0**stiffness / self.noise.mean()
        bend = weight[..., :1, None] * self.bend[0][:, None] + weight[..., 1:, None] * self.bend[1]
        return np.where(bend > 0.0, 1.0 / np.maximum(bend, 1e-300), self.free)

    def stiffness(self, coefficients: Floats) -> Floats:
        """(2,) log10 stiffness along z and along the profile of greatest restricted likelihood."""
        square, steps = coefficients**2, DECADES
        best = np.zeros(2)
        for tried in (steps, np.array([-2, -1, 0, 1, 2]) / 3.0):
            pairs = best + np.stack(np.meshgrid(tried, tried, indexing="ij"), axis=-1).reshape(-1, 2)
            total = self.noise + self.prior(pairs)
            with np.errstate(invalid="ignore"):
                cost = np.where(np.isfinite(total), np.log(total) + square / total, 0.0).sum(axis=(1, 2))
            best = pairs[int(cost.argmin())]
        return np.asarray(best, dtype=np.float64)

    def taken(self, flank: Floats) -> Floats:
        """Coefficients of a flank."""
        return np.asarray(self.along.T @ flank @ self.across, dtype=np.float64)

    def surface(self, coefficients: Floats) -> Floats:
        """The flank of some coefficients."""
        return np.asarray(self.along @ coefficients @ self.across.T, dtype=np.float64)

    def typical(self, flanks: Floats, draws: int, random: np.random.Generator, way: int) -> Floats:
        """The surface that flanks (n, rows, columns) have in common, and so many drawn from what it may be; their mean depth stays. A median of
        cells is bent where flanks lean differently: so what nothing penalises is apart."""
        modes, taken = self.of_typical(len(flanks)), np.array([self.taken(one) for one in flanks])
        free = np.where(np.add.outer(*self.bend) > 0.0, 0.0, taken)
        bent = np.median([one - self.surface(own) for one, own in zip(flanks, free, strict=True)], axis=0)
        coefficients = np.median(free, axis=0) + self.taken(bent)
        kept = modes.kept(modes.stiffness(coefficients))
        surface = modes.surface(kept * coefficients)
        surface = surface + (flanks - surface).mean()
        return np.stack([surface, *(surface + modes.scattered(kept, random)[::way] for _ in range(draws))])

    def scattered(self, kept: Floats, random: np.random.Generator) -> Floats:
        """How a surface of which so much of each coefficient is kept may be off: the posterior's variance is noise · prior / (noise + prior)."""
        return self.surface(np.sqrt(kept * self.noise) * random.normal(size=kept.shape))

    def kept(self, stiffness: Floats) -> Floats:
        """Share of each coefficient that is surface."""
        prior = self.prior(stiffness)
        return np.where(np.isinf(prior), 1.0, prior / (np.where(np.isinf(prior), 0.0, prior) + self.noise))


def smooth_surface(
    wear: Wear, grid: CellGrid, noise: float, covariance: CellCovariance | None = None, draws: int = 0
) -> WornSurface:
    """Smooth the worn flanks.

    Parameters
    ----------
    wear : Wear
        Its regions stay as they are.
    grid : CellGrid
        The cells it was found on.
    noise : float
        Scatter of points, mm.
    covariance : CellCovariance or None
        Of what the closed loop leaves: texture is no wear. None: not known.
    draws : int
        How many surfaces to draw from the posterior.

    Returns
    -------
    WornSurface

    Notes
    -----
    Where one flank of a side is much rougher than is usual there, it may be so in one place: cells whose 3 × 3 means stand out of the surface
    of usual stiffness are taken as a patch, found by turns with the surface of the rest. The patch then has the flank's own stiffness.
    """
    side_maps, edges = wear.side_maps, grid.roll_edges
    depth = np.where(wear.mask, wear.depth, 0.0)
    drawn = np.repeat(depth[None], draws, axis=0)
    if not wear.mask.any():
        return WornSurface(depth, drawn)
    white = noise**2 * float((1.0 / np.maximum(side_maps.count[side_maps.seen], 1.0)).mean())
    measured = -infill(side_maps)
    # Draws belong to teeth counted from the most worn one, with the more worn side ahead: which tooth a pose calls the first, and which end is
    # up, must not change what scatters how far.
    first = int(np.argmax(depth.sum(axis=(1, 2, 3))))
    way = 1 if depth[:, 0].sum() >= depth[:, 1].sum() else -1
    parts = (
        (slice(0, side_maps.fillet), np.arange(float(side_maps.fillet))),
        (slice(side_maps.fillet, None), 2.0 / (edges[1:] + edges[:-1])),
    )
    zones = [rows for rows, _ in grid.zones]  # the halves of a double helical gear know nothing of each other
    for (zone, rows), (number, (part, place)), half in product(enumerate(zones), enumerate(parts), range(2)):
        modes = _Modes.of(rows.stop - rows.start, place, white, covariance)
        mask, values = wear.mask[:, half, rows, part], measured[:, half, rows, part]
        teeth = np.flatnonzero(mask.any(axis=(1, 2)))
        counted = (zone, number, half) if way > 0 else (len(zones) - 1 - zone, number, 1 - half)
        common = np.zeros((1 + draws, *values.shape[1:]))  # the surface they have in common, and drawn
        if len(teeth) >= LEAST_ALIKE:
            common = modes.typical(values[teeth], draws, np.random.default_rng((*counted, len(depth))), way)
            values = values - common[0]
            modes = modes.of_departures(values[teeth])
        stiffnesses = {tooth: modes.stiffness(modes.taken(values[tooth])) for tooth in teeth}
        usual = np.median(list(stiffnesses.values()), axis=0) if stiffnesses else np.zeros(2)
        typical = np.median(values[teeth], axis=(0, 1)) if len(teeth) else np.zeros(len(place))
        for tooth in teeth:
            random = np.random.default_rng((*counted, way * int(tooth - first) % len(depth)))
            for where, flank, stiffness in _pieces(modes, values[tooth], stiffnesses[tooth], usual, typical):
                worn, kept = where & mask[tooth], modes.kept(stiffness)
                surface = modes.surface(kept * modes.taken(flank))
                depth[tooth, half, rows, part][worn] = (common[0] + surface)[worn]
                for own, draw in zip(common[1:], drawn, strict=True):
                    other = own + surface + modes.scattered(kept, random)[::way]
                    draw[tooth, half, rows, part][worn] = other[worn]
    return WornSurface(depth, drawn)


def _pieces(
    modes: _Modes, flank: Floats, stiffness: Floats, usual: Floats, typical: Floats
) -> list[tuple[Bools, Floats, Floats]]:
    """Where on a flank which values and stiffness hold: all of it, or a patch and the rest."""
    everywhere = np.ones(flank.shape, dtype=bool)
    if (stiffness < usual - PATCH_SOFTNESS_DECADES).any():
        patch, rest = _patch(modes, flank, usual, typical)
        if patch.mean() < MAX_PATCH_SHARE:
            return [(~patch, rest, usual), (patch, flank, stiffness)]
    return [(everywhere, flank, stiffness)]


def _patch(modes: _Modes, flank: Floats, stiffness: Floats, typical: Floats) -> tuple[Bools, Floats]:
    """Cells that stand out of the rest of a flank, and the flank with the rest's surface in their place; from the side's `typical` profile."""
    size = (min(3, flank.shape[0]), 3)
    limit = PATCH_LIMIT_STDS * float(np.sqrt(modes.noise.mean() / (size[0] * size[1])))
    kept = modes.kept(stiffness)
    patch, rest = np.zeros(flank.shape, dtype=bool), np.broadcast_to(typical, flank.shape)
    for _ in range(MAX_ROUNDS):
        out = np.abs(ndimage.uniform_filter(flank - rest, size, mode="nearest")) > limit
        grown = ndimage.binary_dilation(out, np.ones((3, 3), dtype=bool))
        if (grown == patch).all() or grown.mean() > MAX_PATCH_SHARE:
            return grown, np.where(grown, rest, flank)
        patch = grown
        for _ in range(3):
            rest = modes.surface(kept * modes.taken(np.where(patch, rest, flank)))
    return patch, np.where(patch, rest, flank)


def second_differences(place: Floats) -> Floats:
    """(n − 2, n) second differences that vanish on straight lines over `place` (n,), with −2 in the middle; none for fewer than 3."""
    step = np.diff(place)
    result = np.zeros((max(len(place) - 2, 0), len(place)))
    for i in range(len(result)):
        both = step[i] + step[i + 1]
        result[i, i : i + 3] = 2.0 * step[i + 1] / both, -2.0, 2.0 * step[i] / both
    return result


def _eigen(place: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues and vectors of DᵀD. Those of the lines that it leaves alone are theirs in turn, with exactly 0, and each begins above 0: what is drawn
    along them is no library's choice."""
    differences = second_differences(place)
    values, vectors = np.linalg.eigh(differences.T @ differences)
    free = len(place) - len(differences)
    values[:free], vectors[:, :free] = 0.0, np.linalg.qr(np.vander(place, free, increasing=True))[0]
    return values, vectors * np.where(vectors[0] < 0.0, -1.0, 1.0)

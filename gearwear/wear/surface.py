"""The worn surface of a flank or a fillet as its cells show it: its volume, and how well that is known, by one criterion.

The surface is a quadratic spline with one coefficient c to a cell and one beyond each edge. The mean y of the points of a cell is that of the
spline where they lie, y = B c + e with var e = 1 / W. Before anything is seen the surface bends and leans little: c is Gaussian with the precision
of a spline in tension (Mitasova and Mitas 1993; as a Markov field: Rue and Held 2005, ch. 3),

    Q = τ (κ² L + L²),   L = s L_z + L_p / s,

L_z and L_p the second differences of the coefficients along the face and along the profile, no flow over the edges; the level is free. What has the size
1 along the profile has the size s along the face: sliding wear is alike along the face, scoring along the profile. With A = Q + BᵀWB the expected surface
is A⁻¹ BᵀW y. Stiffness τ, tension κ² and stretch s are those of greatest restricted likelihood of the side itself,

    −2 log likelihood = log|A| − log|Q| + yᵀWy − yᵀWB A⁻¹ BᵀWy,   log|Q| over what Q penalises: the cosines of both ways.

Few cells leave open how stiff the surface is: then every τ and κ² of the search counts with its share of the likelihood, s = 1, and that their surfaces
differ is in what is not known.

A volume is aᵀc. With u = A⁻¹ a it gives each cell's mean the weight W B u, through which the errors of the cells enter like those of every weighted
sum. That the surface between the points, at steep edges and in holes, is not the expected one adds, independent of them, the variance

    aᵀ A⁻¹ a − uᵀ BᵀWB u = uᵀ Q u.

The deepest place is no weighted sum. Surfaces drawn from N(c, A⁻¹) each have theirs: their mean and scatter are what is known of it. Where much is alike
every draw finds another deepest place by chance, and where one place stands out all find that: nothing need be taken off for having looked.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.lib.stride_tricks import as_strided
from scipy import sparse
from scipy.linalg import cho_solve_banded
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpbtrf, dtbtrs

from gearwear.arrays import Bools, Floats, Ints
from gearwear.wear.stiffness import (
    AsStiff,
    Stiffness,
    likeliest,
    likeliest_of_cosines,
    path_eigenvalues,
    penalised,
    shares_of_likelihood,
)

DRAWS, PLACES = 200, 2
"""Surfaces that are drawn, and places of a window to a cell."""
BETWEEN = 1e-6
"""Cells by which the middle of a window may miss the border between two and still lie on it; numerical."""
FEWEST_SEEN = 4
"""Cells that must hold points for a side to have a surface."""
FEW_SEEN = 20
"""Cells below which they leave open how stiff it is; from there on the likeliest stiffness stands for all."""


@dataclass(frozen=True, slots=True)
class _AsStiff:
    """The surface that is expected of one stiffness.

    Parameters
    ----------
    share : float
        Of the likelihood of all stiffnesses that count.
    stiffness : Stiffness
    factor : (bands, n) float
        Cholesky factor of A, lower bands.
    expected : (n,) float
        c, from the level.
    """

    share: float
    stiffness: Stiffness
    factor: Floats
    expected: Floats

    def solve(self, right: Floats) -> Floats:
        """A⁻¹ times `right`, (n,) or (n, k)."""
        return np.asarray(cho_solve_banded((self.factor, True), right, check_finite=False), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class SideSurface:
    """The expected surface of a flank or a fillet.

    Parameters
    ----------
    value : (rows, columns) float
        Mean of the expected deviation over each cell, mm.
    seen : (rows, columns) bool
        Cells whose points it was made from.
    at : (m, n) sparse
        B of these cells.
    weight : (m,) float
        W, mm⁻².
    ways : tuple of _AsStiff
        As stiff as it may be; shares add up to 1.
    level : float
        mm.
    """

    value: Floats
    seen: Bools
    at: sparse.csr_array
    weight: Floats
    ways: tuple[_AsStiff, ...]
    level: float

    @classmethod
    def of(
        cls,
        mean: Floats,
        count: Floats,
        variance: Floats,
        offset: Floats,
        worn: Bools,
        about: SideSurface | None = None,
        fewest: int = FEWEST_SEEN,
        as_stiff: AsStiff | None = None,
    ) -> SideSurface | None:
        """The surface through the means of cells; None where too few hold points.

        Parameters
        ----------
        mean : (rows, columns) float
            mm; nan where there is none.
        count : (rows, columns) float
            Points in each cell.
        variance : (rows, columns) float
            Of the means by their errors, mm².
        offset : (2, rows, columns) float
            Where the points of a cell lie on average from its centre, along z and along the profile, in cells.
        worn : (rows, columns) bool
            Cells that say how stiff the surface is.
        about : SideSurface or None
            What it is expected to be before its cells are seen, but for a level; None: flat.
        fewest : int
            Cells that must hold points for there to be a surface, and be worn to say alone how stiff it is.
        as_stiff : AsStiff or None
            How stiff it is, where that is known; None: as its cells say.
        """
        seen = np.isfinite(mean)
        if seen.sum() < fewest:
            return None
        weight = 1.0 / variance[seen]
        at, usual = _at_points(seen, offset, count), float(np.median(weight))
        before = np.zeros(at.shape[1]) if about is None else about.expected + about.level
        value = mean[seen] - at @ before
        level = float(weight @ value / weight.sum())
        value = value - level

        # As stiff as it is where it is worn: a hollow in a flat flank is steeper than the flank.
        inside = worn[seen] if worn[seen].sum() >= fewest else np.ones(len(weight), dtype=bool)
        told = np.where(inside, weight, 0.0)
        bands, pull = 2 * min(_coefficients(mean.shape)) + 3, at.T @ (told * value)
        banded = _information(at, told, bands)

        def cost(stiffness: Stiffness) -> float:
            triangle = _cholesky(_precision(banded, mean.shape, usual, stiffness))
            half = dtbtrs(triangle, pull, uplo="L")[0]
            own = float(np.log(usual * penalised(_differences(mean.shape)[2], stiffness)).sum())
            return 2.0 * float(np.log(triangle[0]).sum()) - own - float(half @ half)

        if as_stiff is not None:
            likely = dict(as_stiff)
        elif inside.sum() >= FEW_SEEN:
            likely = {likeliest(cost, likeliest_of_cosines(seen, value, usual)): 1.0}
        else:
            likely = shares_of_likelihood(cost)
        if not inside.all():
            banded = _information(at, weight, bands)
        ways = []
        for stiffness, share in likely.items():
            triangle = _cholesky(_precision(banded, mean.shape, usual, stiffness))
            expected = before + cho_solve_banded((triangle, True), at.T @ (weight * value), check_finite=False)
            ways.append(_AsStiff(share, stiffness, triangle, expected))
        expected = _mean(ways, [way.expected for way in ways])
        value = (_over_cells(mean.shape) @ expected).reshape(mean.shape) + level
        return cls(value, seen, at, weight, tuple(ways), level)

    @property
    def as_stiff(self) -> AsStiff:
        """How stiff it is."""
        return {way.stiffness: way.share for way in self.ways}

    @property
    def expected(self) -> Floats:
        """(n,) c, from the level, mm."""
        return _mean(self.ways, [way.expected for way in self.ways])

    def shares(self, area: Floats) -> tuple[Floats, float]:
        """What each cell's mean weighs in the integral over `area` (rows, columns), mm², and the variance that the surface itself adds, mm⁶."""
        weights, hidden = self.passed_on((_over_cells(area.shape).T @ area.ravel())[None])
        return weights[0], max(float(hidden[0, 0]), 0.0)

    def left_to_before(self, area: Floats) -> Floats:
        """(n,) what the coefficients that it was expected to have weigh in the integral over `area` (rows, columns), mm²: a − BᵀWB A⁻¹ a."""
        wanted = _over_cells(area.shape).T @ area.ravel()
        u = _mean(self.ways, [way.solve(wanted) for way in self.ways])
        return np.asarray(wanted - self.at.T @ (self.weight * (self.at @ u)), dtype=np.float64)

    def passed_on(self, wanted: Floats) -> tuple[Floats, Floats]:
        """What each cell's mean weighs in sums of the coefficients of which each weighs `wanted` (k, n), (k, rows, columns), and the covariance of these
        by what the surface does not know, (k, k): of each stiffness, and of which it is."""
        weights, hidden, off = np.zeros((len(wanted), *self.seen.shape)), [], []
        expected, each = self.expected, []
        for way in self.ways:
            u = way.solve(wanted.T)
            placed = (self.at @ u).T
            each.append(self.weight * placed)
            hidden.append(wanted @ u - placed @ (self.weight * placed).T)
            off.append(wanted @ (way.expected - expected))
        weights[:, self.seen] = _mean(self.ways, each)
        apart = _mean(self.ways, [np.outer(one, one) for one in off])
        return weights, np.asarray(_mean(self.ways, hidden) + apart, dtype=np.float64)

    def deepest(self, window: tuple[float, float], inside: Bools) -> tuple[float, float]:
        """Least mean over a window, mm, and its standard deviation.

        Parameters
        ----------
        window : (float, float)
            Rows and columns, in cells; a sheet that is smaller counts whole.
        inside : (rows, columns) bool
            Cells in which the middle of the window may lie; nan where none of them does.
        """
        ways = [_over_windows(count, wide) for count, wide in zip(inside.shape, window, strict=True)]
        (rows, along), (columns, across) = ways
        there: Bools = np.asarray(np.any([inside[np.ix_(row, column)] for row, column in product(rows, columns)], axis=0))
        if not there.any():  # narrower than half a window, at an edge: no window has its middle there
            return np.nan, np.nan
        drawn = _on_sheet(self._drawn(inside.shape), inside.shape)
        # A window of coefficients that all lie above the mean of the one that is expected to be the deepest is the least of no draw.
        expected = along @ _on_sheet(self.expected, inside.shape) @ across.T
        row, column = np.unravel_index(int(np.where(there, expected, np.inf).argmin()), there.shape)
        known, lowest = across[column] @ np.tensordot(along[row], drawn, 1), drawn.min(axis=0)
        kept = [bool((lowest[window > 0.0].min(axis=0) <= known).any()) for window in across]
        used = across[kept].any(axis=0)
        across, there, drawn = across[kept][:, used], there[:, kept], drawn[:, used]
        by_rows = (sparse.csr_array(along) @ drawn.reshape(len(drawn), -1)).reshape(len(along), -1, DRAWS)
        least = np.full(DRAWS, np.inf)
        # Row by row: all windows of all draws are larger than the rest of a comparison's work.
        for over, middles in zip(by_rows, there, strict=True):
            if middles.any():
                np.minimum(least, (across[middles] @ over).min(axis=0), out=least)
        least += self.level
        return float(least.mean()), float(least.std())

    def along(self, columns: Floats) -> Floats:
        """Coefficients of drawn surfaces on lines along the face, (k, `DRAWS`, n) mm, at places (k,) counted in columns: on the lines the surfaces have
        ``at_places(rows, places)`` times as much."""
        drawn = _on_sheet(self._drawn(self.seen.shape), self.seen.shape)
        of_rows = np.tensordot(at_places(self.seen.shape[1], columns), drawn, axes=(1, 1))
        return np.ascontiguousarray(np.moveaxis(of_rows, 1, 2)) + self.level

    def _drawn(self, shape: tuple[int, ...]) -> Floats:
        """Coefficients of surfaces from N(c, A⁻¹), without the level, (n, `DRAWS`), of each stiffness its share; half of them from either end of the face:
        which comes first does not matter."""
        turned, random = _from_other_end(shape), _random(self.at.shape[1])
        information, usual = _information(self.at, self.weight, len(self.ways[0].factor), turned), float(np.median(self.weight))
        ends = np.rint(np.cumsum([way.share for way in self.ways]) * random.shape[1]).astype(np.int64)
        drawn, start = np.empty((len(random), DRAWS)), 0
        for way, half in zip(self.ways, np.split(random, ends[:-1], axis=1), strict=True):
            if not half.size:
                continue
            from_above = _cholesky(_precision(information, shape, usual, way.stiffness))
            for off in (_from_below(way.factor, half), _from_below(from_above, half)[turned]):
                np.add(off, way.expected[:, None], out=drawn[:, start : start + half.shape[1]])
                start += half.shape[1]
        return drawn


def _mean(ways: Sequence[_AsStiff], values: Sequence[Floats]) -> Floats:
    """Of what each of `ways` makes of something, by their shares."""
    return np.asarray(sum(way.share * value for way, value in zip(ways, values, strict=True)), dtype=np.float64)


@lru_cache(maxsize=2)
def _random(number: int) -> Floats:
    """(number, `DRAWS` / 2) draws from N(0, 1), read-only, the same for all surfaces of one size."""
    draws = np.random.default_rng(0).normal(size=(number, DRAWS // 2))
    draws.setflags(write=False)
    return draws


def _from_other_end(shape: tuple[int, ...]) -> Ints:
    """(n,) number that each coefficient has where the rows are counted from the other end of the face."""
    number = _numbers(shape)
    return np.asarray(number[::-1].ravel()[np.argsort(number, axis=None)])


@lru_cache(maxsize=16)
def _over_windows(count: int, wide: float) -> tuple[tuple[Ints, Ints], Floats]:
    """Windows of so many cells in a row of `count`, `PLACES` to a cell: (k,) twice the cells in which their middles lie, two where one lies between
    them, and (k, n) their means of the spline."""
    if count == 1:
        return (np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)), np.ones((1, 1))
    wide = min(wide, float(count))
    middle = np.linspace(0.5 * wide, count - 0.5 * wide, max(math.ceil(PLACES * (count - wide)), 1) + 1)
    centre = np.arange(count + 2) - 0.5

    def area(at: Floats) -> Floats:
        """Of one coefficient's parabolas up to a place, in cells from its middle."""
        t = np.clip(at, -1.5, 1.5)
        outer = (1.5 - np.abs(t)) ** 3 / 6.0
        inner = 0.5 + 0.75 * t - t**3 / 3.0
        return np.where(np.abs(t) <= 0.5, inner, np.where(t < 0.0, outer, 1.0 - outer))

    ends = [area(middle[:, None] + sign * 0.5 * wide - centre) for sign in (1.0, -1.0)]
    cells = (np.floor(middle + BETWEEN).astype(np.int64), np.ceil(middle - BETWEEN).astype(np.int64) - 1)
    return (cells[0].clip(0, count - 1), cells[1].clip(0, count - 1)), np.asarray((ends[0] - ends[1]) / wide, dtype=np.float64)


def at_places(count: int, places: Floats) -> Floats:
    """What each of the coefficients of a row of `count` cells weighs at places (k,) counted in cells, (k, n)."""
    if count == 1:
        return np.ones((len(places), 1))
    at = np.clip(places, 0.0, count)
    cell = np.minimum(at.astype(np.int64), count - 1)
    off, weights = at - cell - 0.5, np.zeros((len(at), count + 2))
    weights[np.arange(len(at))[:, None], cell[:, None] + np.arange(3)] = np.column_stack(_spline(off, off**2))
    return weights


def _coefficients(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Coefficients along each way: one more at either end, but in a single row."""
    return tuple(count + 2 if count > 1 else 1 for count in shape)


def _numbers(shape: tuple[int, ...]) -> Ints:
    """Number of each coefficient, the shorter way first: so bands are narrow."""
    count = _coefficients(shape)
    number = np.arange(count[0] * count[1])
    return number.reshape(count) if count[1] <= count[0] else number.reshape(count[::-1]).T


def _on_sheet(values: Floats, shape: tuple[int, ...]) -> Floats:
    """Values (n, …) of the coefficients by rows and columns, (rows, columns, …), where they lie: nothing is copied."""
    count, each = _coefficients(shape), values.shape[1:]
    return values.reshape(*count, *each) if count[1] <= count[0] else values.reshape(*count[::-1], *each).swapaxes(0, 1)


def _spline(off: Floats, square: Floats) -> tuple[Floats, Floats, Floats]:
    """What the three coefficients about a cell weigh at a place `off` its middle, whose square is `square` (of several, their means), in cells."""
    return 0.5 * (0.25 - off + square), 0.75 - square, 0.5 * (0.25 + off + square)


def _at_points(seen: Bools, offset: Floats, count: Floats) -> sparse.csr_array:
    """B, (m, n): the spline's mean over the points of each seen cell."""
    number, cell = _numbers(seen.shape), np.arange(int(seen.sum()))
    ways = []
    for axis, place in enumerate(np.nonzero(seen)):
        if seen.shape[axis] == 1:
            ways.append([(place, np.ones(len(cell)))])
            continue
        off = offset[axis][seen]
        # Points about their mean: as they scatter that lie anywhere in a cell.
        square = off**2 + (1.0 - 1.0 / np.maximum(count[seen], 1.0)) / 12.0
        ways.append([(place + i, weight) for i, weight in enumerate(_spline(off, square))])
    parts = [(number[row, column], a * b) for row, a in ways[0] for column, b in ways[1]]
    which, share = (np.concatenate(parts) for parts in zip(*parts, strict=True))
    return sparse.csr_array((share, (np.tile(cell, len(parts)), which)), shape=(len(cell), number.size))


@lru_cache(maxsize=8)
def _over_cells(shape: tuple[int, int]) -> sparse.csr_array:
    """(cells, n): the spline's mean over each cell, 1/6, 2/3, 1/6 of three coefficients along each way."""
    ways = [
        sparse.diags_array([1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0], offsets=[0, 1, 2], shape=(count, count + 2))
        if count > 1
        else sparse.eye_array(1)
        for count in shape
    ]
    order = np.argsort(_numbers(shape).ravel())
    return sparse.csr_array(sparse.csc_array(sparse.kron(*ways))[:, order])


@lru_cache(maxsize=8)
def _differences(shape: tuple[int, ...]) -> tuple[Ints, Floats, tuple[Floats, Floats]]:
    """Which bands of L_z, L_p, L_z², 2 L_z L_p and L_p² are not all zeros, (k,), counted from the diagonal down; these, (5, k, n); and the eigenvalues
    of L_z and of L_p."""
    rows, columns = _coefficients(shape)
    z = sparse.kron(_path(rows), sparse.eye_array(columns))
    p = sparse.kron(sparse.eye_array(rows), _path(columns))
    order, number = _numbers(shape).ravel(), min(2 * min(rows, columns) + 3, rows * columns)
    bands = np.stack([_lower(sparse.csr_array(one), number, order) for one in (z, p, z @ z, 2.0 * (z @ p), p @ p)])
    which = np.flatnonzero(bands.any(axis=(0, 2)))
    return which, np.ascontiguousarray(bands[:, which]), path_eigenvalues(rows, columns)


def _precision(information: Floats, shape: tuple[int, ...], usual: float, stiffness: Stiffness) -> Floats:
    """A = Q + BᵀWB, lower bands, of BᵀWB; Q where the cells weigh `usual`."""
    s, tension = stiffness.stretch, stiffness.tension
    factors = usual * stiffness.stiffness * np.array([tension * s, tension / s, s**2, 1.0, s**-2])
    which, differences, _ = _differences(shape)
    precision = information.copy(order="F")
    precision[which] += np.tensordot(factors, differences, 1)
    return precision


def _path(number: int) -> sparse.csr_array:
    """Laplacian of so many in a row."""
    step = sparse.csr_array(np.diff(np.eye(number), axis=0))
    return sparse.csr_array(step.T @ step)


def _information(at: sparse.csr_array, weight: Floats, number: int, order: Ints | None = None) -> Floats:
    """BᵀWB, lower bands, (number, n), mm⁻²; coefficients numbered by `order` (n,), where that is given.

    The coefficients of all cells lie to each other in one order: which pairs are at or below the diagonal the first cell tells.
    """
    m, n = at.shape
    share, column = at.data.reshape(m, -1), at.indices.reshape(m, -1)
    column = column if order is None else order[column]
    rising = np.argsort(column[0])
    low, high = (rising[one] for one in np.triu_indices(len(rising)))
    place = column[:, low] * (number - 1) + column[:, high]  # a column's bands lie together
    values = share[:, high] * (weight[:, None] * share)[:, low]
    summed = np.bincount(place.ravel(), values.ravel(), minlength=n * number)[: n * number]
    return np.asarray(summed.reshape(n, number).T, dtype=np.float64)


def _cholesky(bands: Floats) -> Floats:
    """Cholesky factor of a positive definite matrix, both as lower bands, (number, n); in place of the matrix."""
    triangle, failed = dpbtrf(bands, lower=1, overwrite_ab=1)
    if failed:
        raise np.linalg.LinAlgError("the precision of a surface is not positive definite")
    return np.asarray(triangle, dtype=np.float64)


def _from_below(triangle: Floats, right: Floats) -> Floats:
    """x (n, k) with Lᵀ x = `right`, L given as lower bands: block by block as wide as the bands, which takes half the time of LAPACK's column by
    column."""
    n, wide = triangle.shape[1], max(triangle.shape[0] - 1, 1)
    count, x = -(-n // wide), right.copy()
    held = np.zeros((count * wide, wide + 1))
    held[:n] = triangle.T
    # The blocks where they lie: an element below or right of the bands is another's.
    steps = (held.itemsize * wide * (wide + 1), held.itemsize, held.itemsize * wide)
    own, below = (as_strided(held.ravel()[first:], (count, wide, wide), steps) for first in (0, wide))
    below = np.multiply(below, np.tri(wide).T, order="C")
    for i in range(count - 1, -1, -1):
        rows, beyond = x[i * wide : (i + 1) * wide], x[(i + 1) * wide : (i + 2) * wide]
        if len(beyond):
            rows -= below[i, : len(beyond)].T @ beyond
        dtrsm(1.0, own[i, : len(rows), : len(rows)], rows.T, side=1, lower=1, overwrite_b=1)
    return x


def _lower(matrix: sparse.csr_array, number: int, order: Ints | None = None) -> Floats:
    """Lower bands of a symmetric matrix, (number, n): the diagonal first; its rows and columns numbered by `order` (n,), where that is given."""
    row, column = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr)), matrix.indices
    if order is not None:
        row, column = order[row], order[column]
    band = row - column
    held = (band >= 0) & (band < number)
    bands = np.zeros((number, matrix.shape[1]), order="F")
    bands[band[held], column[held]] = matrix.data[held]
    return bands

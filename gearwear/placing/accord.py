"""Whether several views of one gear agree: where each lies, how high its surface, and how large it shows the gear, against the others.

What is seen in cell c by view i is ``v_ic = m_c + a_ic · x_i + e_ic``: the metal there, whatever the design says of it; what is the view's own, to first
order – a small motion of it (6), an offset of its surface, a scale – times its columns; and noise. The metal is free in every cell, so cells that one view
saw tell nothing, and cells that k views saw tell k − 1 numbers: what is between the views.

- **Told by overlaps**: differences ``x_i − x_j`` of motion, offset and scale, and what is left in a view beyond these.
- **Not told**: the sum over the views of each freedom, for ``m_c + a_c · x`` is a metal as well as m_c. Motion common to all is the pose of the whole, which
  the design tells; a common offset is a coat and a common scale the scanner's, which the loop looks for. If more than half of the views agree in an offset
  or a scale, it is stated against their mean, and the others are wrong. Of two views that differ, and of halves, which is wrong is not told: then it is
  stated against the median.
- **Told by the design, view by view**: each view's own place, offset and scale by its own fit, with what wear and cutting errors do to that; less
  well, but without overlaps too. The drawing's errors are in those of all views alike: only their differences count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.surface import END_LOW
from gearwear.placing.cells import Cells
from gearwear.placing.datum import choose_datum
from gearwear.placing.least_squares import clustered
from gearwear.robust import median_scale, tukey_slope, tukey_weight

STDS = 5.0
"""Standard deviations by which a view must be off the others to be called so."""
FEWEST_CELLS = 100
"""Cells that a view must share with others for anything to be said of it."""
CHANCE = 6.0
"""Standard deviations by which means of flanks must scatter more than chance for a view to be called torn."""
PASSES = 12
HELD = 10.0
"""Numerical: how firmly the sums are held, in what all cells together say."""
OWN = 8
"""Freedoms of a view: six of motion, its offset, its scale."""
OFFSET, SCALE = 6, 7
"""Where the last two stand."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewAccord:
    """A view against the others, where they overlap.

    Parameters
    ----------
    shared : int
        Cells that others saw too; with too few nothing is said, and the rest is 0.
    scale, scale_std : float
        How much larger it shows the gear than a typical view, relative.
    offset, offset_std : float
        How far its surface stands above that of a typical view, its place and scale apart, mm.
    place, place_std : float
        Root mean square over its cells of what its place is off against the others, and of how well that is known, mm.
    size : float
        Root mean square over its cells of what its scale makes there, mm.
    residual : float
        What is left between it and the others, beyond place, offset and scale: root mean square, mm.
    torn : float
        The part of it that flanks have in common and noise does not make, root mean square, mm; 0 where it may be chance.
    own_scale, own_scale_std : float
        How much larger than designed its own fit to the design shows the gear, relative; 0 and infinite where that is not told.
    own_offset, own_offset_std : float
        How far above the design its surface stands by that fit, mm.
    reach : float
        What a scale makes in its cells on flanks and lands, its mean apart: root mean square, mm per unit.
    """

    shared: int
    scale: float = 0.0
    scale_std: float = 0.0
    offset: float = 0.0
    offset_std: float = 0.0
    place: float = 0.0
    place_std: float = 0.0
    size: float = 0.0
    residual: float = 0.0
    torn: float = 0.0
    own_scale: float = 0.0
    own_scale_std: float = np.inf
    own_offset: float = 0.0
    own_offset_std: float = np.inf
    reach: float = 0.0

    @property
    def enough(self) -> bool:
        """Whether it shares enough cells to be judged by the other views."""
        return self.shared >= FEWEST_CELLS and self.scale_std > 0.0


@dataclass(frozen=True, slots=True)
class Accords:
    """Views of one gear against each other.

    Parameters
    ----------
    views : tuple of ViewAccord
    solution : (8 n,) float
        Motion (mm, rad), offset (mm) and scale of each view in turn, their sums zero.
    covariance : (8 n, 8 n) float
        Of these.
    information : (8 n, 8 n) float
        What the overlaps say of them, the sums not held.
    """

    views: tuple[ViewAccord, ...]
    solution: Floats
    covariance: Floats
    information: Floats

    @property
    def freedoms(self) -> Floats:
        """(n, 8) the solution, view by view."""
        return self.solution.reshape(-1, OWN)

    def own(self, view: int) -> Floats:
        """(8, 8) covariance of one view's freedoms."""
        its = slice(OWN * view, OWN * (view + 1))
        return self.covariance[its, its]

    def contrast(self, at: int, weights: Floats) -> tuple[float, float]:
        """A sum over the views of one freedom by weights (n,), and its standard deviation."""
        value, spread = self.freedoms[:, at], self.covariance[at::OWN, at::OWN]
        return float(weights @ value), float(np.sqrt(max(float(weights @ spread @ weights), 0.0)))


def view_accords(views: Sequence[Cells], noise: float, ignore: frozenset[int] = frozenset()) -> Accords:
    """Place, offset and scale of all views together.

    Parameters
    ----------
    views : sequence of Cells
        Each view alone, on the same grid.
    noise : float
        Scatter of points, mm.
    ignore : frozenset of int
        Codes of surfaces that are no datum.

    Notes
    -----
    Of every cell that several views saw the weighted mean is taken off; what is left is fitted by robust least squares, the sum over the views of each
    freedom held at zero. Errors that neighbouring cells share – fringes, a view stitched of pieces – make the covariance too small: it is raised by what
    the means of whole flanks scatter more than their cells do.
    """
    seen = np.array([view.seen & np.isfinite(view.points.deviation) for view in views])
    shared = seen & (seen.sum(axis=0) > 1) & (views[0].points.surface < END_LOW)
    enough = shared.sum(axis=1) >= FEWEST_CELLS
    alone = [_alone(view, int(number), noise, ignore) for view, number in zip(views, shared.sum(axis=1), strict=True)]
    if enough.sum() < 2:
        empty = np.zeros((OWN * len(views),) * 2)
        return Accords(tuple(alone), np.zeros(OWN * len(views)), empty, empty)
    cells = np.flatnonzero(shared.any(axis=0))
    count = np.where(shared, np.array([view.count for view in views]), 0.0)[:, cells]
    value = np.nan_to_num(np.array([view.points.deviation for view in views]))[:, cells]
    total = np.maximum(count.sum(axis=0), 1.0)
    columns = [_columns(view, cells) for view in views]
    blocks, targets, weights, owner, flank = [], [], [], [], []
    flanks = views[0].part[cells]
    for i, columns_of_view in enumerate(columns):
        at = count[i] > 0.0
        block = np.zeros((int(at.sum()), OWN * len(views)))
        for j, other in enumerate(columns):
            part = (float(i == j) - count[j, at] / total[at])[:, None]
            block[:, OWN * j : OWN * (j + 1)] = part * (columns_of_view if i == j else other)[at]
        blocks.append(block)
        targets.append(value[i, at] - (value[:, at] * count[:, at]).sum(axis=0) / total[at])
        weights.append(count[i, at])
        owner.append(np.full(int(at.sum()), i))
        flank.append(flanks[at])
    a, y, w, of = np.vstack(blocks), np.concatenate(targets), np.concatenate(weights), np.concatenate(owner)
    solution, covariance, information, share = _fitted(a, y, w, noise)
    rest = y - a @ solution
    torn, raised = _torn(rest, w * share, of, np.concatenate(flank), len(views))
    accords = Accords((), solution, raised * covariance, information / raised)
    against = [np.eye(len(views)) - _typical(accords, at, enough) for at in (OFFSET, SCALE)]
    told = [
        _accord(alone[i], accords, columns[i][count[i] > 0.0], rest[of == i], i, (against[0][i], against[1][i]), torn[i])
        if enough[i]
        else alone[i]
        for i in range(len(views))
    ]
    return Accords(tuple(told), accords.solution, accords.covariance, accords.information)


def _typical(accords: Accords, at: int, enough: Bools) -> Floats:
    """(n,) weights of the views in what is typical of a freedom: those alike that agree with the median, if more than half do; else the median's."""
    values = accords.freedoms[:, at]
    std = np.sqrt(np.maximum(np.diag(accords.covariance).reshape(-1, OWN)[:, at], 0.0))
    order = np.argsort(np.where(enough, values, np.inf))[: int(enough.sum())]
    middle = order[(len(order) - 1) // 2 : len(order) // 2 + 1]
    agree = enough & (np.abs(values - values[middle].mean()) <= STDS * std)
    weights = np.zeros(len(values))
    if 2 * agree.sum() <= enough.sum():
        weights[middle] = 1.0 / len(middle)
    else:
        weights[agree] = 1.0 / agree.sum()
    return weights


def _columns(view: Cells, cells: Ints) -> Floats:
    """Motion, offset and scale on some cells, (k, 8)."""
    points = view.points
    size = (points.position * points.normal).sum(axis=1)
    return np.asarray(np.nan_to_num(np.column_stack([view.motion, np.ones(len(size)), size])[cells]), dtype=np.float64)


def _fitted(a: Floats, y: Floats, weight: Floats, noise: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Robust least squares with the sum over the views of each freedom held at zero; with covariance, information, and the weights that cells got."""
    size = np.tile(np.sqrt((a**2).mean(axis=0)).reshape(-1, OWN).mean(axis=0), a.shape[1] // OWN)
    size[size == 0.0] = 1.0
    a = a / size
    held = HELD * float(weight.sum()) * np.kron(np.ones((a.shape[1] // OWN,) * 2), np.eye(OWN))
    share = np.ones(len(y))
    normal: Floats = np.zeros((a.shape[1], a.shape[1]))
    inverse, solution = normal, np.zeros(a.shape[1])
    for _ in range(PASSES):
        w = weight * share
        normal = np.asarray(a.T @ (a * w[:, None]), dtype=np.float64)
        inverse = np.asarray(np.linalg.pinv(normal + held, rcond=1e-12, hermitian=True), dtype=np.float64)
        solution = np.asarray(inverse @ (a.T @ (w * y)), dtype=np.float64)
        residual = (y - a @ solution) * np.sqrt(weight)
        scale = max(median_scale(residual)[1], noise)
        share = tukey_weight(residual, scale)
    both = np.outer(size, size)
    return np.asarray(solution / size), np.asarray(scale**2 * inverse / both), np.asarray(normal * both / scale**2), share


def _torn(rest: Floats, weight: Floats, of: Ints, flank: Ints, views: int) -> tuple[Floats, float]:
    """(views,) what means of whole flanks are off beyond chance, RMS, mm; and by how much the variance of what flanks share exceeds that of cells, ≥ 1.

    Parameters
    ----------
    rest, weight : (n,) float
        What is left of each cell, mm, and its weight: points, as far as it is no outlier.
    of, flank : (n,) int
        View and flank of each.
    views : int
    """
    torn, ratios, numbers = np.zeros(views), np.ones(views), np.ones(views)
    for i in range(views):
        at = (of == i) & (weight > 0.0)
        _, label = np.unique(flank[at], return_inverse=True)
        count, r, w = np.bincount(label), rest[at], weight[at]
        total = np.bincount(label, w)
        mean = np.bincount(label, w * r) / np.maximum(total, 1e-300)
        left = float((w * (r - mean[label]) ** 2).sum()) / max(
            len(r) - len(count), 1
        )  # variance of one point, about the means of flanks
        freedom = max(len(count) - OWN, 1)
        ratios[i], numbers[i] = float((total * mean**2).sum()) / freedom / max(left, 1e-300), freedom
        if ratios[i] > 1.0 + CHANCE * np.sqrt(2.0 / freedom):
            torn[i] = np.sqrt((total * mean**2).sum() / total.sum() * (1.0 - 1.0 / ratios[i]))
    return torn, max(float((ratios * numbers).sum() / numbers.sum()), 1.0)


def _alone(view: Cells, shared: int, noise: float, ignore: frozenset[int]) -> ViewAccord:
    """What a view tells by itself: its scale and offset by its own fit to the design, with their spread by tooth sides."""
    points, usual = view.points, float(np.median(view.count[view.seen])) if view.seen.any() else 0.0
    datum = choose_datum(view, noise, ignore)
    part = np.flatnonzero(view.seen & datum.mask & (points.surface < END_LOW) & (view.count >= max(2.0, 0.2 * usual)))
    if len(part) < FEWEST_CELLS:
        return ViewAccord(shared=shared)
    a, d = _columns(view, part), points.deviation[part]
    size = np.sqrt((a**2).mean(axis=0))
    size[size == 0.0] = 1.0
    a, weight = a / size, np.sqrt(np.minimum(view.count[part], np.median(view.count[part])))
    share, slope = np.ones(len(d)), np.ones(len(d))
    for _ in range(PASSES):
        normal = a.T @ (a * (share * weight)[:, None])
        solution = np.linalg.pinv(normal, rcond=1e-9, hermitian=True) @ (a.T @ (share * weight * d))
        residual = d - a @ solution
        scale = max(median_scale(residual)[1], 1e-9)
        share, slope = tukey_weight(residual, scale), tukey_slope(residual, scale)
    spread = clustered(a, share * weight * residual, slope * weight, view.part[part])
    own, std = solution / size, np.where(np.diag(spread) > 0.0, np.sqrt(np.maximum(np.diag(spread), 0.0)) / size, np.inf)
    return ViewAccord(
        shared=shared,
        own_scale=float(own[SCALE]),
        own_scale_std=float(std[SCALE]),
        own_offset=float(own[OFFSET]),
        own_offset_std=float(std[OFFSET]),
        reach=float(np.std(a[:, SCALE] * size[SCALE])),
    )


def _accord(
    alone: ViewAccord, all_: Accords, columns: Floats, rest: Floats, view: int, against: tuple[Floats, Floats], torn: float
) -> ViewAccord:
    """What the others tell of a view besides; `against` are the weights of all views in its offset and in its scale."""
    offset, offset_std = all_.contrast(OFFSET, against[0])
    scale, scale_std = all_.contrast(SCALE, against[1])
    freedoms, spread, moving = all_.freedoms[view], all_.own(view), columns[:, :OFFSET]
    low, high = np.quantile(rest, [0.01, 0.99])
    return replace(
        alone,
        scale=scale,
        scale_std=scale_std,
        offset=offset,
        offset_std=offset_std,
        place=_rms(moving @ freedoms[:OFFSET]),
        place_std=float(np.sqrt(np.mean(np.einsum("ij,jk,ik->i", moving, spread[:OFFSET, :OFFSET], moving)))),
        size=abs(scale) * _rms(columns[:, SCALE] - columns[:, SCALE].mean()),
        residual=_rms(np.clip(rest, low, high)),
        torn=float(torn),
    )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))

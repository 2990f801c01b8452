"""Whether several views of one gear agree: where each lies, and how large it shows the gear, against the others.

Each view was laid on the design by itself. Where views overlap they saw the same metal, whatever the design says of it: what is between them there is
theirs, a place that is a little wrong, an offset of its surface or another scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.quantity import significant
from gearwear.placing.cells import Cells
from gearwear.robust import median_scale, tukey_weight

FEWEST_CELLS = 100
"""Cells that a view must share with others for anything to be said of it."""
STDS, NOISES = 5.0, 0.5
"""Standard deviations, and share of a point's scatter, by both of which a view must be off to be called so."""
PASSES = 12
HELD = 10.0
"""Numerical: how firmly the sums are held, in what all cells together say."""
OWN = 8
"""Freedoms of a view: six of motion, its offset, its scale."""


@dataclass(frozen=True, slots=True)
class ViewAccord:
    """A view against the others, where they overlap.

    Parameters
    ----------
    shared : int
        Cells that others saw too; with too few nothing is said, and the rest is 0.
    scale, scale_std : float
        How much larger it shows the gear than a typical view, relative.
    place : float
        Root mean square over its cells of what its place is off against the others, mm.
    size : float
        Root mean square over its cells of what its scale makes there, mm.
    residual : float
        What is left between it and the others, beyond place, offset and scale: root mean square, mm.
    """

    shared: int
    scale: float = 0.0
    scale_std: float = 0.0
    place: float = 0.0
    size: float = 0.0
    residual: float = 0.0

    def doubt(self, number: int, noise: float) -> str | None:
        """What is wrong with view `number` in words, in a scan whose points scatter by `noise` (mm); None where nothing is."""
        if abs(self.scale) > STDS * self.scale_std and self.size > NOISES * noise:
            much = f"{1e6 * abs(self.scale):.0f} ± {1e6 * self.scale_std:.0f} ppm"
            return f"view {number} is out of scale: it shows the gear {much} too {'large' if self.scale > 0.0 else 'small'} against the others"
        if self.place > NOISES * noise:
            return f"view {number} is badly stitched: it lies {significant(1e3 * self.place, 2)} µm (RMS) off the others where they overlap"
        return None


def view_accords(views: Sequence[Cells], noise: float) -> list[ViewAccord]:
    """Place and scale of all views together.

    Parameters
    ----------
    views : sequence of Cells
        Each view alone, on the same grid.
    noise : float
        Scatter of points, mm.

    Notes
    -----
    Of every cell that several views saw the weighted mean is taken off, which is the metal itself; what is left is fitted by a small motion, an offset and
    a scale for each view, by robust least squares. That all views may move together is not seen: the sum over the views of each freedom is held at
    zero. The scale of a view is stated against the median of all.
    """
    seen = np.array([view.seen & np.isfinite(view.points.deviation) for view in views])
    side = views[0].grid.on_cells(np.ones(views[0].grid.sides(views[0].count).shape, dtype=bool))
    shared = seen & (seen.sum(axis=0) > 1) & side
    enough = shared.sum(axis=1) >= FEWEST_CELLS
    if enough.sum() < 2:
        return [ViewAccord(int(number)) for number in shared.sum(axis=1)]
    cells = np.flatnonzero(shared.any(axis=0))
    count = np.where(shared, np.array([view.count for view in views]), 0.0)[:, cells]
    value = np.nan_to_num(np.array([view.points.deviation for view in views]))[:, cells]
    total = np.maximum(count.sum(axis=0), 1.0)
    columns = [_columns(view, cells) for view in views]
    blocks, targets, weights, owner = [], [], [], []
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
    a, y, w, of = np.vstack(blocks), np.concatenate(targets), np.concatenate(weights), np.concatenate(owner)
    solution, covariance = _fitted(a, y, w, noise)
    rest = y - a @ solution
    middle = float(np.median(solution[OWN - 1 :: OWN]))
    return [
        _accord(solution, covariance, columns[i][count[i] > 0.0], rest[of == i], i, middle, int(shared[i].sum()), bool(enough[i]))
        for i in range(len(views))
    ]


def _columns(view: Cells, cells: Ints) -> Floats:
    """Motion, offset and scale on some cells, (k, 8)."""
    points = view.points
    size = (points.position * points.normal).sum(axis=1)
    return np.asarray(np.nan_to_num(np.column_stack([view.motion, np.ones(len(size)), size])[cells]), dtype=np.float64)


def _fitted(a: Floats, y: Floats, weight: Floats, noise: float) -> tuple[Floats, Floats]:
    """Robust least squares with the sum over the views of each freedom held at zero; with the covariance."""
    size = np.tile(np.sqrt((a**2).mean(axis=0)).reshape(-1, OWN).mean(axis=0), a.shape[1] // OWN)
    size[size == 0.0] = 1.0
    a = a / size
    held = HELD * float(weight.sum()) * np.kron(np.ones((a.shape[1] // OWN,) * 2), np.eye(OWN))
    share = np.ones(len(y))
    inverse: Floats = np.zeros((a.shape[1], a.shape[1]))
    solution: Floats = np.zeros(a.shape[1])
    for _ in range(PASSES):
        w = weight * share
        inverse = np.asarray(np.linalg.pinv(a.T @ (a * w[:, None]) + held, rcond=1e-12, hermitian=True), dtype=np.float64)
        solution = np.asarray(inverse @ (a.T @ (w * y)), dtype=np.float64)
        residual = (y - a @ solution) * np.sqrt(weight)
        scale = max(median_scale(residual)[1], noise)
        share = tukey_weight(residual, scale)
    return np.asarray(solution / size), np.asarray(scale**2 * inverse / np.outer(size, size))


def _accord(
    solution: Floats, covariance: Floats, columns: Floats, rest: Floats, view: int, middle: float, shared: int, enough: bool
) -> ViewAccord:
    if not enough:
        return ViewAccord(shared)
    its = slice(OWN * view, OWN * (view + 1))
    freedoms = solution[its]
    moved = columns[:, :6] @ freedoms[:6]
    scale, std = float(freedoms[-1]) - middle, float(np.sqrt(covariance[its, its][-1, -1]))
    low, high = np.quantile(rest, [0.01, 0.99])
    return ViewAccord(
        shared, scale, std, _rms(moved), abs(scale) * _rms(columns[:, -1] - columns[:, -1].mean()), _rms(np.clip(rest, low, high))
    )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))

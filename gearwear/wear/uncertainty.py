"""How well worn volumes are known: by propagation of every error that is known of, in closed form.

The volume of a region is a weighted sum of cells, V = −aᵀ (d − X θ), with d the deviations and X θ what pose and effects make of them. θ is
fitted to cells outside the wear, so the error of V is linear in the errors of the cells alone:

    V − V_true = −cᵀ e,   c = a − W X (XᵀWX)⁻¹ Xᵀ a,   var V = cᵀ Σ c

with Σ the noise of the points and the texture of the surface (`CellCovariance`). To it come how far an effect's form is trusted, and
edges that are steeper than a cell is wide.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import cell_basis
from gearwear.diagnose.found import Loop
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules
from gearwear.diagnose.shapes import shape_columns
from gearwear.placing.cells import MAX_VARIANCE_RATIO, Cells
from gearwear.placing.side_maps import SideMaps


def region_weights(sheets: SideMaps, regions: Bools | Floats) -> Floats:
    """What each cell's deviation weighs in the volume of each region, mm².

    Parameters
    ----------
    sheets : SideMaps
    regions : (k, teeth, 2, rows, columns) bool or float
        The cells, or how much of each.

    Returns
    -------
    (k, teeth, 2, rows, columns) float
        The cell's area; the area of what was not seen falls to what was seen of the region, in equal shares.
    """
    area = regions * sheets.area
    seen = np.where(sheets.seen, area, 0.0)
    # Of cells that are merged each has the say of its own points.
    seen = seen * np.where(sheets.merged[..., None, None] > 1, sheets.points / np.maximum(sheets.count, 1e-300), 1.0)
    whole, known = area.sum(axis=(1, 2, 3, 4)), seen.sum(axis=(1, 2, 3, 4))
    return np.asarray(seen * (whole / np.maximum(known, 1e-300))[:, None, None, None, None], dtype=np.float64)


def noise_covariance(cells: Cells, noise: float, loop: Loop | None, weights: Floats) -> Floats:
    """Covariance of volumes from noise, texture, and what both leave uncertain of pose and effects.

    Parameters
    ----------
    cells : Cells
        The cells the volumes are sums of.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        What pose and effects were fitted in; None: noise alone.
    weights : (k, teeth, 2, rows, columns) float
        What the deviation of each cell takes from each volume, mm².

    Returns
    -------
    (k, k) float
        mm⁶.
    """
    white = noise**2 / np.maximum(cells.count, 1.0)
    wanted = np.column_stack([cells.grid.on_cells(weight) for weight in weights])
    if loop is None:
        return np.asarray(wanted.T @ (wanted * white[:, None]), dtype=np.float64)
    model = loop.covariance
    covariance = CellCovariance(cells.grid, white, model.texture, model.row_step, model.column_step)
    columns, fields = _model_columns(cells, loop)
    weight = np.where(loop.use & cells.seen, covariance.weight, 0.0)
    gram = Gram.of(columns, np.zeros(len(weight)), weight, np.zeros(len(weight), np.int64), 1)
    _, inverse = gram.solve(np.arange(columns.shape[1]))
    whole = wanted - weight[:, None] * (columns @ (inverse @ (columns.T @ wanted)))
    form = wanted.T @ (fields if loop.hidden is None else np.hstack([fields, loop.hidden]))
    return np.asarray(whole.T @ covariance.apply(whole) + form @ form.T, dtype=np.float64)


def _model_columns(cells: Cells, loop: Loop) -> tuple[Floats, Floats]:
    """(m, p) columns of pose, effects and their shape values, and (m, effects) how far each effect's form may be wrong, mm."""
    seen, context = cells.seen, loop.context
    motion = [0, 1, 5] if context.planar else list(range(6))
    columns = [np.where(seen[:, None], cells.motion[:, motion], 0.0)]
    fields = np.zeros((len(seen), len(loop.effects)))
    points = cells.points.take(seen)
    for i, traced in enumerate(loop.effects):
        effect, shape = traced.candidate.effect, traced.candidate.shape
        basis = np.zeros((len(seen), len(traced.amplitudes)))
        basis[seen] = cell_basis(effect, points, context, shape, cells.grid)
        bend = shape_columns(traced.candidate, traced.amplitudes, cells, context)
        columns += [basis, bend]
        fields[:, i] = (rules().form_error_with_shape if bend.shape[1] else rules().form_error) * (basis @ traced.amplitudes)
    return np.hstack(columns), fields


def torn_beyond(sheets: SideMaps, filled: Floats, noise: float) -> tuple[Floats, Floats]:
    """What the points of a cell scatter beyond their noise and the slope of the surface there, (teeth, 2, rows, columns) mm², where that stands out;
    and that slope along z and along the profile, (2, teeth, 2, rows, columns), mm a cell. `filled` are the deviations with holes filled.

    An edge that is steeper than a cell is wide: no surface between the cells' means shows where in the cell it lies.
    """
    slope = np.zeros((2, *filled.shape))
    for axis, number in enumerate(filled.shape[2:]):
        if number > 1:
            slope[axis] = np.gradient(filled, axis=2 + axis)
    block = sheets.merged[..., None, None].astype(np.float64)
    inside = np.nan_to_num(sheets.torn) ** 2 - ((slope * block) ** 2).sum(axis=0) / 12.0
    return np.where(inside > MAX_VARIANCE_RATIO * noise**2, inside - noise**2, 0.0), slope


def edge_covariance(sheets: SideMaps, torn: Floats, slope: Floats, weights: Floats) -> Floats:
    """Covariance of volumes from edges that are steeper than a cell is wide: the mean of such a cell depends on where its points lie.

    Parameters
    ----------
    sheets : SideMaps
    torn, slope : float
        From `torn_beyond`.
    weights : (k, teeth, 2, rows, columns) float
        What each cell's deviation takes from the volume of each region, mm².

    Returns
    -------
    (k, k) float
        mm⁶.

    Notes
    -----
    The mean of a cell whose points lie at n places along an axis has the variance s² / n, s² that of the surface inside the cell along that
    axis. Where points lie in their cells tells n: the mean of n places has the variance 1 / (12 n) in cells. Points at random err in each
    cell by themselves. Points on a lattice err alike along an edge that lies along it, and alike on every tooth, as far as they lie alike in their
    cells.
    """
    share = slope**2 / np.maximum((slope**2).sum(axis=0), 1e-300)
    known = sheets.seen[..., sheets.fillet :]
    apart = np.array(
        [float(np.mean(offset[..., sheets.fillet :][known] ** 2)) if known.any() else 1.0 for offset in sheets.offset]
    )
    places = np.clip(
        (1.0 / np.maximum(12.0 * apart, 1e-9))[:, None, None, None, None],
        1.0,
        np.maximum(sheets.count * sheets.merged[..., None, None] ** 2, 1.0),
    )
    per_cell = np.sqrt(torn * share / places) * np.sign(slope)
    repeated, shared = _repeats(sheets)
    result = np.zeros((len(weights), len(weights)))
    for axis, along in ((0, -1), (1, -2)):
        sides = np.stack(
            [(weight * per_cell[axis]).sum(axis=along).sum(axis=0) for weight in weights]
        )  # k, 2, strips: a region lies on one tooth
        alike = np.einsum("ksi,lsi->kl", sides, sides)
        single = np.array([((weight * per_cell[axis]) ** 2).sum() for weight in weights])
        result += shared[axis] * alike
        result += np.diag((repeated[axis] - shared[axis]) * np.diag(alike) + (1.0 - repeated[axis]) * single)
    return result


def _repeats(sheets: SideMaps) -> tuple[Floats, Floats]:
    """(2,) correlation, along z and along the profile, of where the points lie in cells along a strip, and on neighbouring teeth."""
    offset = np.where(sheets.seen, sheets.offset, np.nan)[..., sheets.fillet :]
    along, across = offset
    beside = np.array([_correlation(along[..., 1:], along[..., :-1]), _correlation(across[:, :, 1:], across[:, :, :-1])])
    round_ = np.array([_correlation(places, np.roll(places, 1, axis=0)) for places in offset])
    return beside, np.minimum(beside, round_)


def _correlation(a: Floats, b: Floats) -> float:
    """Of two fields about zero where both are known; 0 where it is negative or there is nothing to tell."""
    known = np.isfinite(a) & np.isfinite(b)
    a, b = a[known], b[known]
    size = float(np.sqrt((a @ a) * (b @ b)))
    return min(max(float(a @ b) / size, 0.0), 1.0) if size > 0.0 else 0.0

"""How well worn volumes are known: by propagation of every error that is known of, in closed form.

The volume of a region is a weighted sum of cells, V = −aᵀ (d − X θ), with d the deviations and X θ what pose and effects make of them. θ is
fitted to cells outside the wear, so the error of V is linear in the errors of the cells alone:

    V − V_true = −cᵀ e,   c = a − W X (XᵀWX)⁻¹ Xᵀ a,   var V = cᵀ Σ c

with Σ the noise of the points and the texture of the surface (`CellCovariance`). To it come how far an effect's form is trusted, and
edges that are steeper than a cell is wide.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.side import Side
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import columns_on
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.effects.face_level import FACE_LEVEL
from gearwear.diagnose.found import Loop
from gearwear.diagnose.gram import Gram
from gearwear.diagnose.rules import rules
from gearwear.diagnose.shapes import shape_columns
from gearwear.placing.cells import MAX_VARIANCE_RATIO, Cells
from gearwear.placing.side_maps import SideMaps
from gearwear.wear.weights import SideWeights, by_side

BEYOND_CHANCE = 3.0
"""Standard deviations of the variance in a column of cells on all flanks of a side from which on something else than noise is in it."""


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


def noise_covariance(cells: Cells, noise: float, loop: Loop | None, weights: Floats | SideWeights) -> Floats:
    """Covariance of volumes from noise, texture, and what both leave uncertain of pose and effects.

    Parameters
    ----------
    cells : Cells
        The cells the volumes are sums of.
    noise : float
        Scatter of points, mm.
    loop : Loop or None
        What pose and effects were fitted in; None: noise alone.
    weights : SideWeights, or (k, teeth, 2, rows, columns) float
        What the deviation of each cell takes from each volume, mm².

    Returns
    -------
    (k, k) float
        mm⁶.
    """
    return CellErrors.of(cells, noise, loop).covariance_of(weights)


@dataclass(frozen=True, slots=True)
class CellErrors:
    """What noise, texture, pose and effects make of sums over cells, by the formula above, multiplied out: so each tooth side is gone
    through by itself.

    Parameters
    ----------
    covariance : CellCovariance
        Σ.
    columns : (m, p) float
        X.
    inverse : (p, p) float
        (XᵀWX)⁻¹.
    through : (m, p) float
        Σ W X.
    spread : (p, p) float
        Xᵀ W Σ W X.
    fields : (m, q) float
        How far the form of each effect may be wrong, and effects too small to be found, mm.
    """

    covariance: CellCovariance
    columns: Floats
    inverse: Floats
    through: Floats
    spread: Floats
    fields: Floats

    @classmethod
    def of(cls, cells: Cells, noise: float, loop: Loop | None) -> CellErrors:
        """Parameters as `noise_covariance`."""
        white = noise**2 / np.maximum(cells.count, 1.0)
        if loop is None:
            none = np.zeros((len(white), 0))
            return cls(CellCovariance(cells.grid, white, 0.0, 0.0, 0.0), none, none[:0], none, none[:0], none)
        model = loop.covariance
        covariance = CellCovariance(cells.grid, white, model.texture, model.row_step, model.column_step)
        columns, fields = model_columns(cells, loop)
        weight = np.where(loop.use & cells.seen, covariance.weight, 0.0)
        gram = Gram.of(columns, np.zeros(len(weight)), weight, np.zeros(len(weight), np.int64), 1)
        _, inverse = gram.solve(np.arange(columns.shape[1]))
        weighted = columns * weight[:, None]
        through = covariance.apply(weighted)
        hidden = [fields, *([] if loop.hidden is None else [loop.hidden]), *([] if loop.untold is None else [loop.untold.fields])]
        return cls(covariance, columns, inverse, through, weighted.T @ through, np.hstack(hidden))

    def covariance_of(self, weights: Floats | SideWeights) -> Floats:
        """(k, k) of sums with these weights."""
        number, grid = len(weights), self.covariance.grid
        result, form = np.zeros((number, number)), np.zeros((number, self.fields.shape[1]))
        moment, through = np.zeros((number, self.columns.shape[1])), np.zeros((number, self.columns.shape[1]))
        for side, which, values in by_side(weights):
            flat = values.reshape(len(which), -1)
            result[np.ix_(which, which)] += flat @ self.covariance.on_side(side, values).reshape(len(which), -1).T
            for sums, columns in ((moment, self.columns), (through, self.through), (form, self.fields)):
                sums[which] += flat @ grid.side(columns, *side).reshape(flat.shape[1], columns.shape[1])
        pull = moment @ self.inverse
        mixed = through @ pull.T
        return np.asarray(result - mixed - mixed.T + pull @ self.spread @ pull.T + form @ form.T, dtype=np.float64)


def model_columns(cells: Cells, loop: Loop) -> tuple[Floats, Floats]:
    """(m, p) columns of pose, effects and their shape values, and (m, effects) how far each effect's form may be wrong, mm."""
    seen, context = cells.seen, loop.context
    motion = [0, 1, 5] if context.planar else list(range(6))
    columns = [np.where(seen[:, None], cells.motion[:, motion], 0.0)]
    told = (*loop.effects, *(one for one in loop.form if one.name == FACE_LEVEL or one.kind is not Kind.FORM))
    fields = np.zeros((len(seen), len(told)))
    points = cells.points.take(seen)
    for i, traced in enumerate(told):
        basis = columns_on(seen, points, traced.candidate.effect, traced.candidate.shape, context, cells.grid)
        bend = shape_columns(traced.candidate, traced.amplitudes, cells, context)
        columns += [basis, bend]
        fields[:, i] = (rules().form_error_with_shape if bend.shape[1] else rules().form_error) * (basis @ traced.amplitudes)
    return np.hstack(columns), fields


def torn_beyond(sheets: SideMaps, filled: Floats, noise: float, worn: frozenset[Side] = frozenset()) -> tuple[Floats, Floats]:
    """What the points of a cell scatter beyond their noise and the slope of the surface there, (teeth, 2, rows, columns) mm², where that stands out;
    and that slope along z and along the profile, (2, teeth, 2, rows, columns), mm a cell. `filled` are the deviations with holes filled.

    An edge that is steeper than a cell is wide: no surface between the cells' means shows where in the cell it lies. The flanks of sides `worn`
    throughout are alike: there what stands out of the noise of a column of cells on all of them counts.
    """
    slope = np.zeros((2, *filled.shape))
    for axis, number in enumerate(filled.shape[2:]):
        if number > 1:
            slope[axis] = np.gradient(filled, axis=2 + axis)
    block = sheets.merged[..., None, None].astype(np.float64)
    by_slope = ((slope * block) ** 2).sum(axis=0) / 12.0
    inside = np.nan_to_num(sheets.torn) ** 2 - by_slope
    torn = np.where(inside > MAX_VARIANCE_RATIO * noise**2, inside - noise**2, 0.0)
    for side in worn:
        own = (slice(None), side.index)
        torn[own] = np.maximum(torn[own], _beyond_on_all(sheets, by_slope, noise, side))
    return torn, slope


def ending_below(sheets: SideMaps, filled: Floats, noise: float, worn: frozenset[Side], undercut: bool) -> Floats:
    """Variance inside the last cells of undercut fillets of sides `worn` throughout, (teeth, 2, rows, columns) mm², of wear that goes on below the form
    circle and ends anywhere in them, whether points lie there or not: a depth that is anything from none to that at the form circle.

    An undercut fillet meets the flank at an angle and stands in the way of the worn surface, however that goes on; one that goes over into the flank
    smoothly does not. Of a depth that rises evenly over the first column of the flank to its edge, the edge lies √3 standard deviations below the mean.
    """
    result, first = np.zeros(filled.shape), sheets.fillet
    for side in worn if undercut and first > 0 else ():
        spread = math.sqrt(3.0 * float(_beyond_on_all(sheets, np.zeros(filled.shape), noise, side)[first]))
        result[:, side.index, :, first - 1] = max(spread - float(filled[:, side.index, :, first].mean()), 0.0) ** 2 / 12.0
    return result


def _beyond_on_all(sheets: SideMaps, by_slope: Floats, noise: float, side: Side) -> Floats:
    """(columns,) what the points of a cell scatter beyond their noise and the slope, mm², on all flanks of a side, where that stands out."""
    own = (slice(None), side.index)
    known = np.isfinite(sheets.torn[own])
    freedom = np.where(known, np.maximum(sheets.points[own] - 1.0, 0.0), 0.0)
    square = np.where(known, np.nan_to_num(sheets.torn[own]) ** 2 - by_slope[own], 0.0)
    whole = np.maximum(freedom.sum(axis=(0, 1)), 1.0)
    beyond = (freedom * square).sum(axis=(0, 1)) / whole - noise**2
    return np.asarray(np.where(beyond > BEYOND_CHANCE * noise**2 * np.sqrt(2.0 / whole), beyond, 0.0), dtype=np.float64)


def edge_covariance(sheets: SideMaps, torn: Floats, slope: Floats, weights: Floats | SideWeights) -> Floats:
    """Covariance of volumes from edges that are steeper than a cell is wide: the mean of such a cell depends on where its points lie.

    Parameters
    ----------
    sheets : SideMaps
    torn : (teeth, 2, rows, columns) float
        From `torn_beyond`, mm².
    slope : (2, teeth, 2, rows, columns) float
        From `torn_beyond`, mm a cell.
    weights : SideWeights, or (k, teeth, 2, rows, columns) float
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
    number = len(weights)
    sides = [np.zeros((number, 2, count)) for count in per_cell.shape[3:]]  # strips: a region lies on one tooth
    single = np.zeros((2, number))
    for (tooth, half), which, values in by_side(weights):
        for axis, along in ((0, -1), (1, -2)):
            own = values * per_cell[axis, tooth, half]
            sides[axis][which, half] += own.sum(axis=along)
            single[axis, which] += (own**2).sum(axis=(1, 2))
    result = np.zeros((number, number))
    for axis in (0, 1):
        strips = sides[axis].reshape(number, -1)
        alike = strips @ strips.T
        result += shared[axis] * alike
        result += np.diag((repeated[axis] - shared[axis]) * np.diag(alike) + (1.0 - repeated[axis]) * single[axis])
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

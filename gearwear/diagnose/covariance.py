"""How far the scan's residuals are correlated along the surface, and what that does to a fit.

Texture, coat and machining leave residuals that hang together over millimetres; a test that takes cells as independent finds effects
everywhere. The covariance is modelled as white noise plus s² exp(−Δrow / ℓ_row) exp(−Δcolumn / ℓ_column) within a tooth
side, a tip or a root land, estimated from the residuals themselves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import CellGrid, Cells


@dataclass(frozen=True, slots=True)
class CellCovariance:
    """Covariance of cell means.

    Parameters
    ----------
    grid : CellGrid
        The cells.
    white : (m,) float
        Variance of each cell's mean from its own points, mm².
    texture : float
        Variance s² of the correlated part, mm².
    row_step, column_step : float
        Correlation of neighbours along z and along the profile: exp(−1 / ℓ).
    """

    grid: CellGrid
    white: Floats
    texture: float
    row_step: float
    column_step: float

    @property
    def weight(self) -> Floats:
        """1 / variance of each cell, (m,)."""
        return np.asarray(1.0 / (self.white + self.texture), dtype=np.float64)

    def apply(self, columns: Floats) -> Floats:
        """Covariance times columns (m, p), without forming it."""
        result = columns * self.white[:, None]
        if self.texture <= 0.0:
            return np.asarray(result, dtype=np.float64)
        for block, values in _sheets(self.grid, columns):
            groups, rows, across, count = values.shape
            spread = _powers(self.row_step, rows) @ values.reshape(groups, rows, across * count)
            spread = (self.texture * _powers(self.column_step, across)) @ spread.reshape(groups * rows, across, count)
            result[block] += spread.reshape(-1, count)
        return np.asarray(result, dtype=np.float64)

    def on_side(self, side: tuple[int, int], values: Floats) -> Floats:
        """The same of arrays (n, rows, columns) over the cells of a tooth side, its number of tooth and side given, that are 0 elsewhere."""
        result = values * self.grid.side(self.white, *side)
        if self.texture > 0.0:
            rows = self.texture * _powers(self.row_step, values.shape[1])
            for part in (slice(0, self.grid.fillet), slice(self.grid.fillet, None)):
                own = values[..., part]
                result[..., part] += rows @ own @ _powers(self.column_step, own.shape[2])
        return np.asarray(result, dtype=np.float64)


def _powers(step: float, count: int) -> Floats:
    index = np.arange(count)
    return np.asarray(step ** np.abs(index[:, None] - index[None, :]), dtype=np.float64)


def _sheets(grid: CellGrid, columns: Floats) -> list[tuple[slice, Floats]]:
    """The blocks of every surface as (groups, rows, columns, p)."""
    per = {FLANK: grid.flank, FILLET: grid.fillet, TIP: grid.tip, ROOT: grid.root}
    result = []
    for surface, (start, size) in grid.blocks.items():
        block = slice(start, start + size)
        if surface in (END_LOW, END_HIGH):
            rows, across = 1, grid.ring
        elif surface == BORE:
            rows, across = grid.rows, 1
        else:
            rows, across = grid.rows, per[surface]
        result.append((block, columns[block].reshape(-1, rows, across, columns.shape[1])))
    return result


def estimate_covariance(cells: Cells, residual: Floats, use: Bools, noise: float) -> CellCovariance:
    """Covariance of cell means from what a fit leaves.

    Parameters
    ----------
    cells : Cells
        The binned scan.
    residual : (m,) float
        Deviation minus model, mm.
    use : (m,) bool
        Cells free of wear.
    noise : float
        Scatter of points, mm.
    """
    white = noise**2 / np.maximum(cells.count, 1.0)
    value = np.where(use, residual, np.nan)
    sides = cells.grid.sides(value)
    at_lag = {(dr, dc): _lag_product(sides, dr, dc) for dr, dc in _lags(sides.shape)}
    own = cells.grid.sides(white)
    excess = at_lag[0, 0] - float(np.mean(own[np.isfinite(sides)])) if np.isfinite(sides).any() else 0.0
    texture = max(excess, at_lag.get((1, 0), 0.0), at_lag.get((0, 1), 0.0), 0.0)
    if texture <= 0.0:
        return CellCovariance(cells.grid, white, 0.0, 0.0, 0.0)
    along = [at_lag.get((lag, 0), 0.0) / texture for lag in range(1, rules().longest_lag + 1)]
    across = [at_lag.get((0, lag), 0.0) / texture for lag in range(1, rules().longest_lag + 1)]
    return CellCovariance(cells.grid, white, texture, _step(along), _step(across))


def _lags(shape: tuple[int, ...]) -> list[tuple[int, int]]:
    rows, columns = shape[2:]
    lags = [(0, 0)]
    lags += [(lag, 0) for lag in range(1, min(rules().longest_lag, rows - 1) + 1)]
    lags += [(0, lag) for lag in range(1, min(rules().longest_lag, columns - 1) + 1)]
    return lags


def _lag_product(sides: Floats, dr: int, dc: int) -> float:
    """Mean product of residuals dr rows and dc columns apart on one side."""
    rows, columns = sides.shape[2:]
    product = sides[:, :, : rows - dr, : columns - dc] * sides[:, :, dr:, dc:]
    finite = np.isfinite(product)
    return float(product[finite].mean()) if finite.any() else 0.0


def _step(correlation: list[float]) -> float:
    """Neighbour correlation of the exponential that has the same integral scale as the measured correlations."""
    scale = 1.0
    for value in correlation:
        if value < rules().least_correlation:
            break
        scale += 2.0 * min(value, 1.0)
    return (scale - 1.0) / (scale + 1.0)


def effective_number(columns: Floats, covariance: CellCovariance, use: Bools) -> float:
    """Effective number of independent cells for a regressor (m,), Σ (w b)² V taken with and without correlation."""
    weighted = np.where(use, columns * covariance.weight, 0.0)[:, None]
    correlated = float((weighted * covariance.apply(weighted)).sum())
    alone = float((weighted[:, 0] ** 2 * (covariance.white + covariance.texture)).sum())
    return float(use.sum()) * alone / correlated if correlated > 0.0 else math.nan

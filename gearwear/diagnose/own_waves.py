"""Waves round the gear that are its own: what those of neighbouring orders let expect of the order an effect has.

An effect of one order round the gear (an ovality of the scanner's scale, a wobble) is not told from a wave of that order that the gear was made with. Errors
of gears fall off smoothly with the order, so the waves of the orders next to it, which no effect claims, say how large its own may be. Texture
differs from tooth to tooth and makes waves of all orders alike; it is in the covariance already.
"""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri

from gearwear.arrays import Bools, Complexes, Floats
from gearwear.diagnose.pattern import order_share
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import CellGrid

HIGHEST_ORDER = 4
"""Of an effect that is looked at; the next ones decide what is its own."""
NEIGHBOURS = 2
"""Orders up, and down, that are its neighbours."""
LEAST_ORDER = 2
"""Of a neighbour: the pose has taken what it can of order 1."""


def order_of(grid: CellGrid, field: Floats) -> int:
    """Order round the gear that most of an effect's field (m,) is of; 0 where it is none from 1 on."""
    share, order = max((order_share(grid, field, order), order) for order in range(1, HIGHEST_ORDER + 1))
    return order if share > rules().own_order else 0


def neighbouring_waves(grid: CellGrid, residual: Floats, use: Bools, order: int) -> Floats:
    """What a residual (m,) has of the orders next to one, each turned into a wave of that order, as it is and a quarter further round: (m, k) mm.

    Nothing where a tooth was not seen, for of a part of the gear no order is known by itself, or where there is one neighbour alone.
    """
    orders = orders_beside(grid, order, order - NEIGHBOURS, order + NEIGHBOURS)
    if len(orders) < 2 or not all_teeth_seen(grid, use):
        return np.zeros((len(residual), 0))
    seen = np.where(use, residual, 0.0)
    return np.hstack([turned_to(grid, height_of(grid, seen, k), order) for k in orders])


def orders_beside(grid: CellGrid, order: int, lowest: int, highest: int) -> list[int]:
    """Orders other than one, from the lowest that the pose leaves to the highest that the teeth tell apart."""
    return [k for k in range(max(lowest, LEAST_ORDER), highest + 1) if k != order and 2 * k < grid.gear.teeth]


def all_teeth_seen(grid: CellGrid, use: Bools) -> bool:
    """Whether cells in use (m,) lie on the sides of every tooth: of a part of the gear no order is known by itself."""
    return bool(grid.sides(use).any(axis=(1, 2, 3)).all())


def height_of(grid: CellGrid, field: Floats, order: int) -> Complexes:
    """The wave of an order round the gear that a field (m,) has in each place of a tooth, complex, mm: its shape without the axis of the teeth."""
    teeth = grid.gear.teeth
    angle = 2.0 * np.pi * np.arange(teeth) / teeth
    return np.asarray(2.0 / teeth * np.tensordot(np.exp(-1j * order * angle), grid.sides(field), axes=(0, 0)))


def turned_to(grid: CellGrid, height: Complexes, order: int) -> Floats:
    """A shape that goes round the gear with some order, as it is and a quarter further: (m, 2) mm."""
    teeth = grid.gear.teeth
    turned = np.exp(2j * np.pi * order * np.arange(teeth) / teeth)[:, None, None, None] * height
    return np.column_stack([grid.on_cells(np.ascontiguousarray(part)) for part in (turned.real, -turned.imag)])


def beyond_texture(pulls: Floats, spread: Floats) -> Floats:
    """Covariance (q, q) that waves add to amplitudes of covariance `spread` (q, q), which these waves pull by `pulls` (q, k): nothing where they are no
    larger than the texture in `spread` makes by chance, else what they are beyond it. A variance known from k pulls is that of Student's t: larger by
    k / (k − 2)."""
    count = pulls.shape[1]
    if not count or not np.isfinite(spread).all():
        return np.zeros_like(spread)
    ratio = float(np.einsum("ik,ij,jk->", pulls, np.linalg.pinv(spread), pulls)) / (count * len(spread))
    if ratio < float(chdtri(count, rules().significance)) / count:
        return np.zeros_like(spread)
    return np.asarray((1.0 - 1.0 / ratio) * pulls @ pulls.T / (count - 2), dtype=np.float64)

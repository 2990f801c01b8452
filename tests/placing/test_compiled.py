"""The contract of the compiled binning: the cells that NumPy finds, and its sums to rounding."""

from __future__ import annotations

import sys
from dataclasses import fields

import numpy as np
import pytest

from gearwear import compiled
from gearwear.design.surface import OTHER, SurfacePoints, locate
from gearwear.placing.cells import CellGrid
from gearwear.placing.sums import CellSums
from tests.design.test_compiled import anywhere, every_gear

pytest.importorskip("numba")


@every_gear
def test_same_cells_and_sums(gear, monkeypatch):
    """Each sum to 1e-12 of the sum of its terms' sizes, which bounds what another order of adding them may change."""
    points = locate(anywhere(gear), gear)
    grid = CellGrid.for_scan(gear, 3000)
    cells, sums = [], []
    for least in (sys.maxsize, 0):
        monkeypatch.setattr(compiled, "LEAST", least)
        cells.append(grid.index(points))
        sums.append(CellSums.of(points, cells[0], grid.count))
    np.testing.assert_array_equal(cells[1], cells[0])
    assert np.unique(cells[0]).size > 500
    sizes = CellSums.of(sizes_of(points), cells[0], grid.count)
    for field in fields(CellSums):
        fast, reference, size = (getattr(one, field.name) for one in (sums[1], sums[0], sizes))
        if field.name in ("count", "highest"):
            np.testing.assert_array_equal(fast, reference)
        else:
            bound = np.abs(reference) if field.name == "squares" else np.abs(size)
            least = 1e-12 * float(np.nanmax(bound)) if field.name in ("squares", "lever") else 0.0
            assert (np.abs(fast - reference) <= 1e-12 * bound + least)[~np.isnan(reference)].all(), field.name
            np.testing.assert_array_equal(np.isnan(fast), np.isnan(reference))


def sizes_of(points: SurfacePoints) -> SurfacePoints:
    """The same points with the absolute values of what is summed up."""
    values = {name: np.abs(getattr(points, name)) for name in ("roll", "position", "normal", "deviation")}
    return SurfacePoints(points.surface, points.tooth, points.side, **values)


def test_chunks_add_up(monkeypatch):
    """Compiled or not, chunk by chunk: the same squares about the mean, far from zero."""
    rng = np.random.default_rng(2)
    n, cell = 20_000, rng.integers(-1, 50, 20_000)
    zero = np.zeros((n, 3))
    points = SurfacePoints(
        np.zeros(n, np.int8),
        np.zeros(n, np.int32),
        np.ones(n, np.int8),
        np.ones(n),
        zero,
        zero,
        5.0 + 0.01 * rng.standard_normal(n),
    )
    sums = CellSums.empty(50)
    for number, start in enumerate(range(0, n, 3000)):
        monkeypatch.setattr(compiled, "LEAST", 0 if number % 2 else sys.maxsize)
        part = np.arange(start, min(start + 3000, n))
        sums.add(points.take(part), cell[part])
    for one in range(50):
        own = points.deviation[cell == one]
        assert sums.count[one] == len(own) and sums.highest[one] == own.max()
        np.testing.assert_allclose(
            sums.squares[one], ((own - own.mean()) ** 2).sum(), rtol=1e-10
        )  # of 5 mm, σ = 10 µm: ε (5 / 0.01)²


def test_no_point_and_no_surface(monkeypatch):
    monkeypatch.setattr(compiled, "LEAST", 0)
    gear = next(iter(every_gear.args[1]))
    grid = CellGrid.for_scan(gear, 1000)
    nothing = locate(np.empty((0, 3)), gear)
    assert grid.index(nothing).shape == (0,) and CellSums.of(nothing, grid.index(nothing), grid.count).count.sum() == 0.0
    off = locate(np.full((4, 3), 1e6), gear)
    assert (off.surface == OTHER).all() and (grid.index(off) == -1).all()

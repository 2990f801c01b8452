"""Fewer cells tell the same of what is smooth across those put together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.surface import TIP
from gearwear.diagnose import few_cells
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import build_dictionary
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.loop import make_context
from gearwear.diagnose.rules import RULES, in_force
from tests.diagnose.core.test_worn_sides import binned

LEAST = 3000


@pytest.fixture(scope="module")
def fit():
    cells = binned(())
    effects = tuple(effect for effect in catalogue() if effect.searched)[:12]
    dictionary = build_dictionary(cells, effects, make_context(cells, np.eye(3), False))
    target = dictionary.columns @ np.random.default_rng(1).normal(size=dictionary.count)
    white = CellCovariance(cells.grid, 1e-4 / np.maximum(cells.count, 1.0), 1e-5, 0.5, 0.5)
    return Fit(cells, target, dictionary, cells.seen, white)


def test_a_fit_on_few_cells_is_left_as_it_is(fit):
    assert few_cells.on_few_cells(fit, fit.cells.seen, 0.01)[0] is fit


def test_what_columns_explain_they_explain_on_fewer_cells(fit, monkeypatch):
    """Means are linear: the same amplitudes leave nothing there either, and all points are in."""
    monkeypatch.setattr(few_cells, "ENOUGH_CELLS", LEAST)
    sound = fit.cells.seen & (fit.cells.points.tooth != 4)
    with in_force(replace(RULES, rows_of_sides=3)):
        few, there = few_cells.on_few_cells(fit, sound, 0.01)
    assert 3 <= few.cells.grid.rows <= fit.cells.grid.rows // 2
    assert few.cells.count.sum() == pytest.approx(fit.cells.count[sound].sum())
    assert not there[few.cells.points.tooth == 4].any()
    amplitudes = np.random.default_rng(1).normal(size=fit.dictionary.count)
    np.testing.assert_allclose(few.dictionary.columns @ amplitudes, few.target, atol=1e-9)
    assert few.covariance.texture < fit.covariance.texture and few.covariance.row_step < fit.covariance.row_step


def test_teeth_are_left_out_where_rows_are_few_already(fit, monkeypatch):
    """The first look at a large scan has few rows from the start."""
    with in_force(replace(RULES, rows_of_sides=fit.cells.grid.rows)):
        monkeypatch.setattr(few_cells, "ENOUGH_CELLS", fit.cells.grid.count // 3)
        few, there = few_cells.on_few_cells(fit, fit.cells.seen, 0.01)
    assert few.cells.grid is fit.cells.grid
    on_teeth = few.cells.points.surface[there] <= TIP
    assert set(few.cells.points.tooth[there][on_teeth]) == {0, 3, 6, 9}

"""Fewer cells tell the same of what is smooth across those put together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import TIP
from gearwear.diagnose import few_cells
from gearwear.diagnose.covariance import CellCovariance
from gearwear.diagnose.dictionary import build_dictionary, with_worn
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from gearwear.diagnose.effects.pitch import Pitch
from gearwear.diagnose.fit import Fit
from gearwear.diagnose.loop import make_context
from gearwear.diagnose.rules import RULES, in_force
from tests.diagnose.core.test_worn_sides import binned

LEAST = 3000


def context_of(cells):
    return make_context(cells, np.eye(3), False)


@pytest.fixture(scope="module")
def fit():
    cells = binned(())
    effects = tuple(effect for effect in catalogue() if effect.searched)[:12]
    dictionary = build_dictionary(cells, effects, context_of(cells))
    target = dictionary.columns @ np.random.default_rng(1).normal(size=dictionary.count)
    white = CellCovariance(cells.grid, 1e-4 / np.maximum(cells.count, 1.0), 1e-5, 0.5, 0.5)
    return Fit(cells, target, dictionary, cells.seen, white)


def test_a_freedom_for_every_tooth_is_built_a_stretch_at_a_time(monkeypatch):
    """Of its columns, as many as teeth, all cells would be held with their zeros; what comes out is what its basis is on all of them."""
    cells = binned(())
    context, shape, asked = make_context(cells, np.eye(3), False), (1.0,), list[int]()
    in_full = np.zeros((len(cells.seen), context.gear.teeth - 1))
    in_full[cells.seen] = PITCH.basis(cells.points.take(cells.seen), context, shape)

    def counted(self, points, *rest, basis=Pitch.basis):
        asked.append(len(points))
        return basis(self, points, *rest)

    monkeypatch.setattr(Pitch, "basis", counted)
    dictionary = build_dictionary(cells, (PITCH,), context)
    (own,) = [c.columns for c in dictionary.candidates if c.shape == shape]
    np.testing.assert_array_equal(dictionary.take(own), in_full)
    assert sum(asked) == 2 * int(cells.seen.sum()) and max(asked) <= np.diff(dictionary.first.cuts).max()


@pytest.mark.parametrize("worn", [frozenset({Side.LEFT}), frozenset(Side)])
def test_columns_that_other_sides_worn_leave_as_they_are_are_kept(worn):
    """The dictionary for sides worn throughout is the same as one built for them anew, and shares what was built."""
    cells = binned(())
    context, effects = make_context(cells, np.eye(3), False), tuple(effect for effect in catalogue() if effect.searched)
    plain, without = build_dictionary(cells, effects, context), replace(context, worn=worn)
    kept, anew = with_worn(plain, cells, without), build_dictionary(cells, effects, without)
    assert kept.first is plain.first
    assert [(c.name, c.shape) for c in kept.candidates] == [(c.name, c.shape) for c in anew.candidates]
    for one, other in zip(kept.candidates, anew.candidates, strict=True):
        np.testing.assert_array_equal(kept.take(one.columns), anew.take(other.columns))


def test_a_fit_on_few_cells_is_left_as_it_is(fit):
    assert few_cells.on_few_cells(fit, fit.cells.seen, 0.01, context_of(fit.cells))[0] is fit


def test_what_columns_explain_they_explain_on_fewer_cells(fit, monkeypatch):
    """Means are linear: the same amplitudes leave nothing there either, and all points are in."""
    monkeypatch.setattr(few_cells, "ENOUGH_CELLS", LEAST)
    sound = fit.cells.seen & (fit.cells.points.tooth != 4)
    with in_force(replace(RULES, rows_of_sides=3)):
        few, there = few_cells.on_few_cells(fit, sound, 0.01, context_of(fit.cells))
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
        few, there = few_cells.on_few_cells(fit, fit.cells.seen, 0.01, context_of(fit.cells))
    assert few.cells.grid is fit.cells.grid
    on_teeth = few.cells.points.surface[there] <= TIP
    assert set(few.cells.points.tooth[there][on_teeth]) == {0, 3, 6, 9}
    assert len(few.dictionary.first.cuts) < len(fit.dictionary.first.cuts)  # stretches of as many cells that are seen


@pytest.mark.parametrize(("fewest", "kept"), [(4, {0, 3, 6, 9}), (6, {0, 2, 4, 6, 8, 10}), (7, set(range(12)))])
def test_a_first_look_is_at_so_many_teeth_at_least(fit, monkeypatch, fewest, kept):
    """What it leaves open is asked again of more; without it all are asked."""
    monkeypatch.setattr(few_cells, "LOOK_CELLS", fit.cells.grid.count // 3)
    monkeypatch.setattr(few_cells, "FEWEST_TEETH", fewest)
    points = fit.cells.points
    at_look, asked = (few_cells.few_teeth(fit.cells.grid, points, look) for look in (True, False))
    assert set(points.tooth[at_look & (points.surface <= TIP)]) == kept and at_look[points.surface > TIP].all()
    assert asked.all()


@pytest.mark.parametrize("every", [3, 11])
def test_teeth_that_are_left_have_amounts_of_mean_0(monkeypatch, every):
    """As those of a gear of which the others are missing: so many amounts are paid for, and whether they are possible asks nothing of a tooth that is not
    there. Of 12 teeth the last is left out, or it is one of two that are left."""
    cells = binned(())
    context, white = context_of(cells), CellCovariance(cells.grid, np.ones(len(cells.seen)), 1e-5, 0.5, 0.5)
    fit = Fit(cells, np.zeros(len(cells.seen)), build_dictionary(cells, (PITCH,), context), cells.seen, white)
    kept = list(range(0, 12, every))
    monkeypatch.setattr(few_cells, "few_rows", lambda grid: grid)
    monkeypatch.setattr(few_cells, "ENOUGH_CELLS", cells.grid.count / every)
    few, there = few_cells.on_few_cells(fit, cells.seen, 0.01, context)
    assert few_cells.leaves_teeth_out(fit) and set(np.unique(few.cells.points.tooth[there])) >= set(kept)
    absent = replace(context, absent=frozenset(range(12)) - set(kept))
    for candidate in few.dictionary.candidates:
        own, on_teeth = few.dictionary.take(candidate.columns), there & (few.cells.points.surface <= TIP)
        of_these = PITCH.basis(few.cells.points.take(on_teeth), absent, candidate.shape)
        seen = few.dictionary.seen(there)[candidate.columns]
        assert seen.sum() == len(kept) - 1
        np.testing.assert_allclose(own[on_teeth][:, seen], of_these, atol=1e-12)

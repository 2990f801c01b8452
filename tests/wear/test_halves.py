"""The groove of a double helical gear is no part of its flanks: not of what was seen of them, nor of what they lost."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import gearwear as gw
from gearwear.design.pair import Design
from gearwear.design.side import Side
from gearwear.diagnose.made_height import MadeHeight
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.own_level import at_own_level
from gearwear.wear.regions import Wear, find_wear
from gearwear.wear.ridge import worn_level
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.synthetic.double_helical import Double, double_scan
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_double_helical import designed as designed_double
from tests.synthetic.test_helical import designed
from tests.wear.test_own_level import INDEXED

WIDE = Helical(teeth=17, helix=24.0, width=22.0)
TWO = Double(Helical(teeth=17, helix=24.0, width=11.0), gap=6.0)
NOISE = 0.003


def unworn(gear: Helical | Double) -> Wear:
    """What is found on a gear without wear, without the loop."""
    make, design = (double_scan, designed_double) if isinstance(gear, Double) else (scan, designed)
    return gw.find_wear(gw.register(Design({"gear": design(gear)}), gw.as_scan(make(gear, 20_000, noise=0.005, seed=3).points)))


def test_as_little_shows_on_two_halves_as_on_one_face_as_wide():
    """Point for point of one flank they are the same flanks: the patch that would show is about as deep."""
    deep, deep_on_halves = (np.array([flank.depth for flank in unworn(gear).flanks]) for gear in (WIDE, TWO))
    assert np.isfinite(deep_on_halves).all()
    assert np.median(deep_on_halves) == pytest.approx(np.median(deep), rel=0.15)


def in_halves(size: float = 1.2) -> Cells:
    """Cells of the double helical gear, none in its groove."""
    cells = every_cell(designed_double(TWO), size)
    assert cells.grid.groove_rows > 0
    sides = np.zeros(cells.grid.sides(cells.count).shape, dtype=bool)
    sides[:, :, ~cells.grid.toothed] = True
    return cells.without(cells.grid.on_cells(sides))


def test_a_profile_seen_on_most_of_both_halves_is_seen():
    """Of 60 % of the rows with teeth, which are less than half of those of the whole face: the level asked of a worn side has its profile."""
    cells = in_halves(0.4)
    grid, flank = cells.grid, flanks_of(cells)
    flank[:, 0] += 0.030 + 0.0003 * np.random.default_rng(2).standard_normal(flank[:, 0].shape)
    pitch = SimpleNamespace(pitch_roll=grid.gear.reference_roll, sliding=lambda roll: 1.0 - grid.gear.reference_roll / roll)
    as_made = SimpleNamespace(as_made_std=(0.0003, 0.0003), made=MadeHeight(), context=pitch)
    sides, rows = np.zeros(grid.sides(cells.count).shape, dtype=bool), np.flatnonzero(grid.toothed)
    unseen = rows[np.arange(len(rows)) % 5 < 2]
    assert 0.5 * len(rows) < len(rows) - len(unseen) < 0.5 * grid.rows
    sides[:, 0, unseen] = True
    sheets = make_side_maps(with_flanks(cells, flank).without(grid.on_cells(sides)))
    # Limits of an even level, where no profile would leave it open down to 0.
    assert 0.9 * 0.030 < worn_level(sheets, grid, as_made, Side.LEFT, 0.030).low <= 0.030


def toothed_area(grid: CellGrid) -> float:
    """Of a cell of the last column of flanks, mm²: its arc, as Δ(L²) / (2 r_b cos β_b), times the height of a row with teeth."""
    gear = grid.gear
    arc = (gear.tip_roll**2 - gear.form_roll**2) / grid.flank / (2.0 * gear.base_radius * gear.base_helix_cosine)
    return arc * grid.row_height


def test_a_burr_on_the_tips_of_both_halves_is_as_large_as_what_was_put_there():
    cells, random = in_halves(), np.random.default_rng(1)
    flank, toothed = flanks_of(cells), cells.grid.toothed
    flank[:, 0] -= np.linspace(0.020, 0.012, flank.shape[3])
    ridge = 0.060 * (random.random(flank[:, 0, :, -1].shape) < 0.5)
    flank[:, 0, :, -1] += ridge
    flank += NOISE / 2.0 * random.standard_normal(flank.shape)
    wear = find_wear(with_flanks(cells, flank), NOISE, frozenset({Side.LEFT}), limits=False)
    (burr,) = wear.burrs
    true = float(ridge[:, toothed].sum()) * toothed_area(cells.grid)
    assert burr.volume == pytest.approx(true, rel=0.01)
    lost = len(flank) * int(toothed.sum()) * np.linspace(0.020, 0.012, flank.shape[3]).sum() * toothed_area(cells.grid)
    assert wear.volume == pytest.approx(lost, rel=0.01)


def test_a_low_flank_may_have_lost_no_more_than_there_is_of_it():
    cells, random = in_halves(), np.random.default_rng(2)
    flank, low = flanks_of(cells), 0.004
    flank += 0.003 * random.choice([-1.0, 1.0], len(flank))[:, None, None, None]
    flank[3] = 0.0
    flank[3, 0] -= low
    flank[3, 0, 2:5, 3:7] -= 0.1
    flank += NOISE / 2.0 * random.standard_normal(flank.shape)
    _, perhaps = at_own_level(with_flanks(cells, flank), NOISE, INDEXED)
    whole = toothed_area(cells.grid) * cells.grid.flank * int(cells.grid.toothed.sum())
    assert perhaps == pytest.approx(low * whole, rel=0.1)


@pytest.mark.long
def test_flanks_seen_from_end_to_end_of_both_halves_are_seen_whole():
    points = double_scan(TWO, 80_000, noise=0.005, seed=3).points
    measured = gw.register(Design({"gear": designed_double(TWO)}), gw.as_scan(points))
    assert measured.cells.grid.groove_rows > 0
    assert {name: share for name, share in measured.coverage.items() if name in {"flank", "fillet", "tip"} and share < 0.95} == {}

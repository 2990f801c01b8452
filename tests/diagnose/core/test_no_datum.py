"""Scans that have nothing to hold the gear but flanks that may be worn: of points put where they are by code that shares nothing with the fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, ROOT, TIP, locate
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.no_datum import _tip, most_lost, without_a_datum
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.placing.side_maps import make_side_maps
from tests.diagnose.plain import PLAIN, PLAIN_AND_ALL
from tests.placing.placing import designed
from tests.synthetic import GearNumbers, Recipe, SlidingWear, make_scan

BORED = GearNumbers(bore_diameter=30.0)
GEAR = designed(BORED)
LEFT, RIGHT, BOTH = frozenset({Side.LEFT}), frozenset({Side.RIGHT}), frozenset(Side)


def seen(wear=(), also=(), sides=BOTH, points=20_000, noise_um=6.0):
    """Cells of the flanks of some sides and all points on some surfaces; and the volume put in."""
    scan = make_scan(Recipe(BORED, jitter=1.0, noise_um=noise_um, pose="none", wear=wear).of_size(points), 3)
    located = locate(scan.points, GEAR)
    own = np.isin(located.side, [int(side) for side in sides])
    kept = ((located.surface == FLANK) & own) | np.isin(located.surface, [code for code in also if code != FILLET])
    kept |= (located.surface == FILLET) & own & (FILLET in also)
    located = located.take(kept)
    return bin_points(located, CellGrid.for_scan(GEAR, len(located)), clip=0.3), scan.truth.volume_mm3


def closed(cells, effects=PLAIN):
    return close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), effects)


@pytest.mark.parametrize(
    ("also", "sides", "bare"),
    [
        ((), BOTH, {BOTH}),
        ((END_LOW, END_HIGH), BOTH, {BOTH}),  # ends tell nothing of where the axis is
        ((BORE,), BOTH, set()),
        ((FILLET,), BOTH, set()),
        ((), LEFT, {LEFT, BOTH}),
        ((END_LOW, END_HIGH, BORE), LEFT, {LEFT}),  # which way it is turned
        ((FILLET,), LEFT, set()),
        ((FILLET, TIP, ROOT, END_LOW, END_HIGH, BORE), BOTH, set()),
    ],
    ids=["flanks", "and ends", "and the bore", "and fillets", "left alone", "with ends and bore", "with its fillets", "all"],
)
def test_a_gear_is_held_by_what_does_not_turn_or_shift_on_itself(also, sides, bare):
    cells, _ = seen(also=also, sides=sides)
    context = make_context(cells, np.eye(3), False)
    assert without_a_datum(cells, context) == bare


def common_loss(loop, cells):
    """What `most_lost` comes to on left and right flanks, mm³."""
    sheets = make_side_maps(cells)
    return (np.nan_to_num(most_lost(loop, cells)) * sheets.area[sheets.fillet :]).sum(axis=(1, 2)) * GEAR.teeth


@PLAIN_AND_ALL
def test_of_one_side_alone_its_form_may_be_wear(effects):
    """As much as was lost, whatever effects fit it; of flanks of four columns, which hardly show where it was least, not twice as much."""
    cells, truth = seen((SlidingWear(60.0, 1),), sides=LEFT)
    loop = closed(cells, effects)
    assert (loop.worn_sides, loop.no_datum, loop.undecided) == (frozenset(), LEFT, ())
    assert loop.effects
    assert all("sliding_wear" in effect.alternatives for effect in loop.effects)
    left, right = common_loss(loop, cells)
    assert truth < left < 2.0 * truth
    assert right == 0.0


def test_of_one_side_as_drawn_nothing_is_open():
    cells, _ = seen(sides=LEFT)
    loop = closed(cells)
    assert (loop.effects, loop.no_datum) == ((), LEFT)
    assert float(np.nanmax(most_lost(loop, cells))) == 0.0


def test_of_flanks_alone_a_worn_side_stays_open():
    """That both are worn would leave no cell; that the left ones are leaves the right."""
    cells, truth = seen((SlidingWear(60.0, 1),))
    loop = closed(cells)
    assert LEFT in (loop.worn_sides, *loop.undecided)
    assert BOTH not in (loop.worn_sides, *loop.undecided)
    assert sum(common_loss(loop, cells)) > truth or Side.LEFT in loop.worn_sides


@pytest.mark.parametrize(("columns", "most"), [(4, np.inf), (12, 0.011)])
def test_a_tip_within_a_column_is_found(columns, most):
    """In proportion to the way from the pitch point, where it is 10 µm high: means of columns are lower, and few of them do not tell how much."""
    cells, _ = seen(sides=LEFT, points=2_000)
    grid = replace(cells.grid, flank=columns)
    context = make_context(cells, np.eye(3), False)
    fine = np.sqrt(np.linspace(GEAR.form_roll**2, GEAR.tip_roll**2, 2000 * columns + 1))
    fine = 0.5 * (fine[1:] + fine[:-1])
    profile = (0.01 - 0.01 * np.abs(fine - GEAR.reference_roll)).reshape(columns, -1).mean(axis=1)
    top = _tip(profile, np.full(columns, 1e-4), np.ones(columns, dtype=bool), grid, context)
    assert profile.max() < 0.0099
    assert 0.0099 < top < most

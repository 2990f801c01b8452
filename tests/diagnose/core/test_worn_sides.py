"""Which sides are worn throughout: on scans whose wear is put in by code that shares nothing with the fit."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import locate
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.worn_sides import NO_SIDE, chosen, not_excluded
from gearwear.placing.cells import CellGrid, bin_points, noise
from tests.placing.placing import designed
from tests.synthetic import Effect, Patch, Recipe, SlidingWear, make_scan

PINION = designed()
LEFT, RIGHT, BOTH = frozenset({Side.LEFT}), frozenset({Side.RIGHT}), frozenset(Side)
PATCHES = (Patch(1, 1, 80.0, (36.5, 42.5), (2.0, 11.0)), Patch(7, -1, 150.0, (36.5, 42.5), (2.0, 11.0)))


def worn_sides(wear, effects=(), seed=3):
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=effects).of_size(20_000), seed)
    located = locate(scan.points, PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=0.3)
    return close_loop(cells, noise(cells), make_context(cells, np.eye(3), False)).worn_sides


@pytest.mark.parametrize(
    ("wear", "sides"),
    [
        ((SlidingWear(60.0, 1, law="archard"),), LEFT),
        ((SlidingWear(60.0, 1, law="archard"), SlidingWear(35.0, -1, law="archard")), BOTH),
        (PATCHES, NO_SIDE),
    ],
    ids=["left", "both", "patches"],
)
def test_the_sides_that_were_worn_are_the_sides_called_worn(wear, sides):
    assert worn_sides(wear) == sides


@pytest.mark.parametrize(
    "effect",
    [
        Effect("tip_relief", {"amount_um": 25.0, "start_mm": 20.0}),
        Effect("profile_crowning", {"crowning_um": 20.0}),
        Effect("profile_slope", {"left_um": 20.0, "right_um": -15.0}),
    ],
    ids=lambda effect: effect.name,
)
def test_what_was_made_alike_on_all_teeth_is_not_called_wear(effect):
    assert worn_sides(PATCHES, (effect,)) == NO_SIDE


def test_no_side_is_worn_unless_that_is_cheaper_by_more_than_chance():
    assert chosen({NO_SIDE: 100.0, LEFT: 92.0, BOTH: 95.0}) == NO_SIDE
    assert chosen({NO_SIDE: 100.0, LEFT: 90.0, BOTH: 89.0}) == BOTH


def test_what_is_not_excluded_is_as_cheap_but_for_chance_and_says_something():
    assert not_excluded({NO_SIDE: 100.0, LEFT: 92.0, BOTH: 101.0}) == (LEFT,)
    assert not_excluded({NO_SIDE: 100.0, LEFT: 40.0, RIGHT: 48.0, BOTH: 50.0}) == (RIGHT,)
    assert not_excluded({NO_SIDE: 100.0, LEFT: 90.5}) == ()
    assert not_excluded({NO_SIDE: 100.0}) == ()

"""What views out of place may leave: fields of rigid motions put in and asked back, and effects in closed form that are none."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import flank_points
from gearwear.diagnose.as_views import may_be_views, share_moved
from gearwear.diagnose.rules import rules

GEAR = Gear.from_spec(GearSpec("gear", 20, 3.0, 20.0))


def points():
    random, number = np.random.default_rng(0), 20_000
    return flank_points(
        GEAR,
        random.integers(0, 20, number),
        random.choice([1, -1], number),
        random.uniform(GEAR.form_roll, GEAR.tip_roll, number),
        random.uniform(0.0, 20.0, number),
    )


POINTS = points()
EVERY = np.ones(len(POINTS), dtype=bool)
HEIGHT, ANGLE = POINTS.position[:, 2] / 20.0 - 0.5, np.arctan2(POINTS.position[:, 1], POINTS.position[:, 0])
SIDE = POINTS.side.astype(float)


def test_quarters_that_were_moved_are_told_whole():
    """Each by a translation and a turn of its own, the borders at multiples of 90°."""
    random, field = np.random.default_rng(1), np.zeros(len(POINTS))
    for quarter in range(4):
        here = np.floor(np.mod(ANGLE, 2.0 * np.pi) / (0.5 * np.pi)) == quarter
        shift, turn = random.normal(size=3), random.normal(scale=0.05, size=3)
        field[here] = ((shift + np.cross(turn, POINTS.position)) * POINTS.normal).sum(axis=1)[here]
    assert share_moved(POINTS, field, EVERY) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("field", "may_be"),
    [
        (SIDE * HEIGHT, True),
        (SIDE * HEIGHT * np.sin(ANGLE), True),
        (POINTS.normal[:, 0], True),
        (SIDE * np.cos(2.0 * ANGLE), True),
        (np.ones(len(POINTS)), False),
        (HEIGHT, False),
        (POINTS.roll - POINTS.roll.mean(), False),
        (HEIGHT**2, False),
        (SIDE * np.random.default_rng(2).normal(size=20)[POINTS.tooth], False),
    ],
    ids=["helix slope", "wobble", "eccentricity", "table, twice round", "coat", "taper", "profile slope", "crowning", "pitch"],
)
def test_slopes_and_waves_may_be_views_and_forms_are_not(field, may_be):
    assert (share_moved(POINTS, field, EVERY) >= rules().moved) is may_be


def test_what_is_no_larger_than_views_lie_apart_may_be_theirs_whatever_it_looks_like():
    """Pitch errors of 3 µm RMS beside views that lie 4 or 2 µm off; a slope however large is what moved quarters leave."""
    pitch = 0.003 * SIDE * np.sign(np.random.default_rng(2).normal(size=20))[POINTS.tooth]
    assert may_be_views(POINTS, pitch, EVERY, 0.003, 0.004) and not may_be_views(POINTS, pitch, EVERY, 0.003, 0.002)
    assert may_be_views(POINTS, 0.1 * SIDE * HEIGHT, EVERY, 0.03, 0.002)


def test_of_nothing_no_view_takes_a_share():
    assert share_moved(POINTS, np.zeros(len(POINTS)), EVERY) == 0.0
    assert share_moved(POINTS, HEIGHT, ~EVERY) == 0.0

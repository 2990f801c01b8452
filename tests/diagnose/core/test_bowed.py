"""What a bow of the sound flanks makes of their mean, against closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FLANK
from gearwear.diagnose.bowed import bow_of_sound
from gearwear.diagnose.effects.base import helix_place, profile_coordinate
from gearwear.diagnose.side_costs import NO_SIDE
from tests.diagnose.core.test_worn_sides import LEFT, PINION, binned, explained
from tests.diagnose.plain import PLAIN
from tests.synthetic import Effect, SlidingWear

BULGE, CROWNING = 0.009, 0.006
SEEDS = 100


@pytest.fixture(scope="module")
def cells():
    return binned(())


def fit_of(cells, residual):
    flank = cells.seen & (cells.points.surface == FLANK)
    return SimpleNamespace(cells=cells, use=flank, weight=np.ones(len(flank)), residual=lambda _: residual)


def test_a_bulge_and_a_crowning_lower_the_mean_by_a_third_of_each(cells):
    """∫ u² over −1 … 1 is a third of its range; levels and slopes of the flanks, and the worn side, say nothing."""
    points = cells.points
    u, v = profile_coordinate(points, PINION), 2.0 * helix_place(points, PINION)
    sound = points.side == int(Side.RIGHT)
    plain = np.where(sound, 0.004 + 0.02 * u - 0.01 * v, 0.3 * u**2)
    bowed = plain - np.where(sound, BULGE * u**2 + CROWNING * v**2, 0.0)
    assert bow_of_sound(fit_of(cells, plain), (), LEFT) == pytest.approx(0.0, abs=1e-9)
    assert bow_of_sound(fit_of(cells, bowed), (), LEFT) == pytest.approx((BULGE + CROWNING) / 3.0, rel=0.06)
    assert bow_of_sound(fit_of(cells, bowed), (), frozenset(Side)) == 0.0  # nothing is sound


def test_bows_of_single_teeth_that_are_chance_leave_what_chance_leaves(cells):
    """Each tooth bowed by a normal amount of its own: of low² less its variance what is above 0 comes to 2 φ(1) = 0.484 of the mean of low²."""
    points, rng = cells.points, np.random.default_rng(4)
    flank = cells.seen & (points.surface == FLANK)
    u, whole = profile_coordinate(points, PINION) ** 2, profile_coordinate(points.take(flank), PINION) ** 2
    told, low = np.zeros(SEEDS), np.zeros(SEEDS)
    for i in range(SEEDS):
        bows = rng.normal(0.0, BULGE, PINION.teeth)
        told[i] = bow_of_sound(fit_of(cells, -bows[points.tooth] * u), (), NO_SIDE)
        low[i] = bows.mean() * whole.mean()
    assert np.mean(told**2) / np.mean(low**2) == pytest.approx(2.0 * np.exp(-0.5) / np.sqrt(2.0 * np.pi), abs=0.25)


@pytest.mark.parametrize(("crowning_um", "made_um"), [(0.0, (0.0, 2.0)), (9.0, (6.0, 10.0))])
def test_a_crowning_that_has_no_name_is_in_how_high_the_worn_side_may_stand(crowning_um, made_um):
    """Searched without crownings. Twice a third of it, and what a form of all teeth that has no name adds; both sides are cut alike, and only the right one shows it."""
    crowned = (Effect("helix_crowning", {"crowning_um": crowning_um}),)
    loop = explained(binned((SlidingWear(60.0, 1, law="archard"),), crowned), PLAIN)
    assert loop.worn_sides == LEFT
    assert made_um[0] <= 1e3 * loop.made.std <= made_um[1]

"""Where nothing slides, of a gear whose design has no mate: as a loss shows it, at a price; and never where the mate says it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.diagnose import worn_sides
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.pitch_point import STEP, likeliest, pitch_points, price_of
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import noise
from tests.diagnose.core.test_worn_sides import LEFT, PINION, binned
from tests.diagnose.plain import PLAIN, PLAIN_AND_ALL
from tests.synthetic import SlidingWear


def involute(angle):
    return math.tan(angle) - angle


def test_the_price_is_that_of_shifts_that_sum_to_half_a_module_on_gears_alike(context):
    """Their pitch point by inv α_w = inv α + 2 Σx tan α / (z1 + z2) is one standard deviation off, to the second order of the shift."""
    gear = Gear.from_spec(GearSpec("gear", 40, 2.0, 10.0))
    context = replace(context, gear=gear)
    alpha = math.radians(20.0)
    wanted = involute(alpha) + 2.0 * 0.5 * math.tan(alpha) / 80
    working = brentq(lambda angle: involute(angle) - wanted, alpha, 1.0)
    price = price_of(gear.base_radius * math.tan(working), context)
    assert price == pytest.approx(rules().parameter_penalty * rules().shape_price + 1.0, abs=0.15)


@pytest.fixture(scope="module")
def context():
    return make_context(binned(()), np.eye(3), False)


def cells(lost, context, seed=4):
    """Roll, side, deviation of 4000 cells that scatter by 3 µm, on sides that each stand at a level of their own; `lost` of the roll on the right flanks."""
    rng = np.random.default_rng(seed)
    roll, side = rng.uniform(PINION.form_roll, PINION.tip_roll, 4000), rng.choice([-1, 1], 4000)
    level = np.column_stack([side > 0, side < 0]).astype(float)
    target = level @ [0.004, -0.002] + rng.normal(0.0, 0.003, 4000) - np.where(side < 0, lost(roll), 0.0)
    return likeliest(context, roll, side, target, np.full(4000, 0.003**-2), level, 1.0)


def ridge(roll):
    """Of 20 µm, 0.2 modules wide, at the reference circle."""
    return 0.02 * np.exp(-0.5 * ((roll - PINION.reference_roll) / (0.2 * PINION.transverse_module)) ** 2)


@pytest.mark.parametrize("off", [-3.2, 4.1])
def test_a_loss_tells_where_nothing_slid(context, off):
    """Archard's |1 − L_p / L|, below and above by other loads: found to a step, whatever the level of the side."""
    pitch = PINION.reference_roll + off
    found = cells(lambda roll: 0.02 * np.abs(1.0 - pitch / roll) * np.where(roll < pitch, 1.0, 0.6), context)
    assert found is not None and abs(found[0] - pitch) <= STEP * PINION.transverse_module
    assert found[1] == price_of(found[0], context)


def test_without_a_loss_or_with_one_about_the_reference_circle_it_stays_there(context):
    for lost in (lambda roll: 0.0 * roll, lambda roll: 0.02 * np.abs(1.0 - PINION.reference_roll / roll)):
        assert cells(lost, context) is None
    # What plastic flow raised there is no loss beside it.
    assert cells(lambda roll: 0.02 * np.abs(1.0 - PINION.reference_roll / roll) - ridge(roll), context) is None
    rolls = pitch_points(context)
    assert PINION.form_roll < rolls.min() < PINION.reference_roll < rolls.max() < PINION.tip_roll


@pytest.fixture(scope="module")
def slid():
    """Flanks slid about a pitch point 4 mm of roll above the reference circle, 0.63 modules."""
    return binned((SlidingWear(50.0, 1, law="archard", off=4.0),), points=10_000)


@pytest.mark.long
@PLAIN_AND_ALL
def test_a_side_slid_about_another_pitch_point_is_found_worn(slid, effects):
    loop = close_loop(slid, noise(slid), make_context(slid, np.eye(3), False), effects)
    assert loop.worn_sides == LEFT
    column = float(np.diff(slid.grid.roll_edges).mean())
    assert loop.context.pitch == pytest.approx(PINION.reference_roll + 4.0, abs=0.5 * column)
    assert float(loop.context.sliding(np.array([loop.context.pitch_roll]))[0]) == 0.0


def test_a_mate_says_where_it_is_and_nothing_is_looked_for(slid, monkeypatch):
    def asked(*_):
        raise AssertionError("the mate has told")

    monkeypatch.setattr(worn_sides, "likeliest", asked)
    pitch, ratio = PINION.reference_roll + 4.0, 2.0
    loop = close_loop(slid, noise(slid), make_context(slid, np.eye(3), False, mate=(ratio, (1.0 + ratio) * pitch)), PLAIN)
    assert Side.LEFT in loop.worn_sides
    assert loop.context.pitch is None and loop.context.pitch_roll == pytest.approx(pitch)

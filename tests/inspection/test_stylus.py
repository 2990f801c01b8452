"""The ball on a trace against closed forms: pit, edge, sinusoid; and on a gear."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwear.design import Gear, GearSpec
from gearwear.inspection import Settings, inspect
from gearwear.inspection.stylus import closed, felt
from tests.inspection.synthetic import displaced, flanks, hand_traces

X = np.linspace(-2.0, 2.0, 2001)
STEP = X[1] - X[0]


@pytest.mark.parametrize(("width", "radius"), [(0.4, 0.5), (0.2, 1.0), (0.8, 0.41)])
def test_a_deep_pit_is_bridged_by_the_arc(width, radius):
    """The ball rests on both edges: its lowest point lies R − √(R² − w²/4) below them."""
    inside = np.abs(X) < 0.5 * width - 1e-9
    found = closed(X, np.where(inside, -2.0, 0.0), radius)
    sunk = math.sqrt(radius**2 - 0.25 * width**2)
    expected = np.where(inside, sunk - np.sqrt(radius**2 - np.where(inside, X, 0.0) ** 2), 0.0)
    # An edge lies between two samples: half a step on either side, at the slope of the ball there.
    np.testing.assert_allclose(found, expected, atol=STEP * 0.5 * width / sunk + STEP**2 / (8.0 * radius))


def test_the_foot_of_a_step_is_the_balls_arc():
    """Height h: the ball touches the corner and the floor, its centre √(2 R h − h²) beside the corner."""
    height, radius = 0.1, 0.5
    found = closed(X, np.where(X <= 0.0, 0.0, -height), radius)
    reach = math.sqrt(2.0 * radius * height - height**2)
    within = (X > 0.0) & (reach > X)
    expected = np.where(X <= 0.0, 0.0, -height)
    expected[within] = -height + radius - np.sqrt(radius**2 - (X[within] - reach) ** 2)
    np.testing.assert_allclose(found, expected, atol=STEP * reach / (radius - height) + STEP**2 / (8.0 * radius))


@pytest.mark.parametrize("radius", [0.5, 2.0, 6.0])
def test_a_sinusoid(radius):
    """Where the ball is less curved than the valley it rests on two points: their slope is that of the ball."""
    a, wave = 0.02, 1.0
    k = 2.0 * math.pi / wave
    found = closed(X, -a * np.cos(k * X), radius)
    assert (found >= -a * np.cos(k * X) - 1e-15).all()
    if radius < 1.0 / (a * k**2):
        lowest = -a
    else:
        touch = brentq(lambda x: a * k * math.sin(k * x) - x / math.sqrt(radius**2 - x * x), 1e-4, 0.5 * wave - 1e-9)
        lowest = -a * math.cos(k * touch) - (radius - math.sqrt(radius**2 - touch**2))
    assert found[1000] == pytest.approx(lowest, abs=STEP**2 / (8.0 * radius) + a * (k * STEP) ** 2)


def test_closing_is_extensive_increasing_and_idempotent():
    rng = np.random.default_rng(6)
    x = np.sort(rng.uniform(0.0, 3.0, 300))
    low = rng.normal(0.0, 0.01, 300)
    high = low + rng.uniform(0.0, 0.01, 300)
    once = closed(x, low, 0.7)
    assert (once >= low - 1e-15).all()
    assert (closed(x, high, 0.7) >= once - 1e-15).all()
    np.testing.assert_allclose(closed(x, once, 0.7), once, atol=1e-12)
    np.testing.assert_allclose(closed(x, low + 5.0, 0.7), once + 5.0, atol=1e-12)


GEAR = Gear.from_spec(GearSpec("gear", 20, 3.0, 20.0))


def test_along_the_profile_the_ball_is_that_against_the_involute():
    """A groove of width w in the arc at L: bridged to R' − √(R'² − w²/4), 1/R' = 1/R + 1/L."""
    roll = np.linspace(GEAR.form_roll + 0.2, GEAR.tip_roll, 1500)
    arc, middle = roll**2 / (2.0 * GEAR.base_radius), 12.0
    width = 0.3
    groove = np.abs(arc - middle**2 / (2.0 * GEAR.base_radius)) < 0.5 * width
    deviation = np.where(groove, -0.5, 0.0)[None, None, :] * np.ones((1, 2, 1))
    traces = hand_traces(roll, deviation, np.full(len(roll), 1e-4))
    found = felt(traces, 1.0, GEAR).deviation[0, 0]
    ball = 1.0 / (1.0 + 1.0 / middle)
    assert found[groove].min() == pytest.approx(-(ball - math.sqrt(ball**2 - 0.25 * width**2)), rel=0.05)
    np.testing.assert_allclose(found[~groove], 0.0, atol=1e-12)
    assert felt(traces, None, GEAR) is traces


def test_an_inspection_with_a_ball_sees_less_of_a_narrow_scratch():
    points = flanks(GEAR, 200, 12)
    scratch = np.where(np.abs(points.roll - 10.0) < 0.15, -0.02, 0.0)
    points = displaced(points, scratch, GEAR)
    plain, ball = (inspect(points, GEAR, Settings(noise=1e-4, stylus_radius=radius)) for radius in (None, 3.0))
    assert np.nanmedian(ball.profile.form.value) < 0.75 * np.nanmedian(plain.profile.form.value)
    np.testing.assert_array_equal(plain.pitch.index.value, ball.pitch.index.value)
    np.testing.assert_allclose(ball.helix.slope.value, plain.helix.slope.value, atol=5e-4)

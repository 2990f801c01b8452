"""The ball on a trace against closed forms: pit, edge, sinusoid; and on a gear."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwear.commands.inspect import main
from gearwear.design import Gear, GearSpec
from gearwear.errors import InputError
from gearwear.inspection import Settings, inspect
from gearwear.inspection.stylus import check_ball, closed, felt
from gearwear.report.records.inspection import as_dict
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
    assert any("stylus ball of 3 mm" in note for note in ball.notes)
    assert as_dict(ball)["profile"]["stylus_radius_mm"] == 3.0 and as_dict(plain)["helix"]["stylus_radius_mm"] is None


@pytest.mark.parametrize("internal", [False, True])
def test_against_a_helical_flank_the_ball_is_that_against_its_normal_section(internal):
    """The curvature is taken by differences from points of the involute helicoid; the groove is bridged to R' − √(R'² − w²/4) along the normal,
    and to 1 / cos β_b of that along the transverse base tangent, as traces are."""
    gear = Gear.from_spec(GearSpec("gear", 50, 3.0, 20.0, helix_angle=math.radians(30.0), internal=internal))
    base, cosine, middle, step = gear.base_radius, gear.base_helix_cosine, 0.5 * (gear.form_roll + gear.tip_roll), 1e-2

    def point(roll):
        angle = roll / base
        return base * np.array([np.cos(angle), np.sin(angle), 0.0]) + roll * np.array([np.sin(angle), -np.cos(angle), 0.0])

    second = (point(middle + step) - 2.0 * point(middle) + point(middle - step)) / (middle * step / base) ** 2
    along = np.array([math.sin(middle / base), -math.cos(middle / base), 0.0])
    normal = cosine * along + math.sqrt(1.0 - cosine**2) * np.array([0.0, 0.0, 1.0])
    first = (point(middle + step) - point(middle - step)) / (2.0 * middle * step / base)
    bent = abs(float((second - (second @ first) * first) @ normal))  # the normal part of how the transverse section bends
    radius, width = 15.0, 3.0  # beside L of about 26 mm: that β_b counts is seen
    roll = np.sort(np.linspace(gear.form_roll, gear.tip_roll, 1500))
    groove = np.abs(roll**2 - middle**2) / (2.0 * base) < 0.5 * width
    station = gear.orientation * roll
    order = np.argsort(station)
    deviation = np.where(groove, -0.9, 0.0)[order][None, None, :] * np.ones((1, 2, 1))
    found = felt(hand_traces(station[order], deviation, np.full(len(roll), 1e-4)), radius, gear).deviation[0, 0]
    ball = 1.0 / (1.0 / radius + gear.orientation * bent)
    assert found.min() == pytest.approx(-(ball - math.sqrt(ball**2 - 0.25 * width**2)) / cosine, rel=0.02)


@pytest.mark.long
def test_a_helix_trace_is_as_long_as_the_helix_at_its_radius():
    gear = Gear.from_spec(GearSpec("gear", 20, 3.0, 20.0, helix_angle=math.radians(30.0)))
    z, width, radius = np.linspace(0.0, 20.0, 2001), 1.2, 1.0
    groove = np.abs(z - 10.0) < 0.5 * width * math.cos(math.radians(30.0))  # square to it, on the reference cylinder
    traces = hand_traces(z, np.where(groove, -0.9, 0.0)[None, None, :] * np.ones((1, 2, 1)), np.full(len(z), 1e-4), "z")
    traces = replace(traces, band=(gear.reference_roll - 1.0, gear.reference_roll + 1.0))
    found = felt(traces, radius, gear).deviation[0, 0]
    sag = (radius - math.sqrt(radius**2 - 0.25 * width**2)) / gear.base_helix_cosine
    assert found.min() == pytest.approx(-sag, abs=0.01 * 0.6 / 0.8)


@pytest.mark.parametrize("radius", [math.inf, math.nan, 1e200, 1e-300, 0.0, -1.0])
def test_a_ball_of_no_sense_is_refused(radius):
    with pytest.raises(InputError, match=r"0\.01 to 100 mm"):
        check_ball(radius, GEAR)


def test_a_ball_that_does_not_fit_a_ring_is_refused():
    ring = Gear.from_spec(GearSpec("gear", 50, 3.0, 20.0, internal=True))
    check_ball(0.99 * ring.tip_roll, ring)
    with pytest.raises(InputError, match="does not fit the ring's hollow flanks"):
        check_ball(1.01 * ring.tip_roll, ring)
    check_ball(99.0, GEAR)


def test_the_command_refuses_it_in_one_line(capsys, tmp_path):
    assert main(["--stylus-radius-mm", "inf", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.strip() == "gearwear: stylus radius inf mm: a ball of 0.01 to 100 mm would be right"

import numpy as np
import pytest

from gearwear.diagnose.effects.scan_drift import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [
    Example({"closure_deg": closure, "start_deg": start}, (np.radians(closure),), (np.radians(start),), gear=gear)
    for closure, start, gear in ((0.05, 40.0, BORED), (-0.03, 310.0, BORED), (0.06, 200.0, ODD))
]


def displace(sample, parameters, shape):
    share = np.mod(sample.theta - np.radians(parameters["start_deg"]), 2 * np.pi) / (2 * np.pi)
    return sample.turned(np.radians(parameters["closure_deg"]) * (share - 0.5))


def test_the_seam_jumps_back_by_the_closure_where_the_scan_started():
    points = feet()
    turn = sample(BORED).outline.base_radius * points.side
    flank = points.surface == 0
    theta = np.degrees(np.arctan2(points.position[:, 1], points.position[:, 0])) % 360.0
    rate = (EFFECT.basis(points, context(), (np.radians(100.0),))[:, 0] / np.where(flank, turn, 1.0))[flank]
    theta = theta[flank]
    assert rate[(theta > 100.0) & (theta < 130.0)].max() < -0.5 + 30.0 / 360.0
    assert rate[(theta > 70.0) & (theta < 100.0)].min() > 0.5 - 30.0 / 360.0


def test_the_uncertainty_of_the_seam_is_that_of_a_jump_in_noise():
    """Simulated: a saw tooth in white noise, its start found by trying every place; the claim holds within a fifth."""
    rng = np.random.default_rng(3)
    n, sigma, closure = 3000, 1.0, 0.8
    share = (np.arange(n) + 0.5) / n
    starts = []
    for _ in range(300):
        data = closure * (np.mod(share - 0.5, 1.0) - 0.5) + sigma * rng.standard_normal(n)
        # |data − c (share − start − ½)|² over all starts: the cross term is all that changes with the start
        falls = np.concatenate([[0.0], np.cumsum(data)[:-1]]) - share * data.sum()
        starts.append(share[np.argmax(falls * np.sign(closure))] - 0.5)
    error = 2 * np.pi * np.array(starts)
    variance = 12.0 * sigma**2 / n
    gear = context().gear
    flank = float(gear.half_angle(gear.reference_radius))
    claim = EFFECT.estimates(np.array([closure]), np.array([[variance]]), (flank,), context())["start_deg"].std
    assert np.degrees(error.std()) == pytest.approx(claim, rel=0.2)


def test_on_a_tip_land_the_start_may_be_anywhere():
    """Points of a tip land do not move when they turn: a jump among them leaves no trace; uniform over the land's width."""
    gear = context().gear
    width = np.degrees(2.0 * float(gear.half_angle(gear.tip_radius)))
    sure = np.array([[1e-12]])
    found = EFFECT.estimates(np.array([0.01]), sure, (3.0 * gear.pitch_angle + 0.004,), context())["start_deg"]
    cell = np.degrees(0.08 * gear.transverse_module / gear.reference_radius)
    assert found.std == pytest.approx(np.hypot(width, cell) / np.sqrt(12.0), rel=0.01)

import numpy as np

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

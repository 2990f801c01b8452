import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.tip_relief import EFFECT
from tests.diagnose.sample import ODD, Example, context

EXAMPLES = [
    Example({"amount_um": 25.0, "start_mm": 20.0, "exponent": 1.0}, (0.025,), (20.0,)),
    Example({"amount_um": 15.0, "start_mm": 13.0, "exponent": 2.0}, (0.015,), (13.0, 2.0), ODD),
]


def displace(sample, parameters, shape):
    start = parameters["start_mm"]
    share = np.clip((np.nan_to_num(sample.roll) - start) / (sample.outline.tip_roll - start), 0.0, 1.0)
    return sample.along_base(-1e-3 * parameters["amount_um"] * share ** parameters["exponent"])


def test_is_all_at_the_tip_nothing_at_its_start_and_half_half_way():
    gear = context().gear
    roll = np.array([10.0, 20.0, 0.5 * (20.0 + gear.tip_roll), gear.tip_roll])
    points = flank_points(gear, np.zeros(4, int), np.ones(4, int), roll, np.full(4, 4.0))
    np.testing.assert_allclose(EFFECT.basis(points, context(), (20.0,))[:, 0], [0.0, 0.0, -0.5, -1.0], atol=1e-12)
    np.testing.assert_allclose(EFFECT.basis(points, context(), (20.0, 2.0))[:, 0], [0.0, 0.0, -0.25, -1.0], atol=1e-12)

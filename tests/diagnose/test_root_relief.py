import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.root_relief import EFFECT
from tests.diagnose.sample import ODD, Example, context

EXAMPLES = [
    Example({"amount_um": 25.0, "start_mm": 11.0}, (0.025,), (11.0,)),
    Example({"amount_um": 15.0, "start_mm": 12.0}, (0.015,), (12.0,), ODD),
]


def displace(sample, parameters, shape):
    start = parameters["start_mm"]
    share = np.clip((start - sample.roll) / (start - sample.outline.form_roll), 0.0, 1.0)
    return sample.along_base(np.where(sample.flank, -1e-3 * parameters["amount_um"] * np.nan_to_num(share), 0.0))


def test_is_all_at_the_form_circle_nothing_at_its_start_and_half_half_way():
    gear = context().gear
    roll = np.array([gear.form_roll, 0.5 * (9.0 + gear.form_roll), 9.0, 20.0])
    points = flank_points(gear, np.zeros(4, int), np.ones(4, int), roll, np.full(4, 4.0))
    np.testing.assert_allclose(EFFECT.basis(points, context(), (9.0,))[:, 0], [-1.0, -0.5, 0.0, 0.0], atol=1e-12)

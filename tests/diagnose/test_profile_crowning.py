import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.profile_crowning import EFFECT
from tests.diagnose.sample import ODD, Example, context

EXAMPLES = [
    Example({"crowning_um": 9.0}, (0.009,)),
    Example({"crowning_um": -6.0}, (-0.006,), gear=ODD),
]


def displace(sample, parameters, shape):
    return sample.along_base(np.where(sample.flank, -1e-3 * parameters["crowning_um"] * sample.u**2, 0.0))


def test_adds_nothing_at_the_middle_and_takes_all_at_form_circle_and_tip():
    gear = context().gear
    roll = np.array([gear.form_roll, 0.5 * (gear.form_roll + gear.tip_roll), gear.tip_roll])
    points = flank_points(gear, np.zeros(3, int), np.ones(3, int), roll, np.full(3, 4.0))
    np.testing.assert_allclose(EFFECT.basis(points, context(), ())[:, 0], [-1.0, 0.0, -1.0], atol=1e-12)

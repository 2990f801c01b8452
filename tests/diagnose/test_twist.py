import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.twist import EFFECT
from tests.diagnose.sample import ODD, Example, context

EXAMPLES = [
    Example({"twist_um": 20.0}, (0.020,)),
    Example({"twist_um": -16.0}, (-0.016,), gear=ODD),
]


def displace(sample, parameters, shape):
    return sample.along_base(0.5e-3 * parameters["twist_um"] * sample.u * sample.zeta)


def test_profile_slope_at_the_upper_end_less_that_at_the_lower_is_the_twist():
    """The profile slope is the rise from form circle to tip."""
    gear = context().gear
    roll = np.array([gear.form_roll, gear.tip_roll] * 2)
    for side in (1, -1):
        points = flank_points(gear, np.zeros(4, int), np.full(4, side), roll, np.array([15.0, 15.0, 0.0, 0.0]))
        delta = EFFECT.basis(points, context(), ())[:, 0] * 0.02
        np.testing.assert_allclose((delta[1] - delta[0]) - (delta[3] - delta[2]), 0.02, atol=1e-15)

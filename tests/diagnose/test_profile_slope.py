import math

import numpy as np

from gearwear.diagnose.effects.profile_slope import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [
    Example({"left_um": 12.0, "right_um": -7.0}, (0.012, -0.007)),
    Example({"left_um": -9.0, "right_um": 15.0}, (-0.009, 0.015), gear=ODD),
]


def displace(sample, parameters, shape):
    rise = np.where(sample.side > 0, parameters["left_um"], parameters["right_um"])
    return sample.along_base(0.5e-3 * rise * sample.u)


def test_a_pressure_angle_error_is_a_slope():
    """A base radius off by −r sin α dα: dα = 0.1° falls 14.8 µm over the usable 23.3 mm of roll (reference), less a constant."""
    o = sample(BORED).outline
    d_alpha = math.radians(0.1)
    points = feet().take(feet().surface == 0)
    error = -(points.roll - o.reference_roll) * math.tan(math.radians(20.0)) * d_alpha
    fall = -(o.tip_roll - o.form_roll) * math.tan(math.radians(20.0)) * d_alpha
    slope = EFFECT.basis(points, context(), ()) @ [fall, fall]
    np.testing.assert_allclose(np.ptp(error - slope), 0.0, atol=1e-15)
    assert abs(1e3 * fall + 14.8 * (o.tip_roll - o.form_roll) / 23.28) < 0.05

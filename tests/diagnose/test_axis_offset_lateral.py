import numpy as np

from gearwear.diagnose.effects.axis_offset_lateral import EFFECT
from gearwear.placing.pose import motion_columns
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"offset_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, 40.0), (ODD, -30.0))]


def displace(sample, parameters, shape):
    return sample.turned(1e-3 * parameters["offset_um"] / sample.radius)


def test_a_rotation_explains_all_but_a_little_of_it_on_flanks():
    """The reference's numbers: R² 0.996, and about 0.13 h from least to greatest is left on a side."""
    points = feet().take(feet().surface == 0)
    own = EFFECT.basis(points, context(), ())[:, 0]
    turn = motion_columns(points.position, points.normal)[:, 5]
    left = own - turn * (turn @ own) / (turn @ turn)
    assert 1.0 - (left @ left) / (own @ own) > 0.99
    assert 0.10 < np.ptp(left[points.side > 0]) < 0.16

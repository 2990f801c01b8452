import numpy as np

from gearwear.diagnose.effects.abrasive_wear import EFFECT
from gearwear.diagnose.effects.tooth_thickness import EFFECT as THICKNESS
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"depth_um": 50.0}, (0.05,), (1.0,)),
    Example({"depth_um": 40.0}, (0.04,), (-1.0,), ODD),
]


def displace(sample, parameters, shape):
    worn = sample.flank & (sample.side == shape[-1])
    return sample.pushed(np.where(worn, -1e-3 * parameters["depth_um"], 0.0))


def test_on_flanks_it_is_a_rotation_of_thinner_teeth():
    """−d on left flanks = thinner by d / cos α on both, and turned by −d / (2 r_b)."""
    points = feet().take(feet().surface == 0)
    rb = context().gear.base_radius
    worn = EFFECT.basis(points, context(), (1.0,))[:, 0] * 0.05
    thinner = THICKNESS.basis(points, context(), (0.0,))[:, 0] * (-0.05 / np.cos(np.radians(20.0)))
    np.testing.assert_allclose(worn, thinner - 0.05 / (2 * rb) * points.side * rb, atol=1e-15)

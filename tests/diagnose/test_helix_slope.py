import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.helix_slope import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"slope_um": 20.0}, (0.020,), (1.0,)),
    Example({"slope_um": -12.0}, (-0.012,), (0.0,), ODD),
]


def displace(sample, parameters, shape):
    """A screw: each height of the toothing turned by as much."""
    return sample.cut(1e-3 * parameters["slope_um"] * sample.zeta / sample.outline.base_radius, fillets=shape[0])


def test_from_end_to_end_a_left_flank_gains_the_slope_and_a_right_flank_loses_it():
    gear = context().gear
    for side in (1, -1):
        points = flank_points(gear, np.full(2, 3), np.full(2, side), np.full(2, 12.0), np.array([0.0, 15.0]))
        low, high = EFFECT.basis(points, context(), (0.0,))[:, 0] * 0.02
        np.testing.assert_allclose([high - low, high + low], [side * 0.02, 0.0], atol=1e-15)
    every = feet()
    assert not EFFECT.basis(every, context(), (0.0,))[every.surface != 0].any()

import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.taper import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"taper_um": 20.0}, (0.020,), (1.0,)),
    Example({"taper_um": -12.0}, (-0.012,), (0.0,), ODD),
]


def displace(sample, parameters, shape):
    gain = 1e-3 * parameters["taper_um"] * sample.zeta
    return sample.cut(sample.side * gain / sample.outline.base_radius, fillets=shape[0])


def test_both_flanks_gain_the_taper_from_the_lower_end_to_the_upper():
    gear = context().gear
    for side in (1, -1):
        points = flank_points(gear, np.full(2, 3), np.full(2, side), np.full(2, 12.0), np.array([0.0, 15.0]))
        np.testing.assert_allclose(EFFECT.basis(points, context(), (0.0,))[:, 0], [-0.5, 0.5], atol=1e-15)
    every = feet()
    assert not EFFECT.basis(every, context(), (0.0,))[every.surface != 0].any()

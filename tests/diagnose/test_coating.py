import math

import numpy as np

from gearwear.diagnose.effects.coating import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"thickness_um": 20.0}, (0.020,), gear=gear) for gear in (BORED, ODD)]


def displace(sample, parameters, shape):
    return sample.pushed(1e-3 * parameters["thickness_um"])


def test_on_flanks_alone_it_is_a_thicker_tooth():
    """Offset of an involute by t is the same involute turned by t / r_b: s = 2 t / cos α at the reference circle."""
    from gearwear.diagnose.effects.tooth_thickness import EFFECT as THICKNESS

    points = feet().take(feet().surface == 0)
    coat = EFFECT.basis(points, context(), ()) @ [0.02]
    thicker = THICKNESS.basis(points, context(), (0.0,)) @ [2 * 0.02 / math.cos(math.radians(20.0))]
    np.testing.assert_allclose(coat, thicker, rtol=0, atol=1e-15)

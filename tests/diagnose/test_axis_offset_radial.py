import numpy as np

from gearwear.diagnose.effects.axis_offset_radial import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"offset_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, 20.0), (ODD, -15.0))]


def displace(sample, parameters, shape):
    return sample.grown(1e-3 * parameters["offset_um"])


def test_goes_as_one_to_a_third_to_one_on_tip_pitch_and_root():
    """L / r = sin α_r on flanks: 0.342 at the pitch point (sin 20°), 1 on tip and root lands, −1 in the bore."""
    points = feet()
    basis, surface = EFFECT.basis(points, context(), ())[:, 0], points.surface
    flank = surface == 0
    np.testing.assert_allclose(basis[flank], points.roll[flank] / np.hypot(points.roll[flank], 35.8022889), rtol=1e-7)
    for code, value in ((3, 1.0), (2, 1.0), (6, -1.0), (4, 0.0), (5, 0.0)):
        np.testing.assert_allclose(basis[surface == code], value, atol=1e-12)

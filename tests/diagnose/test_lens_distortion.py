import numpy as np

from gearwear.diagnose.effects.lens_distortion import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"bow_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, 25.0), (ODD, -15.0))]


def displace(sample, parameters, shape):
    return sample.grown(1e-3 * parameters["bow_um"] * (2.0 * sample.zeta) ** 2)


def test_bows_tip_and_root_lands_alike_which_crowning_leaves_straight():
    points = feet()
    basis = EFFECT.basis(points, context(), ())[:, 0]
    height = (points.position[:, 2] / 7.5 - 1.0) ** 2
    for land in (2, 3):
        np.testing.assert_allclose(basis[points.surface == land], height[points.surface == land], atol=1e-12)
    assert not EFFECT.applies(context(planar=True))

import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.incidence_bias import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [Example({"bias_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, 20.0), (ODD, -15.0))]


def displace(sample, parameters, shape):
    cosine = np.abs((sample.position * sample.normal)[:, :2].sum(axis=1) / sample.radius)
    end = np.isin(sample.surface, (4, 5))
    return sample.pushed(np.where(end, 0.0, 1e-3 * parameters["bias_um"] * (1.0 - cosine)))


def test_on_flanks_it_is_a_range_error_by_the_lengthening_of_the_spot():
    """Along the radial beam the range errs by b (1 / cos i − 1)."""
    one = sample()
    cosine = (one.position * one.normal)[one.flank, :2].sum(axis=1) / one.radius[one.flank]
    along_beam = (1.0 / cosine - 1.0) * cosine
    np.testing.assert_allclose(EFFECT.basis(feet(), context(), ())[one.flank, 0], along_beam, atol=1e-12)


def test_angles_of_incidence_are_the_references():
    """A radial beam meets the flank at 90° − α_r: 70.0° at the pitch point, 53.7° at the tip."""
    points = flank_points(context().gear, np.zeros(2, int), np.ones(2, int), np.array([13.030967, 26.343853]), np.full(2, 4.0))
    angle = np.degrees(np.arccos(1.0 - EFFECT.basis(points, context(), ())[:, 0]))
    np.testing.assert_allclose(angle, [70.0, 90.0 - 36.346184], atol=1e-5)
    others = np.isin(feet().surface, (2, 3, 4, 5, 6))
    np.testing.assert_allclose(EFFECT.basis(feet(), context(), ())[others], 0.0, atol=1e-12)

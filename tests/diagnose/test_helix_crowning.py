import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.helix_crowning import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"crowning_um": 9.0}, (0.009,), (1.0,)),
    Example({"crowning_um": -6.0}, (-0.006,), (0.0,), ODD),
]


def displace(sample, parameters, shape):
    loss = 1e-3 * parameters["crowning_um"] * (2.0 * sample.zeta) ** 2
    return sample.cut(-sample.side * loss / sample.outline.base_radius, fillets=shape[0])


def test_adds_nothing_at_mid_face_and_takes_all_at_both_ends():
    gear = context().gear
    points = flank_points(gear, np.zeros(3, int), -np.ones(3, int), np.full(3, 12.0), np.array([0.0, 7.5, 15.0]))
    np.testing.assert_allclose(EFFECT.basis(points, context(), (0.0,))[:, 0], [-1.0, 0.0, -1.0], atol=1e-12)
    every = feet()
    assert not EFFECT.basis(every, context(), (0.0,))[every.surface != 0].any()


def test_a_narrower_mate_leaves_both_ends_of_the_face():
    """Even wear between them is hollow lengthwise; no wear bulges."""
    assert EFFECT.like_even_wear(np.array([-0.05]), (0.0,), context())
    assert not EFFECT.like_even_wear(np.array([0.05]), (0.0,), context())

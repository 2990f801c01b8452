from dataclasses import replace

import numpy as np

from gearwear.design.side import Side
from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.helix_crowning import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"crowning_um": 9.0}, (0.009,), (1.0,)),
    Example({"crowning_um": -6.0}, (-0.006,), (0.0,), ODD),
    Example({"crowning_um": 5.0, "left_um": 9.0, "right_um": 1.0}, (0.009, 0.001), (1.0, 2.0)),
]


def displace(sample, parameters, shape):
    both = parameters["crowning_um"]
    crowning = np.where(sample.side > 0, parameters.get("left_um", both), parameters.get("right_um", both))
    loss = 1e-3 * crowning * (2.0 * sample.zeta) ** 2
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


def test_sides_of_their_own_are_their_mean_and_their_difference():
    every = feet()
    of_sides, of_all = (EFFECT.basis(every, context(), shape) for shape in ((1.0, 2.0), (1.0,)))
    np.testing.assert_allclose(of_sides.sum(axis=1), of_all[:, 0], atol=1e-15)
    assert not of_sides[every.side < 0, 0].any() and not of_sides[every.side > 0, 1].any()


def test_a_side_worn_throughout_was_crowned_as_the_other():
    every = feet()
    for side in Side:
        told = EFFECT.basis(every, replace(context(), worn=frozenset({side})), (1.0, 2.0))
        np.testing.assert_allclose(told[:, side.opposite.index], EFFECT.basis(every, context(), (1.0,))[:, 0], atol=1e-15)
        assert not told[:, side.index].any()

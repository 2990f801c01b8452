import numpy as np

from gearwear.diagnose.effects.tip_diameter import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"diameter_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, -80.0), (ODD, 50.0))]


def displace(sample, parameters, shape):
    return sample.grown(np.where(sample.surface == 3, 0.5e-3 * parameters["diameter_um"], 0.0))


def test_only_tips_move_by_half_of_it():
    points = feet()
    basis = EFFECT.basis(points, context(), ())[:, 0]
    np.testing.assert_array_equal(basis, np.where(points.surface == 3, 0.5, 0.0))
    whole = context()
    assert not EFFECT.applies(type(whole)(whole.gear, frozenset({0, 1, 2}), whole.scan_axes))

import numpy as np
import pytest

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.end_relief import EFFECT, LONGEST
from gearwear.diagnose.effects.helix_crowning import EFFECT as HELIX_CROWNING
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"amount_um": 9.0, "length_mm": 3.0, "exponent": 1.0}, (0.009,), (3.0, 1.0)),
    Example({"amount_um": 14.0, "length_mm": 2.5, "exponent": 2.0}, (0.014,), (2.5, 0.0, 2.0), ODD),
]


def displace(sample, parameters, shape):
    width = sample.outline.face_width
    into = np.clip(1.0 - width * (0.5 - np.abs(sample.zeta)) / parameters["length_mm"], 0.0, None) ** parameters["exponent"]
    return sample.cut(-sample.side * 1e-3 * parameters["amount_um"] * into / sample.outline.base_radius, fillets=shape[1])


def test_takes_all_at_the_ends_half_half_way_and_nothing_in_the_middle():
    gear = context().gear
    heights = np.array([0.0, 1.5, 3.0, 7.5, 13.5, 15.0])
    points = flank_points(gear, np.zeros(6, int), np.ones(6, int), np.full(6, 12.0), heights)
    np.testing.assert_allclose(EFFECT.basis(points, context(), (3.0, 0.0))[:, 0], [-1.0, -0.5, 0.0, 0.0, -0.5, -1.0], atol=1e-12)
    np.testing.assert_allclose(
        EFFECT.basis(points, context(), (3.0, 0.0, 2.0))[:, 0], [-1.0, -0.25, 0.0, 0.0, -0.25, -1.0], atol=1e-12
    )
    every = feet()
    assert not EFFECT.basis(every, context(), (3.0, 0.0))[every.surface != 0].any()


@pytest.mark.parametrize("exponent", LONGEST)
def test_the_longest_explains_95_percent_of_a_crowning(exponent):
    """Over evenly spaced heights, a level aside."""
    gear = context().gear
    z = np.linspace(0.0, gear.face_width, 1501)
    points = flank_points(gear, np.zeros(len(z), int), np.ones(len(z), int), np.full(len(z), 12.0), z)
    crowned = HELIX_CROWNING.basis(points, context(), (0.0,))[:, 0]
    relieved = EFFECT.basis(points, context(), (LONGEST[exponent] * gear.face_width, 0.0, exponent))[:, 0]
    crowned, relieved = crowned - crowned.mean(), relieved - relieved.mean()
    assert abs((crowned @ relieved) ** 2 / (crowned @ crowned) / (relieved @ relieved) - 0.95) < 0.006

import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.base import Context
from gearwear.diagnose.effects.sliding_wear import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context

EXAMPLES = [
    Example({"depth_um": 50.0}, (0.05,), (1.0,)),
    Example({"depth_um": 40.0}, (0.04,), (-1.0,), ODD),
]
PAIR = {BORED: (24 / 12, 39.0929023821), ODD: (31 / 17, 33.8252053311)}
"""Ratio and length of the line of action of the two pairs, mm."""


def displace(sample, parameters, shape):
    """Archard: depth in proportion to the difference of the surface speeds over the own speed, both from the roll lengths."""
    ratio, line = PAIR[sample.outline.numbers]

    def sliding(own):
        return np.abs(own - (line - own) / ratio) / own

    worn = sample.flank & (sample.side == shape[-1])
    roll = np.where(worn, sample.roll, 1.0)
    depth = 1e-3 * parameters["depth_um"] * sliding(roll) / sliding(sample.outline.form_roll)
    return sample.pushed(np.where(worn, -depth, 0.0))


def test_specific_sliding_is_the_references():
    """K1 of the pinion: −4.89 at L = 3.06, −0.943 at 8, 0 at the pitch point, 0.758 at the tip."""
    gear = context().gear
    roll = np.array([3.06, 8.0, 13.030967, 26.344])
    points = flank_points(gear, np.zeros(4, int), np.ones(4, int), roll, np.full(4, 4.0))
    share = EFFECT.basis(points, context(), (1.0,))[:, 0]
    np.testing.assert_allclose(
        share / share[0], np.array([-4.89, -0.943, 0.0, 0.758]) / -4.89 * np.array([1, 1, 1, -1]), atol=1e-3
    )


def test_without_a_mate_it_goes_as_one_less_the_pitch_point_over_the_roll():
    """K1 = (1 + 1 / u) (1 − L_pitch / L1) for every mate, so the factor drops out against the form circle."""
    gear = context().gear
    alone = Context(gear, context().surfaces, np.eye(3))
    far = 2 * gear.reference_roll - gear.form_roll
    roll = np.array([gear.form_roll, gear.reference_roll, far])
    above = (1.0 - gear.reference_roll / far) / (gear.reference_roll / gear.form_roll - 1.0)
    points = flank_points(gear, np.zeros(3, int), np.ones(3, int), roll, np.full(3, 4.0))
    np.testing.assert_allclose(EFFECT.basis(points, alone, (1.0,))[:, 0], [-1.0, 0.0, -above], atol=1e-12)

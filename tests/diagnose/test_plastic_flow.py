import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.plastic_flow import EFFECT
from tests.diagnose.sample import ODD, Example, context

EXAMPLES = [
    Example({"height_um": -30.0, "width_mm": 1.5}, (-0.03,), (1.5, 1.0)),
    Example({"height_um": 20.0, "width_mm": 0.8}, (0.02,), (0.8, -1.0), ODD),
]


def displace(sample, parameters, shape):
    """A groove or a ridge round the reference circle's roll length on the flanks of one side."""
    here = sample.flank & (sample.side == shape[-1])
    x = (np.where(here, sample.roll, 0.0) - sample.outline.reference_roll) / parameters["width_mm"]
    return sample.pushed(np.where(here, 1e-3 * parameters["height_um"] * np.exp(-0.5 * x**2), 0.0))


def test_is_greatest_at_the_pitch_line_and_gone_three_widths_away():
    roll = 13.030967 + np.array([-4.5, -1.5, 0.0, 1.5, 4.5])
    points = flank_points(context().gear, np.zeros(5, int), np.ones(5, int), roll, np.full(5, 4.0))
    told = np.exp([-4.5, -0.5, 0.0, -0.5, -4.5])
    np.testing.assert_allclose(EFFECT.basis(points, context(), (1.5, 1.0))[:, 0], told, atol=1e-6)

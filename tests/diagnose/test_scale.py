import numpy as np

from gearwear.design.surface import flank_points
from gearwear.diagnose.effects.scale import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"relative_ppm": value}, (1e-6 * value,), gear=gear) for gear, value in ((BORED, 500.0), (ODD, -800.0))]


def displace(sample, parameters, shape):
    return sample.position * (1.0 + 1e-6 * parameters["relative_ppm"])


def test_ten_kelvin_of_steel_are_five_micrometres_at_the_tip():
    """11.5 ppm a kelvin: 1.5 µm at the pitch point, 5.1 µm on tips, 1.7 µm on the upper end face, less in the bore."""
    pitch = flank_points(context().gear, np.zeros(2, int), np.array([1, -1]), np.full(2, 13.030967), np.full(2, 4.0))
    np.testing.assert_allclose(1e3 * EFFECT.basis(pitch, context(), ())[:, 0] * 115e-6, 1.49856, atol=1e-5)
    points = feet()
    grown = 1e3 * EFFECT.basis(points, context(), ())[:, 0] * 115e-6
    for surface, told in ((3, 5.11175), (2, 3.46869), (5, 1.725), (4, 0.0), (6, -1.4375)):
        np.testing.assert_allclose(grown[points.surface == surface], told, atol=1e-5)

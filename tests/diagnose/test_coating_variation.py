import numpy as np

from gearwear.diagnose.effects.coating_variation import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet


def example(amplitude, direction, gear):
    a, d = 1e-3 * amplitude, np.radians(direction)
    return Example({"amplitude_um": amplitude, "direction_deg": direction}, (a * np.cos(d), a * np.sin(d)), gear=gear)


EXAMPLES = [example(6.0, 40.0, BORED), example(4.0, 250.0, ODD)]


def displace(sample, parameters, shape):
    x, y = sample.position[:, 0], sample.position[:, 1]
    d = np.radians(parameters["direction_deg"])
    towards = (x * np.cos(d) + y * np.sin(d)) / np.hypot(x, y)
    return sample.pushed(1e-3 * parameters["amplitude_um"] * towards)


def test_a_translation_takes_the_part_of_the_normals_along_the_radius_alone():
    """Of cos θ on all flanks the translation with the normals' mean radial part, n_r, takes a share n_r² of the square."""
    points = feet().take(feet().surface == 0)
    own, along = EFFECT.basis(points, context(), ()) @ [0.005, 0.0], points.normal[:, :2]
    left = own - along @ np.linalg.lstsq(along, own)[0]
    radius = np.hypot(points.position[:, 0], points.position[:, 1])
    outward = np.mean((points.position[:, :2] * along).sum(axis=1) / radius)
    np.testing.assert_allclose(np.mean(left**2) / np.mean(own**2), 1.0 - outward**2, rtol=1e-9)

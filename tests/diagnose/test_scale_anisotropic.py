import numpy as np
import pytest

from gearwear.diagnose.effects.scale_anisotropic import EFFECT
from gearwear.placing.pose import about_z, flip
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [
    Example({"difference_ppm": 400.0, "direction_deg": 30.0}, (400e-6 * 0.5, 400e-6 * np.sin(np.radians(60.0)))),
    Example({"difference_ppm": 700.0, "direction_deg": 135.0}, (0.0, -700e-6), gear=ODD),
]


def displace(sample, parameters, shape):
    return stretched(sample.position, parameters)


def stretched(points, parameters):
    """Longer by e/2 along the direction, shorter by e/2 across it, in the frame of the points."""
    half, angle = 0.5e-6 * parameters["difference_ppm"], np.radians(parameters["direction_deg"])
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    across = np.array([-along[1], along[0], 0.0])
    return points + half * (points @ along)[:, None] * along - half * (points @ across)[:, None] * across


@pytest.mark.parametrize("pose", [about_z(0.7), about_z(-2.0), flip(15.0), about_z(1.1).then(flip(15.0))], ids=str)
def test_direction_is_in_the_scans_own_axes_for_a_turned_and_for_an_upside_down_part(pose):
    """design = pose(scan): the scanner stretches in its own frame, whichever way the part lies on it."""
    put_in = {"difference_ppm": 300.0, "direction_deg": 25.0}
    scan = pose.inverse().apply(sample(BORED).position)
    moved = pose.apply(stretched(scan, put_in))
    points = feet()
    data = ((moved - sample(BORED).position) * sample(BORED).normal).sum(axis=1)
    about = context(BORED, axes=pose.rotation)
    amplitudes = np.linalg.lstsq(EFFECT.basis(points, about, ()), data, rcond=None)[0]
    found = EFFECT.estimates(amplitudes, np.eye(2) * 1e-14, (), about)
    assert found["difference_ppm"].value == pytest.approx(300.0, rel=1e-9)
    assert found["direction_deg"].value == pytest.approx(25.0, abs=1e-7)


def test_a_shear_is_a_rotation_and_this():
    """x grows by g y: half a turn by −g/2 and a stretch by g at 45°."""
    one, points = sample(BORED), feet()
    shear = 2e-4 * one.position[:, 1] * one.normal[:, 0]
    turn = one.position[:, 0] * one.normal[:, 1] - one.position[:, 1] * one.normal[:, 0]
    np.testing.assert_allclose(shear, EFFECT.basis(points, context(), ()) @ [0.0, 2e-4] - 1e-4 * turn, atol=1e-15)

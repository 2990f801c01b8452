import numpy as np

from gearwear.diagnose.effects.view_registration import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet


def example(x, y, turn, start, end, gear=BORED):
    parameters = {"shift_x_um": x, "shift_y_um": y, "turn_deg": turn, "start_deg": start, "end_deg": end % 360.0}
    return Example(parameters, (1e-3 * x, 1e-3 * y, np.radians(turn)), (np.radians(start), np.radians(end)), gear)


EXAMPLES = [example(30.0, -20.0, 0.02, 40.0, 130.0), example(-15.0, 25.0, -0.03, 250.0, 400.0, ODD)]


def displace(sample, parameters, shape):
    start, end = np.radians(parameters["start_deg"]), np.radians(parameters["end_deg"])
    inside = np.mod(sample.theta - start, 2 * np.pi) < np.mod(end - start, 2 * np.pi)
    shift = 1e-3 * np.array([parameters["shift_x_um"], parameters["shift_y_um"], 0.0])
    return np.where(inside[:, None], sample.turned(np.radians(parameters["turn_deg"])) + shift, sample.position)


def test_a_sector_is_its_complement_moved_the_other_way():
    """The rest is the pose's: basis(sector) + basis(complement) is a rigid motion of everything."""
    points, about = feet(), context()
    start, end = np.radians(70.0), np.radians(170.0)
    both = sum(EFFECT.basis(points, about, shape) for shape in ((start, end), (end, start + 2 * np.pi)))
    np.testing.assert_allclose(both[:, :2], points.normal[:, :2], atol=1e-12)

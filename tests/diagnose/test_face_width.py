import numpy as np

from gearwear.design.surface import END_HIGH, END_LOW
from gearwear.diagnose.effects.face_width import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"width_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, 60.0), (ODD, -40.0))]


def displace(sample, parameters, shape):
    ends = np.isin(sample.surface, (END_LOW, END_HIGH))
    away = np.where(ends, np.sign(sample.zeta) * 0.5e-3 * parameters["width_um"], 0.0)
    return sample.position + away[:, None] * np.array([0.0, 0.0, 1.0])


def test_the_moved_ends_are_as_far_apart_as_it_says():
    points = feet()
    moved = points.position[:, 2] + points.normal[:, 2] * EFFECT.basis(points, context(), ())[:, 0]
    high, low = moved[points.surface == END_HIGH], moved[points.surface == END_LOW]
    np.testing.assert_allclose(high.mean() - low.mean(), BORED.face_width + 1.0, rtol=1e-12)


def test_one_end_alone_does_not_show_it():
    whole = context()
    assert not EFFECT.applies(type(whole)(whole.gear, whole.surfaces - {END_LOW}, whole.scan_axes))

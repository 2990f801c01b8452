import numpy as np

from gearwear.diagnose.effects.height_scale import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet

EXAMPLES = [Example({"relative_ppm": value}, (1e-6 * value,), gear=gear) for gear, value in ((BORED, 1000.0), (ODD, -700.0))]


def displace(sample, parameters, shape):
    return sample.position * np.array([1.0, 1.0, 1.0 + 1e-6 * parameters["relative_ppm"]])


def test_spur_flanks_do_not_show_it_and_one_end_face_is_not_enough():
    points = feet()
    assert not EFFECT.basis(points.take(points.surface <= 3), context(), ()).any()
    whole = context()
    assert EFFECT.applies(whole)
    for end in (4, 5):
        assert not EFFECT.applies(type(whole)(whole.gear, whole.surfaces - {end}, whole.scan_axes))

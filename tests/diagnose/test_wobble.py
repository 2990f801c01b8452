import numpy as np

from gearwear.diagnose.effects.wobble import EFFECT
from tests.diagnose.sample import BORED, ODD, PINION, Example, context, feet


def example(amplitude, direction, shape, gear=BORED):
    a, d = 1e-3 * amplitude, np.radians(direction)
    return Example({"amplitude_um": amplitude, "direction_deg": direction}, (a * np.cos(d), a * np.sin(d)), shape, gear)


EXAMPLES = [example(20.0, 50.0, (1.0,)), example(12.0, 200.0, (0.0,), ODD)]


def displace(sample, parameters, shape):
    """All but the end faces, and the bore where it was made with them, turned about a diameter at mid-face, so that the upper end swings to the direction."""
    d, half = np.radians(parameters["direction_deg"]), 0.5 * sample.outline.face_width
    angle = np.arctan2(1e-3 * parameters["amplitude_um"], half)
    along, up = np.array([np.cos(d), np.sin(d), 0.0]), np.array([0.0, 0.0, 1.0])
    own = sample.position - half * up
    a, z = own @ along, own[:, 2]
    leaning = (
        own + np.outer(a * np.cos(angle) + z * np.sin(angle) - a, along) + np.outer(z * np.cos(angle) - a * np.sin(angle) - z, up)
    )
    still = np.isin(sample.surface, (4, 5) if shape[0] else (4, 5, 6))
    return np.where(still[:, None], sample.position, leaning + half * up)


def test_the_bore_leans_with_the_teeth_or_stays_with_the_ends():
    points = feet()
    leans, stays = (EFFECT.basis(points, context(), (choice,)) for choice in (1.0, 0.0))
    bore = points.surface == 6
    assert np.abs(leans[bore]).max() > 0.5
    assert not stays[bore].any()
    np.testing.assert_array_equal(leans[~bore], stays[~bore])


def test_without_end_faces_it_is_the_poses():
    whole = context()
    assert EFFECT.applies(whole)
    assert not EFFECT.applies(type(whole)(whole.gear, whole.surfaces - {4, 5}, whole.scan_axes))
    no_bore = type(whole)(context(PINION).gear, whole.surfaces - {6}, whole.scan_axes)
    assert EFFECT.shapes(no_bore) == [()]

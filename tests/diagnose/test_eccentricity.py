import numpy as np

from gearwear.diagnose.effects.eccentricity import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet


def example(amplitude, direction, gear=BORED, shape=()):
    a, d = 1e-3 * amplitude, np.radians(direction)
    return Example({"amplitude_um": amplitude, "direction_deg": direction}, (a * np.cos(d), a * np.sin(d)), shape, gear=gear)


EXAMPLES = [example(30.0, 50.0), example(20.0, 290.0, ODD), example(25.0, 120.0, shape=(0.0,))]


def displace(sample, parameters, shape):
    d = np.radians(parameters["direction_deg"])
    shift = 1e-3 * parameters["amplitude_um"] * np.array([np.cos(d), np.sin(d), 0.0])
    stays = np.isin(sample.surface, [6, 3] if shape else [6])  # bore, and tips of a blank that ran true
    return np.where(stays[:, None], sample.position, sample.position + shift)


def test_index_deviation_round_the_gear_is_that_of_the_reference():
    """Cumulative pitch F_p = 2 e / cos α in arc at the reference circle: 42.6 µm for e = 20 µm, seen at the pitch point."""
    from gearwear.design.surface import flank_points

    gear = context().gear
    tooth = np.arange(12)
    index = []
    for direction in np.radians(np.arange(0.0, 360.0, 5.0)):
        points = flank_points(gear, tooth, np.ones(12, int), np.full(12, gear.reference_roll), np.full(12, 7.5))
        delta = EFFECT.basis(points, context(), ()) @ [0.02 * np.cos(direction), 0.02 * np.sin(direction)]
        index.append(np.ptp(delta / np.cos(np.radians(20.0))))
    assert abs(1e3 * max(index) - 42.6) < 0.1


def test_is_named_only_against_a_bore():
    whole = context()
    assert EFFECT.applies(whole)
    assert not EFFECT.applies(type(whole)(whole.gear, whole.surfaces - {6}, whole.scan_axes))
    assert not EFFECT.basis(feet(), whole, ())[feet().surface == 6].any()

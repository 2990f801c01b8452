import numpy as np
import pytest

from gearwear.diagnose.effects.turntable_angle import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet


def example(order, amplitude, phase, **other):
    a, f = np.radians(amplitude), np.radians(phase)
    return Example(
        {"order": order, "amplitude_deg": amplitude, "phase_deg": phase},
        (a * np.cos(f), -a * np.sin(f)),
        (float(order),),
        **other,
    )


EXAMPLES = [example(1, 0.04, 300.0), example(2, 0.045, 310.1), example(13, 0.02, 25.0), example(5, 0.03, 90.0, gear=ODD)]


def displace(sample, parameters, shape):
    wave = np.cos(parameters["order"] * sample.theta + np.radians(parameters["phase_deg"]))
    return sample.turned(np.radians(parameters["amplitude_deg"]) * wave)


def test_orders_above_half_the_teeth_are_not_aliased():
    """Sampled once a tooth, order 13 on 12 teeth is order 1; over the tooth's own width it is not."""
    points = feet(EXAMPLES[0].gear)
    one, thirteen = (EFFECT.basis(points, context(), (float(n),)) for n in (1, 13))
    left = thirteen - one @ np.linalg.lstsq(one, thirteen, rcond=None)[0]
    assert np.linalg.norm(left) > 0.3 * np.linalg.norm(thirteen)


def test_radial_surfaces_and_ends_stay():
    points = feet(EXAMPLES[0].gear)
    basis = EFFECT.basis(points, context(), (3.0,))
    assert np.abs(basis[np.isin(points.surface, (2, 3, 4, 5, 6))]).max() == pytest.approx(0.0, abs=1e-12)

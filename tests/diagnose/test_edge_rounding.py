import numpy as np
import pytest

from gearwear.diagnose.effects.edge_rounding import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"amount_um": 50.0, "width_mm": 4.0}, (0.05,), (4.0,)),
    Example({"amount_um": 40.0, "width_mm": 1.8}, (0.04,), (1.8,), gear=ODD),
]


def displace(sample, parameters, shape):
    """Down along the normal by a parabola that ends half a width from tip corners and face edges."""
    o, width = sample.outline, parameters["width_mm"]
    corner = 1.0 - o.tip_roll / o.tip_radius  # 1 − cos κ between flank and tip land
    within = np.angle(np.exp(1j * (sample.theta - sample.tooth * o.pitch_angle)))
    arc = np.where(sample.surface == 3, o.tip_radius * (o.tip_half_angle - np.abs(within)), np.inf)
    arc[sample.flank] = (o.tip_roll**2 - sample.roll[sample.flank] ** 2) / (2 * o.base_radius)
    face = np.where(sample.teeth, np.minimum(sample.z, o.face_width - sample.z), np.inf)
    tip_fall = np.clip(1 - 2 * arc / width, 0, 1) ** 2
    face_fall = np.clip(1 - 2 * face / width, 0, 1) ** 2 / np.sqrt(corner)  # sin 45° / sin(κ/2)
    return sample.pushed(-1e-3 * parameters["amount_um"] * np.maximum(tip_fall, face_fall))


def test_depth_at_an_edge_is_the_moving_average_of_a_wedge():
    """Averaged numerically: a right-angled edge under a spot of 0.4 mm reads w sin 45° / 4 low along the normal."""
    width, half = 0.4, np.pi / 4
    t = (np.arange(1000) - 499.5) / 1000 * width
    fall = np.mean(np.abs(t)) * np.tan(half) * np.cos(half)
    assert fall == pytest.approx(width * np.sin(half) / 4, rel=1e-6)
    about = context()
    deep = EFFECT.basis(feet(), about, (2.6,))  # the sample begins 0.76 mm from the edges
    face = np.isclose(feet().position[:, 2], 0.12 * 6.35) & (feet().surface == 2)
    ratio = -deep[face, 0] / (1 - 2 * 0.762 / 2.6) ** 2
    np.testing.assert_allclose(ratio, np.sin(half) / np.sin(0.5 * np.radians(90.0 - 36.346184)), rtol=1e-6)

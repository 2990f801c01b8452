import math
from dataclasses import replace

import numpy as np

from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, locate
from gearwear.diagnose.effects.base import side_cut
from gearwear.diagnose.effects.profile_slope import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [
    Example({"left_um": 12.0, "right_um": -7.0}, (0.012, -0.007), (0.0,)),
    Example({"left_um": -9.0, "right_um": 15.0}, (-0.009, 0.015), (1.0,), ODD),
]


def displace(sample, parameters, shape):
    rise = np.where(sample.side > 0, parameters["left_um"], parameters["right_um"])
    flanks = sample.along_base(0.5e-3 * rise * sample.u)
    # The lower end of the flank takes the fillet along as a side that turns does.
    fillets = sample.cut(-sample.side * 0.5e-3 * rise / sample.outline.base_radius, fillets=shape[0])
    return np.where(sample.flank[:, None], flanks, fillets)


def test_a_pressure_angle_error_is_a_slope():
    """A base radius off by −r sin α dα: dα = 0.1° falls 14.8 µm over the usable 23.3 mm of roll (reference), less a constant."""
    o = sample(BORED).outline
    d_alpha = math.radians(0.1)
    points = feet().take(feet().surface == 0)
    error = -(points.roll - o.reference_roll) * math.tan(math.radians(20.0)) * d_alpha
    fall = -(o.tip_roll - o.form_roll) * math.tan(math.radians(20.0)) * d_alpha
    slope = EFFECT.basis(points, context(), (0.0,)) @ [fall, fall]
    np.testing.assert_allclose(np.ptp(error - slope), 0.0, atol=1e-15)
    assert abs(1e3 * fall + 14.8 * (o.tip_roll - o.form_roll) / 23.28) < 0.05


def test_a_rack_of_another_pressure_angle_takes_the_fillets_along():
    """Points of a gear cut by a rack of 20.1°, located on that of 20°: its slope with the fillets leaves less of them than without."""
    errors = {}
    other = sample(replace(BORED, pressure_angle_deg=20.1))
    on = locate(other.position, context().gear)
    fillet = (on.surface == FILLET) & (other.surface == FILLET)
    assert fillet.sum() > 500
    d_alpha = math.radians(0.1)
    gear = context().gear
    fall = -(gear.tip_roll - gear.form_roll) * math.tan(math.radians(20.0)) * d_alpha
    # About the middle of the flank; that it is about the pitch point in the part is a thicker tooth.
    middle = 0.5 * (gear.tip_roll + gear.form_roll)
    half = -(middle - gear.reference_roll) * math.tan(math.radians(20.0)) * d_alpha
    for shape in ((0.0,), (1.0,)):
        slope = EFFECT.basis(on, context(), shape) @ [fall, fall]
        turned = half * on.side * side_cut(on, gear, 1.0)
        errors[shape] = float(np.sqrt(np.mean((on.deviation - slope - turned)[fillet] ** 2)))
    assert errors[(1.0,)] < 0.5 * errors[(0.0,)]


def test_the_fillets_of_a_worn_side_go_with_the_flanks_of_the_other():
    """With its flanks left out they would tell a slope of flanks nobody looked at; with both sides worn they tell none."""
    points = feet()
    fillet, flank = (points.surface == FILLET) & (points.side != 0), points.surface == FLANK
    both, one, none = (
        EFFECT.basis(points, replace(context(), worn=frozenset(worn)), (1.0,)) for worn in ((), (Side.RIGHT,), tuple(Side))
    )
    right = points.side < 0
    np.testing.assert_array_equal(one[flank], both[flank])
    assert np.abs(both[fillet & right, 1]).max() > 0.0
    assert (one[fillet & right, 1] == 0.0).all() and (none[fillet] == 0.0).all()
    np.testing.assert_array_equal(one[fillet & right, 0], both[fillet & right, 1])
    np.testing.assert_array_equal(one[fillet & ~right, 0], both[fillet & ~right, 0])

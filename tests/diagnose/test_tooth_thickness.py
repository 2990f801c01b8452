from dataclasses import replace

import numpy as np

from gearwear.design.surface import locate
from gearwear.diagnose.effects.tooth_thickness import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [
    Example({"thickness_um": -60.0}, (-0.06,), (1.0,)),
    Example({"thickness_um": 40.0}, (0.04,), (0.0,), ODD),
]


def displace(sample, parameters, shape):
    """Every side turned so that the arc at the reference circle grows by half on each side."""
    half = 0.5e-3 * parameters["thickness_um"] / sample.outline.reference_radius
    return sample.cut(sample.side * half, fillets=shape[0])


def test_is_the_thinning_of_the_drawing_on_flanks_and_fillets():
    """Points of a gear drawn thinner by a side cut of the rack, located on the full gear."""
    errors = []
    for thinning in (0.06, 0.03):
        thin = sample(replace(BORED, thinning=thinning))
        full = locate(thin.position, context().gear)
        same = (full.surface == thin.surface) & thin.sides
        assert same.sum() > 2000
        errors.append(np.abs(full.deviation + thinning * EFFECT.basis(full, context(), (1.0,))[:, 0])[same].max())
    assert errors[0] < 0.02 * 0.06 and errors[1] < 0.3 * errors[0]


def test_ground_flanks_leave_the_fillets():
    points = feet()
    assert not EFFECT.basis(points, context(), (0.0,))[points.surface != 0].any()

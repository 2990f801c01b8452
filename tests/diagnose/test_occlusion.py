import numpy as np

from gearwear.diagnose.effects.occlusion import EFFECT
from tests.diagnose.sample import ODD, Example, context, feet

EXAMPLES = [
    Example({"height_um": 40.0, "decay_mm": 1.5}, (0.04,), (1.5, 1.0)),
    Example({"height_um": 30.0, "decay_mm": 3.0}, (0.03,), (3.0, 0.0), gear=ODD),
]


def displace(sample, parameters, shape):
    """Out along the normal: all of it below the form circle, fading above it, nothing on tips."""
    above = np.where(sample.flank, np.nan_to_num(sample.roll) - sample.outline.form_roll, np.inf)
    share = np.where(np.isin(sample.surface, (1, 2)), shape[1], np.exp(-above / parameters["decay_mm"]))
    return sample.pushed(1e-3 * parameters["height_um"] * share)


def test_is_mostly_below_six_millimetres_of_roll_and_never_missing_material():
    points = feet()
    for shape in EFFECT.shapes(context()):
        basis = EFFECT.basis(points, context(), shape)[:, 0]
        flank = points.surface == 0
        assert basis[flank & (points.roll > 6.0 + 3.0 * shape[0])].max(initial=0.0) < 0.06
        assert basis.min() >= 0.0
        assert basis[np.isin(points.surface, (1, 2))].tolist() == [shape[1]] * np.isin(points.surface, (1, 2)).sum()
    assert not EFFECT.allowed(np.array([-0.01]), (1.5, 1.0), context())

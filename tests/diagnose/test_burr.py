import numpy as np

from gearwear.diagnose.effects.burr import EFFECT
from tests.diagnose.sample import ODD, Example, context

EXAMPLES = [
    Example({"height_um": 60.0, "width_mm": 2.5}, (0.06,), (2.5, 1.0)),
    Example({"height_um": 40.0, "width_mm": 1.2}, (0.04,), (1.2, -1.0), ODD),
]


def displace(sample, parameters, shape):
    """Metal standing up along the tip edge, measured by the arc of the involute down from it."""
    o = sample.outline
    here = sample.flank & (sample.side == shape[-1])
    down = (o.tip_roll**2 - np.where(here, sample.roll, 0.0) ** 2) / (2 * o.base_radius)
    share = np.clip(1 - down / parameters["width_mm"], 0.0, 1.0) ** 2
    return sample.pushed(np.where(here, 1e-3 * parameters["height_um"] * share, 0.0))


def test_never_takes_material():
    assert not EFFECT.allowed(np.array([-0.01]), (1.0, 1.0), context())

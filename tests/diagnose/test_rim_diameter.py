"""On an external gear of the contract's the cylinder is its bore: it is wider by d as that of a ring is, and the sign that of the normal."""

import numpy as np
import pytest

from gearwear.design.surface import BORE
from gearwear.diagnose.effects.rim_diameter import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context
from tests.diagnose.test_on_rings_and_doubles import context as of_kind
from tests.diagnose.test_on_rings_and_doubles import sample as sample_of

EXAMPLES = [Example({"diameter_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, -80.0), (ODD, 50.0))]


def displace(sample, parameters, shape):
    return sample.grown(np.where(sample.surface == BORE, 0.5e-3 * parameters["diameter_um"], 0.0))


@pytest.mark.parametrize("kind", ["ring", "helical ring"])
def test_a_wider_ring_has_more_metal_outside(kind):
    _, feet, _ = sample_of(kind)
    basis = EFFECT.basis(feet, of_kind(kind), ())[:, 0]
    assert (basis[feet.surface == BORE] == 0.5).all() and not basis[feet.surface != BORE].any()
    assert EFFECT.applies(of_kind(kind))


def test_an_external_gear_has_a_bore_instead():
    assert not EFFECT.applies(context())

import numpy as np

from gearwear.design.surface import BORE, FLANK
from gearwear.diagnose.effects.bore_diameter import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet, sample

EXAMPLES = [Example({"diameter_um": value}, (1e-3 * value,), gear=gear) for gear, value in ((BORED, -80.0), (ODD, 50.0))]


def displace(sample, parameters, shape):
    return sample.grown(np.where(sample.surface == BORE, 0.5e-3 * parameters["diameter_um"], 0.0))


def test_the_moved_bore_has_the_diameter_it_says():
    one = sample(BORED)
    moved = displace(one, {"diameter_um": -80.0}, ())[one.surface == BORE]
    np.testing.assert_allclose(2.0 * np.hypot(*moved[:, :2].T), BORED.bore_diameter - 0.080, rtol=1e-12)
    basis = EFFECT.basis(feet(), context(), ())[:, 0]
    assert (basis[feet().surface == BORE] == -0.5).all() and not basis[feet().surface != BORE].any()


def test_needs_a_bore():
    whole = context()
    assert EFFECT.applies(whole)
    assert not EFFECT.applies(type(whole)(whole.gear, frozenset({FLANK}), whole.scan_axes))

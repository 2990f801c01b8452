from dataclasses import replace

import numpy as np

from gearwear.diagnose.effects.pitch import EFFECT
from tests.diagnose.sample import BORED, ODD, Example, context, feet


def example(gear, follow):
    index = 30.0 * np.cos(1.7 * np.arange(gear.teeth))
    index -= index.mean()
    return Example({"index_um": tuple(index.tolist())}, tuple((1e-3 * index[:-1]).tolist()), (follow,), gear)


EXAMPLES = [example(BORED, 1.0), example(ODD, 0.0)]


def displace(sample, parameters, shape):
    """Each tooth turned as a whole by its arc at the reference circle."""
    index = 1e-3 * np.array(parameters["index_um"])[sample.tooth]
    return sample.cut(index / sample.outline.reference_radius, fillets=shape[0])


def test_the_last_tooth_is_held_by_the_mean_and_bounded_too():
    about = context()
    found = EFFECT.estimates(np.full(11, 0.01), np.eye(11) * 1e-6, (0.0,), about)["index_um"]
    assert len(found.value) == 12
    assert abs(sum(found.value)) < 1e-9
    np.testing.assert_allclose(found.value[-1], -110.0, rtol=1e-12)
    np.testing.assert_allclose(found.std, [1.0] * 11 + [np.sqrt(11.0)], rtol=1e-12)
    assert not EFFECT.allowed(np.full(11, 0.06), (0.0,), about)


def test_a_tooth_nobody_saw_leaves_the_others_known():
    covariance = np.eye(11) * 1e-6
    covariance[3, 3] = np.nan
    std = np.array(EFFECT.estimates(np.full(11, 0.01), covariance, (0.0,), context())["index_um"].std)
    assert np.flatnonzero(np.isnan(std)).tolist() == [3, 11]


def test_one_tooths_amplitude_moves_that_tooth_and_the_last_only():
    points = feet()
    moved = EFFECT.basis(points, context(), (1.0,))[:, 4] != 0.0
    assert set(points.tooth[moved].tolist()) == {4, 11}


def test_missing_teeth_have_no_index_and_the_others_a_mean_of_their_own():
    """Also where the last one is missing; turned by what was put in, the flanks of the others move as they did."""
    about, points = replace(context(), absent=frozenset({3, 11})), feet()
    present = np.array([tooth for tooth in range(12) if tooth not in (3, 11)])
    index = 0.03 * np.cos(1.7 * present)
    index -= index.mean()
    columns = EFFECT.basis(points, about, (1.0,))
    whole = EFFECT.basis(points, context(), (1.0,))
    here = np.isin(points.tooth, present)
    assert not columns[~here].any()
    every = np.zeros(12)
    every[present] = index
    np.testing.assert_allclose((columns @ index[:-1])[here], (whole @ every[:-1])[here], atol=1e-15)
    found = EFFECT.estimates(index[:-1], np.eye(9) * 1e-6, (1.0,), about)["index_um"]
    assert np.flatnonzero(np.isnan(found.value)).tolist() == np.flatnonzero(np.isnan(found.std)).tolist() == [3, 11]
    np.testing.assert_allclose(np.array(found.value)[present], 1e3 * index, atol=1e-9)

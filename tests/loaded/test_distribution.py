"""The contact problem on small bodies whose answer is known, and the conditions that make any answer the only one."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.loaded.distribution import distribute


def nothing(force, _which):
    return np.zeros_like(force), np.zeros_like(force)


def test_two_springs_share_as_springs_do():
    """One 2 mm ahead with 1 mm/N, the other with 2 mm/N: the second takes over from 2 N on."""
    compliance = np.diag([1.0, 2.0])[None]
    lead = np.array([[2.0, 0.0]])
    light = distribute(lead, compliance, 1.0, nothing)
    assert light.force.tolist() == [[1.0, 0.0]] and light.advance[0] == pytest.approx(1.0)
    heavy = distribute(lead, compliance, 5.0, nothing)
    # 2 − F1 = −2 F2 and F1 + F2 = 5
    np.testing.assert_allclose(heavy.force, [[4.0, 1.0]], rtol=1e-12)
    assert (heavy.advance[0], heavy.compliance[0]) == (pytest.approx(-2.0), pytest.approx(2.0 / 3.0))


def test_without_force_it_is_rigid():
    lead = np.array([[1.0, 3.0, -np.inf], [0.5, -2.0, 0.1]])
    found = distribute(lead, np.repeat(np.eye(3)[None], 2, axis=0), 0.0, nothing)
    assert found.advance.tolist() == [3.0, 0.5] and not found.force.any()


@pytest.mark.parametrize("seed", range(8))
def test_the_conditions_of_contact_hold(seed):
    """Forces push, gaps do not overlap, none has both, the sum is right: with C positive definite that is the only answer."""
    random = np.random.default_rng(seed)
    count, places = 25, 40
    root = random.normal(size=(count, places, places))
    compliance = root @ root.swapaxes(1, 2) / places + 0.05 * np.eye(places)
    lead = random.normal(size=(count, places))
    lead[random.random((count, places)) < 0.1] = -np.inf

    def local(force, _which):  # a spring that stiffens: q = 1 / (1 + F)
        return 1.0 / (1.0 + force), 1.0 / (1.0 + force) ** 2

    found = distribute(lead, compliance, 3.0, local)
    assert (found.force >= 0.0).all()
    np.testing.assert_allclose(found.force.sum(axis=1), 3.0, rtol=1e-9)
    gap = found.advance[:, None] + np.einsum("pij,pj->pi", compliance, found.force) + found.force / (1.0 + found.force) - lead
    assert gap.min() > -1e-8
    assert np.abs(gap[found.force > 0.0]).max() < 1e-8
    less = distribute(lead, compliance, 3.0 - 1e-5, local)
    np.testing.assert_allclose((less.advance - found.advance) / 1e-5, found.compliance, rtol=1e-3)

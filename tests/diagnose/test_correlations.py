"""Correlations of the sizes of effects: what goes in as covariance of the amplitudes comes out, whatever the parameters look like."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.diagnose.correlations import correlations, sizes
from gearwear.diagnose.dictionary import Candidate
from gearwear.diagnose.effects import catalogue
from gearwear.diagnose.effects.base import Context

CONTEXT = Context(Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0)), frozenset(range(7)), np.eye(3))
EFFECTS = {effect.name: effect for effect in catalogue()}


def sized(name, index, amplitudes, at, shape=()):
    count = len(amplitudes)
    candidate = Candidate(EFFECTS[name], shape, np.arange(count))
    return sizes(candidate, index, np.array(amplitudes), 1e-8 * np.eye(count + len(shape)), np.array(at), CONTEXT)


@pytest.mark.parametrize("value", [-0.97, -0.3, 0.3, 0.97])
def test_of_two_plain_effects_it_is_that_of_their_amplitudes(value):
    known = [*sized("coating", 0, [0.02], [0]), *sized("scale", 1, [3e-4], [1])]
    covariance = np.array([[4e-8, value * 2e-4 * 3e-6], [value * 2e-4 * 3e-6, 9e-12]])
    (found,) = correlations(known, covariance)
    assert (found.effects, found.parameters) == (("coating", "scale"), ("thickness_um", "relative_ppm"))
    assert found.value == pytest.approx(value, rel=1e-6)


def test_of_an_amplitude_with_a_direction_it_is_that_along_the_direction():
    """|a| of a = (3, 4) goes by (0.6, 0.8) · da: a partner correlated with da_x alone by r has 0.6 r of it, as both errors are alike."""
    (size,) = sized("eccentricity", 0, [0.03, 0.04], [0, 1])
    assert size.parameter == "amplitude_um"
    assert size.slope / np.linalg.norm(size.slope) == pytest.approx([0.6, 0.8], abs=1e-6)
    covariance = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]])
    (found,) = correlations([size, *sized("coating", 1, [0.02], [2])], covariance)
    assert found.value == pytest.approx(0.3, abs=1e-6)


def test_the_sign_is_that_of_the_parameters_and_not_of_the_amplitudes():
    """Two sizes below zero that grow together are correlated as two above."""
    covariance = np.array([[1.0, 0.6], [0.6, 1.0]])
    for sign in (1.0, -1.0):
        known = [*sized("scale", 0, [sign * 3e-4], [0]), *sized("height_scale", 1, [sign * 2e-4], [1])]
        assert correlations(known, covariance)[0].value == pytest.approx(0.6, rel=1e-6)


def test_a_place_is_no_size():
    names = {one.parameter for one in sized("turntable_angle", 0, [0.01, 0.02], [0, 1], (2.0,))}
    assert names == {"amplitude_deg"}


def test_little_ones_and_those_of_one_effect_are_left_out_and_the_strongest_comes_first():
    known = [
        *sized("profile_slope", 0, [0.004, -0.002], [0, 1]),
        *sized("coating", 1, [0.02], [2]),
        *sized("scale", 2, [3e-4], [3]),
    ]
    covariance = np.eye(4)
    for (i, j), value in {(0, 1): 0.9, (0, 2): 0.2, (1, 2): 0.09, (2, 3): -0.5}.items():
        covariance[i, j] = covariance[j, i] = value
    found = correlations(known, covariance)
    assert [(one.effects, round(one.value, 6)) for one in found] == [
        (("coating", "scale"), -0.5),
        (("profile_slope", "coating"), 0.2),
    ]


def test_what_is_not_known_has_none():
    known = [*sized("coating", 0, [0.02], [0]), *sized("scale", 1, [3e-4], [1])]
    assert correlations(known, np.array([[math.nan, math.nan], [math.nan, 1.0]])) == ()

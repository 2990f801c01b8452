"""Thresholds and terms of the uncertainty of an inspection, by what they are defined as."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.inspection.correlation import _carried_on
from gearwear.inspection.dimensions import over_pins
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.grading import Verdict, grade
from gearwear.inspection.pitch import runout
from gearwear.inspection.tolerances import Edition, Size, tolerances
from gearwear.inspection.traces import FlankSamples, profile_traces

SIZE = Size(76.2, 6.35, 15.0, 12)


def test_expanded_uncertainty_is_twice_the_standard_one_and_the_bias():
    """GUM F.2.4.5."""
    assert Estimate(np.array(1.0), np.array(0.25), np.array(-0.5)).expanded == 1.0


@pytest.mark.parametrize(
    ("value", "expanded", "verdict"),
    [
        (0.5, 0.29, Verdict.WITHIN), (0.5, 0.31, Verdict.NOT_RESOLVABLE),
        # over the tolerance by more than U is proven all the same; by less it is not
        (1.4, 0.31, Verdict.EXCEEDS), (1.2, 0.31, Verdict.NOT_RESOLVABLE), (1.2, 0.19, Verdict.EXCEEDS),
        (1.2, 0.29, Verdict.NEITHER),
    ],
)  # fmt: skip
def test_a_tolerance_is_resolved_by_a_third_less_a_tenth_of_it(value, expanded, verdict):
    tolerance = float(tolerances(SIZE, 7, Edition.ISO_2013).profile_slope)
    assert grade("profile_slope", value * tolerance, expanded * tolerance, SIZE, required=7).verdict is verdict


def test_the_error_of_a_ball_is_what_a_flank_off_by_that_much_moves_it(pinion: Gear):
    small = 1e-6
    off = np.zeros((12, 2))
    off[:, 0] = small
    found = runout(Estimate.plain(off, off), pinion, over_pins(pinion))
    np.testing.assert_allclose(found.radial.standard, found.radial.value, rtol=1e-4)


def test_points_that_are_alike_by_fours_count_as_a_quarter(pinion: Gear):
    random, n = np.random.default_rng(0), 20_000
    roll, z = random.uniform(pinion.form_roll, pinion.tip_roll, n), random.uniform(0.0, 15.0, n)
    samples = FlankSamples(pinion, random.integers(0, 24, n), roll, z, random.normal(0.0, 0.01, n), 0.01, 0)
    plain, alike = (profile_traces(samples, (0.0, 15.0), 1.0, 0.01, factor).standard_error for factor in (1.0, 4.0))
    np.testing.assert_allclose(alike, 2.0 * plain, rtol=1e-12)


def test_the_factor_of_wide_cells_is_carried_on_as_one_over_width():
    """5 − 2 / width, of widths 1 and 2."""
    assert _carried_on((3.0, 0.1), (4.0, 0.1))[0] == pytest.approx(5.0)
    assert math.isnan(_carried_on((math.nan, 0.1), (4.0, 0.1))[0])

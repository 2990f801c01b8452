"""Whether neighbouring points share their errors, of errors that are known to be their own or shared."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from gearwear.design.surface import flank_points
from gearwear.placing.smoothing import MOST_PATCHES, PATCH_POINTS, _patches, shared_errors
from tests.placing.placing import designed

GEAR = designed()
SURE = 0.06
"""What the ratio may be off by: the mean is 1, a patch of 20 scatters by 0.3 and its median lies a few hundredths lower, of a thousand by 0.01."""


def flanks(points=30_000, seed=1):
    """Points on all flanks, and normal errors of 1, each point's own."""
    random = np.random.default_rng(seed)
    tooth, side = random.integers(0, GEAR.teeth, points), random.choice([1, -1], points)
    roll, z = random.uniform(GEAR.form_roll, GEAR.tip_roll, points), random.uniform(0.0, GEAR.face_width, points)
    return flank_points(GEAR, tooth, side, roll, z), random.standard_normal(points)


def form(points):
    """What a worn gear has of form: slid by 50 µm towards the root, 40 µm gone between two heights, and twisted."""
    share = (points.roll - GEAR.form_roll) / (GEAR.tip_roll - GEAR.form_roll)
    z = points.position[:, 2] / GEAR.face_width
    return -0.05 * (1.0 - share) ** 2 - 0.04 * ((z > 0.2) & (z < 0.8)) + 0.02 * share * z


def smoothed(points, errors, number):
    """Means over so many points of the same flank."""
    result = np.empty(len(errors))
    for label in np.unique(flank := 2 * points.tooth.astype(int) + (points.side > 0)):
        its = np.flatnonzero(flank == label)
        result[its] = errors[its][cKDTree(points.position[its]).query(points.position[its], number)[1]].mean(axis=1)
    return result


@pytest.mark.parametrize("size", [0.001, pytest.param(0.006, marks=pytest.mark.long), 0.03])
def test_errors_of_their_own_are_that_whatever_form_the_flanks_have(size):
    points, errors = flanks()
    assert shared_errors(points.with_deviation(size * errors)) == pytest.approx(1.0, abs=SURE)
    # The edges of what is gone go through a third of the patches.
    assert shared_errors(points.with_deviation(size * errors + form(points))) > 0.8


def test_errors_may_grow_with_the_slope():
    points, errors = flanks()
    steep = 0.005 + 0.02 * (points.roll / GEAR.tip_roll) ** 2
    assert shared_errors(points.with_deviation(steep * errors)) == pytest.approx(1.0, abs=SURE)


@pytest.mark.parametrize("number", [6, pytest.param(16, marks=pytest.mark.long)])
def test_means_over_neighbours_share_their_errors(number):
    """Nearest neighbours have all but a few points of the mean in common."""
    points, errors = flanks()
    rough = smoothed(points, 0.006 * errors, number)
    ratio = shared_errors(points.with_deviation(rough))
    assert ratio < 0.6
    # Neither the size of the errors nor a plane under them is anything of it.
    other = points.with_deviation(10.0 * rough + 0.01 * points.roll + 0.02 * points.position[:, 2])
    assert shared_errors(other) == pytest.approx(ratio, rel=1e-6)


@pytest.mark.parametrize("points", [300, 1_000, 20_000])
def test_patches_are_few_and_from_all_over(points):
    """Of an even square: every point once at most, and about as many on either side of the middle."""
    at = np.random.default_rng(4).uniform(-1.0, 1.0, (points, 2))
    patches = _patches(at)
    chosen = np.concatenate(patches)
    assert len(np.unique(chosen)) == len(chosen)
    assert all(PATCH_POINTS <= len(patch) < 2 * PATCH_POINTS for patch in patches)
    assert len(patches) <= MOST_PATCHES
    assert len(patches) > 0.4 * min(points / (2 * PATCH_POINTS), MOST_PATCHES)
    assert np.abs(at[chosen].mean(axis=0)).max() < 0.15
    assert (np.ptp(at[chosen], axis=0) > 1.7).all()


def test_of_few_points_nothing_is_told():
    points, errors = flanks(300)
    assert shared_errors(points.with_deviation(smoothed(points, errors, 6))) == 1.0

"""Effects that take each other back: on fields of which it is known by hand how much of each is in their sum."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.taken_back import beside_pose, taken_back

SURFACE = np.repeat([FLANK, FILLET, ROOT, TIP], [60, 20, 10, 10])
SIDES = SURFACE <= FILLET
PROFILE = np.where(SIDES, np.linspace(-1.0, 1.0, 100), 0.0)
WEIGHT = np.linspace(1.0, 3.0, 100)


@pytest.mark.parametrize(("other", "back"), [(0.3, False), (-0.45, False), (-0.55, True), (-0.9, True)])
def test_of_one_form_twice_both_stand_as_long_as_half_of_the_larger_is_left(other, back):
    """In u + c u there is 1 + c of u; and of c u, where c is below zero, nothing: but what is left is the larger, which is no cancelling."""
    told = taken_back(np.column_stack([PROFILE, other * PROFILE]), WEIGHT, SURFACE)
    assert told.tolist() == [back, back]


def test_what_cancels_is_told_beside_what_does_not():
    """Two that cancel, one that stands by itself, and one that the latter outweighs."""
    hollow = PROFILE**2 - np.where(SIDES, (WEIGHT @ PROFILE**4) / (WEIGHT @ PROFILE**2), 0.0)
    odd = PROFILE**3
    fields = np.column_stack([odd, hollow, -0.9 * odd, -0.3 * hollow])
    assert taken_back(fields, WEIGHT, SURFACE).tolist() == [True, False, True, False]


def test_what_tips_and_roots_show_nothing_on_the_flanks_takes_back():
    """A coat of 18 µm over teeth that are 30 µm thinner: flanks lie lower, and roots and tips show it; not where it hardly reaches them."""
    coat, thin = np.full(100, 0.018), np.where(SIDES, -0.03, 0.0)
    assert taken_back(np.column_stack([coat, thin]), WEIGHT, SURFACE).tolist() == [False, False]
    coat[~SIDES] *= 0.1
    assert taken_back(np.column_stack([coat, thin]), WEIGHT, SURFACE).tolist() == [True, True]


def test_fillets_are_cut_with_the_flanks_and_speak_with_them():
    fields = np.column_stack([PROFILE, np.where(SURFACE == FLANK, -PROFILE, 0.0)])
    assert WEIGHT[SURFACE == FILLET] @ PROFILE[SURFACE == FILLET] ** 2 < 0.5 * WEIGHT @ PROFILE**2
    assert taken_back(fields, WEIGHT, SURFACE).tolist() == [True, True]


def test_what_a_motion_takes_up_is_no_part_of_an_effect():
    """Fields that differ by a motion are the same beside the pose, and what is left is square to every motion."""
    random = np.random.default_rng(1)
    pose, fields = random.normal(size=(100, 6)), random.normal(size=(100, 3))
    left = beside_pose(fields, pose, WEIGHT)
    np.testing.assert_allclose(pose.T @ (WEIGHT[:, None] * left), 0.0, atol=1e-10)
    np.testing.assert_allclose(beside_pose(fields + pose @ random.normal(size=(6, 3)), pose, WEIGHT), left, atol=1e-12)

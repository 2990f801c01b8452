"""Halves of a double helical gear: each is inspected as the gear of one helix that it is."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import flank_points
from gearwear.errors import InputError
from gearwear.inspection.halves import Half, half_covariance, half_gear, half_points, inspect_half
from gearwear.inspection.inspection import inspect
from gearwear.inspection.settings import Settings
from gearwear.placing.pose import motion_columns

GEAR = Gear.from_spec(GearSpec("gear", 17, 3.0, 27.0, profile_shift=0.1, helix_angle=math.radians(24.0), gap=5.0))
SLOPE = 0.02
"""mm over a half, along the transverse base tangent: the upper half is screwed so much further to the right."""


def flanks():
    tooth, side, roll, z = (
        a.ravel()
        for a in np.meshgrid(
            np.arange(17), [1, -1], np.linspace(GEAR.form_roll, GEAR.tip_roll, 40),
            np.concatenate([np.linspace(0.05, 10.95, 60), np.linspace(16.05, 26.95, 60)]),
        )
    )  # fmt: skip
    points = flank_points(GEAR, tooth.astype(int), side.astype(int), roll, z)
    upper = GEAR.base_helix_cosine * side * SLOPE * (z - 21.5) / 11.0
    return points.with_deviation(np.where(z > 13.5, upper, 0.0))


@pytest.mark.parametrize(("half", "slope"), [(Half.LOWER, 0.0), (Half.UPPER, -SLOPE)])
def test_helix_slopes_are_those_of_the_half(half, slope):
    """The upper half is left hand: screwed to the right its angle is too small, so f_Hβ is negative (ISO 1328-1)."""
    found = inspect(half_points(flanks(), GEAR, half), half_gear(GEAR, half), Settings(noise=0.001))
    over = found.helix.range.stated / 11.0
    # A point stands higher than its foot by δ sin β_b: second order, 2 · 10 µm · 0.38 · 20 µm / 11 mm at most.
    assert found.helix.slope.value == pytest.approx(np.full((17, 2), slope * over), abs=1.5e-5)
    assert found.gear.spec.hand == ("right" if half is Half.LOWER else "left")
    assert found.dimensions.thickness.value == pytest.approx(GEAR.tooth_thickness, abs=2e-3)


@pytest.mark.long
@pytest.mark.parametrize("half", [pytest.param(Half.LOWER, marks=pytest.mark.long), Half.UPPER])
def test_an_unsure_pose_is_as_unsure_in_the_frame_of_a_half(half):
    rng = np.random.default_rng(1)
    root = rng.normal(size=(6, 6))
    whole = half_points(flanks(), GEAR, half)
    lifted = replace(whole, position=whole.position + np.array([0.0, 0.0, 0.0 if half is Half.LOWER else 16.0]))
    before, after = motion_columns(lifted.position, lifted.normal), motion_columns(whole.position, whole.normal)
    moved = half_covariance(root @ root.T, GEAR, half)
    assert np.einsum("ni,ij,nj->n", after, moved, after) == pytest.approx(
        np.einsum("ni,ij,nj->n", before, root @ root.T, before), rel=1e-9
    )


def test_the_whole_is_refused_and_so_are_halves_of_one_helix():
    with pytest.raises(InputError, match="one half at a time"):
        inspect(flanks(), GEAR)
    with pytest.raises(InputError, match="no halves"):
        half_gear(half_gear(GEAR, Half.LOWER), Half.UPPER)


def test_settings_of_an_inspection_inspect_again():
    """They hold the scale as a seventh cause beside the pose."""
    pose = np.diag([1e-6, 1e-6, 1e-6, 1e-10, 1e-10, 1e-10])
    first = inspect_half(flanks(), GEAR, Half.LOWER, Settings(noise=0.001, pose_covariance=pose, scale_std=1e-4))
    again = inspect_half(flanks(), GEAR, Half.LOWER, first.settings)
    assert again.profile.slope.expanded == pytest.approx(first.profile.slope.expanded, rel=1e-12)

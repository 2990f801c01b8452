"""Which teeth are bent, from flanks whose heights are known because they were put in."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.surface import FLANK
from gearwear.diagnose.bent_teeth import bent_teeth
from gearwear.placing.cells import CellGrid, bin_points
from tests.diagnose.core.test_active_face import GEAR, SOUND, TEETH, scanned


def cells_with(*heights, points=SOUND):
    """The cells of an unworn gear with `heights` of tooth, side, v from 0 at the form circle to 1 at the tip, and ζ, mm, added to its flanks."""
    up = np.clip(np.nan_to_num((points.roll - GEAR.form_roll) / (GEAR.tip_roll - GEAR.form_roll)), 0.0, 1.0)
    zeta = points.position[:, 2] / GEAR.face_width - 0.5
    added = sum(one(points.tooth, points.side, up, zeta) for one in heights)
    moved = points.with_deviation(points.deviation + np.where(points.surface == FLANK, added, 0.0))
    return bin_points(moved, CellGrid.for_scan(GEAR, len(points)), clip=0.4)


def bend(tooth, tip, power=1.0, form=0.0):
    return lambda t, side, up, zeta: np.where(t == tooth, side * (form + (tip - form) * up**power), 0.0)


def worn(tooth, side, depth):
    """A loss of which `depth` tells the depth at v and ζ."""
    return lambda t, s, up, zeta: np.where((t == tooth) & (s == side), -depth(up, zeta), 0.0)


def as_cut(seed, slope, thickness=0.01, index=0.015):
    """Every flank with a slope of its own, every tooth with a thickness and an index, normal, mm."""
    random = np.random.default_rng(seed)
    slopes, off = random.normal(0.0, slope, (TEETH, 2)), random.normal(0.0, 0.5 * thickness, TEETH)
    place = random.normal(0.0, index, TEETH)
    return lambda t, side, up, zeta: slopes[t, (side < 0).astype(int)] * (up - 0.5) + off[t] + side * place[t]


def teeth(*heights):
    return [one.tooth for one in bent_teeth(cells_with(*heights))]


@pytest.mark.parametrize(("tip", "power", "form"), [(0.03, 1.0, 0.0), (-0.03, 1.5, 0.0), (0.2, 2.0, 0.1), (-0.2, 2.0, -0.1)])
def test_a_bent_tooth_is_found_with_what_it_moved(tip, power, form):
    (found,) = bent_teeth(cells_with(bend(4, tip, power, form)))
    assert found.tooth == 4
    middle = form + (tip - form) * 0.5**power
    np.testing.assert_allclose(found.moved, (tip, middle, form), atol=0.004)


@pytest.mark.parametrize(("tip", "lean"), [(0.05, 0.05), (-0.05, 0.08)])
def test_what_it_moved_more_at_one_end_is_found_beside_a_pit(tip, lean):
    """Of a flank that stands proud: a pit in it, 0.2 mm deep, moves no median."""

    def leaning(t, side, up, zeta):
        pit = np.where((side == np.sign(tip)) & (abs(zeta) < 0.05) & (up > 0.6), -0.2, 0.0)
        return np.where(t == 4, side * up * (tip + lean * zeta) + pit, 0.0)

    (found,) = bent_teeth(cells_with(leaning))
    assert found.tooth == 4
    np.testing.assert_allclose(found.moved, (tip, 0.5 * tip, 0.0), atol=0.006)
    np.testing.assert_allclose(found.lean, (lean, 0.5 * lean, 0.0), atol=0.008)


def test_two_of_them_are_found_and_none_on_a_gear_as_drawn():
    assert teeth(bend(4, 0.04), bend(9, -0.04)) == [4, 9]
    assert teeth() == []


@pytest.mark.parametrize(
    "depth",
    [
        pytest.param(lambda up, zeta: 0.06 * up, id="to the tip"),
        pytest.param(lambda up, zeta: 0.03 + 0.0 * up, id="even"),
        pytest.param(lambda up, zeta: 0.2 * np.clip(1.0 - ((up - 0.6) / 0.3) ** 2 - (zeta / 0.3) ** 2, 0.0, None), id="a patch"),
    ],
)
def test_wear_of_the_flank_that_lies_low_hides_no_bend_and_is_none_by_itself(depth):
    assert teeth(worn(4, -1, depth)) == []
    assert teeth(bend(4, 0.04), worn(4, -1, depth)) == [4]


@pytest.mark.parametrize("width", [0.05, 0.15, 0.25])
def test_metal_that_flowed_to_the_tip_of_the_other_flank_is_no_bend(width):
    """Ridges of any height: the flank below them stands where it did."""
    ridge = worn(4, 1, lambda up, zeta: -0.05 * np.clip((up - 1.0 + width) / width, 0.0, 1.0))
    assert teeth(worn(4, -1, lambda up, zeta: 0.05 * up), ridge) == []


def test_a_foot_that_is_worn_beside_a_tip_that_is_on_the_other_flank_is_no_bend():
    """Both lean as on a bent tooth, and neither stands proud."""
    assert teeth(worn(4, 1, lambda up, zeta: 0.05 * (1.0 - up)), worn(4, -1, lambda up, zeta: 0.05 * up)) == []


def test_a_flank_that_was_cut_steeper_is_none_and_both_of_a_tooth_in_opposite_senses_are_none():
    steep = worn(4, 1, lambda up, zeta: -0.04 * up)
    assert teeth(steep) == []
    assert teeth(steep, worn(4, -1, lambda up, zeta: -0.04 * up)) == []  # a thicker tip
    assert teeth(steep, worn(4, -1, lambda up, zeta: 0.01 * up)) == []  # the other follows by a quarter


def test_flanks_that_each_lean_otherwise_as_cut_are_none():
    """Slopes of 12 µm and pitch of 15 µm of standard deviation, about class 9; a false one on a gear in a hundred is the level."""
    assert [seed for seed in range(40) if teeth(as_cut(seed, 0.012))] == []


def test_what_is_bent_far_beyond_the_scatter_is_found():
    assert [teeth(as_cut(seed, 0.004, index=0.004), bend(4, 0.08)) for seed in range(5)] == [[4]] * 5


def test_less_than_points_scatter_is_none():
    """However clearly so many points tell it."""
    points = scanned(points=200_000)
    assert bent_teeth(cells_with(bend(4, 0.005), points=points)) == ()
    assert [one.tooth for one in bent_teeth(cells_with(bend(4, 0.008), points=points))] == [4]

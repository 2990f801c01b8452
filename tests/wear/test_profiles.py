"""The worn model: no metal added, none lost; and which teeth follow one law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gearwear.design.side import Side, sides_of
from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.wear.profiles import ProfileNodes, crest_left, node_radii, without_added_metal, worn_profiles
from gearwear.wear.regions import find_wear
from gearwear.wear.solid import gear_triangles, nominal_like
from gearwear.wear_law.teeth import alike_teeth, worn_teeth
from tests.synthetic import AbrasiveWear, Recipe, make_scan
from tests.synthetic.outline import PINION as PAPER
from tests.synthetic.outline import Outline
from tests.synthetic.removal import removed_volume

PINION = replace(PAPER, rack_tip_radius=0.25)
"""The fixture's gear, for code that shares nothing with the package."""


@given(
    arrays(np.float64, (2, 2, 3, 4), elements=st.floats(-1.0, 1.0)),
    arrays(np.float64, (4,), elements=st.floats(0.1, 2.0)),
)
def test_the_nearest_depth_that_adds_nothing_and_keeps_the_volume(depth, area):
    found = without_added_metal(depth, area)
    assert (found >= 0.0).all()
    volume = (depth * area).sum(axis=(2, 3))
    np.testing.assert_allclose((found * area).sum(axis=(2, 3)), np.maximum(volume, 0.0), atol=1e-12)
    # Optimality (Karush, Kuhn, Tucker): one shift for all that is left, and more than it was above zero for none of the rest.
    for side in np.ndindex(2, 2):
        if volume[side] > 0.0:
            kept = found[side] > 0.0
            shift = (depth[side] - found[side])[kept]
            assert np.ptp(shift) < 1e-12
            assert (depth[side][~kept] <= shift.max() + 1e-12).all()


def test_what_is_no_noise_is_left_alone():
    depth = np.abs(np.random.default_rng(0).normal(size=(3, 2, 5, 6)))
    np.testing.assert_allclose(without_added_metal(depth, np.ones(6)), depth, atol=1e-14)


def grid_of(gear):
    return CellGrid.for_scan(gear, 200_000)


@pytest.mark.parametrize("columns", [slice(0, None), slice(4, 9)])
def test_the_solid_has_the_volume_of_the_depth(pinion, columns):
    """An even depth on a flank, whole or in part: the triangles' divergence theorem against the integral over r²."""
    grid = grid_of(pinion)
    depth = np.zeros((12, 2, grid.rows, grid.fillet + grid.flank))
    depth[3, 1, :, grid.fillet :][:, columns] = 0.05
    profiles = worn_profiles(ProfileNodes.of(grid), depth)
    lost = gear_triangles(nominal_like(profiles)).volume - gear_triangles(profiles).volume
    cell = (pinion.tip_roll**2 - pinion.form_roll**2) / (2.0 * pinion.base_radius * grid.flank)
    expected = 0.05 * pinion.face_width * cell * (depth[3, 1, 0] > 0.0).sum()
    if columns.start == 0:  # the worn involute goes on below the form circle until it comes out of the fillet
        expected = removed_volume((AbrasiveWear(50.0, -1, (3,)),), Outline.of(PINION), 3, -1)
    # A step from column to column is a slope from middle to middle, and those are halves of L, not of L².
    assert lost == pytest.approx(expected, rel=2e-3 if columns.start == 0 else 5e-3)
    assert (np.diff(node_radii(grid)) > 0.0).all()


@pytest.mark.parametrize("depth", [pytest.param(0.02, marks=pytest.mark.long), pytest.param(0.075, marks=pytest.mark.long), 0.3])
def test_wear_goes_on_below_the_form_circle_of_an_undercut_gear(pinion, depth):
    """As the simulated part, which is made without any of this code, has it: by points on its outline."""
    grid = grid_of(pinion)
    field = np.zeros((12, 2, grid.rows, grid.fillet + grid.flank))
    field[0, 0, :, grid.fillet :] = depth
    profiles = worn_profiles(ProfileNodes.of(grid), field)
    recipe = Recipe(PINION, noise_um=0.0, wear=(AbrasiveWear(1e3 * depth, 1, (0,)),), pose="none", ends="none")
    points = make_scan(recipe, 1).points
    radius, angle = np.hypot(*points[:, :2].T), np.arctan2(points[:, 1], points[:, 0])
    strip = (radius > pinion.base_radius) & (radius < pinion.form_radius) & (angle > 0.0) & (angle < 0.5 * pinion.pitch_angle)
    assert strip.sum() > 50
    found = np.interp(radius[strip], profiles.radius, profiles.half_angle[0, 0, 3])
    off = radius[strip] * (found - angle[strip])
    # But where two straight steps of the outline span the edge, an eighth of the strip apart.
    assert np.abs(off).max() < 0.008 and np.median(np.abs(off)) < 0.0005
    nominal = pinion.half_angle(profiles.radius) - profiles.half_angle[0, 0, 3]
    assert (nominal[profiles.radius < pinion.base_radius] == 0.0).all()


def test_where_wear_ends_before_the_face_does_the_gear_is_as_it_was_made(wheel):
    """Teeth 30 µm low on both flanks, and a patch on one that runs out towards z = 0: nothing there stands above the 30 µm, which all the others have."""
    grid = CellGrid.for_scan(wheel, 20_000)
    worn = np.zeros((24, 2, grid.rows, grid.fillet + grid.flank))
    worn[1, 0, :3, grid.fillet + 3 : -3] = np.array([0.005, 0.2, 0.1])[:, None]
    made = np.full_like(worn, -0.03)
    nodes = ProfileNodes.of(grid)
    profiles, unworn = worn_profiles(nodes, worn, made), worn_profiles(nodes, np.zeros_like(worn), made)
    assert (profiles.half_angle <= unworn.half_angle + 1e-15).all()
    on = profiles.radius > wheel.form_radius
    low = (nodes.half_angle[0] - unworn.half_angle[1, 0])[:, on] * wheel.normal_lever
    np.testing.assert_allclose(low, 0.03, rtol=1e-9)


def test_a_gear_without_undercut_keeps_its_fillet(wheel):
    grid = CellGrid.for_scan(wheel, 200_000)
    field = np.zeros((24, 2, grid.rows, grid.fillet + grid.flank))
    field[..., grid.fillet :] = 0.1
    profiles = worn_profiles(ProfileNodes.of(grid), field)
    below = profiles.radius < wheel.form_radius
    assert below.any() and (profiles.loss[..., below] == 0.0).all()


def test_what_the_flank_takes_of_a_fillet_cell_is_not_counted_twice(pinion):
    """The fillet's cell means hold the strip that the worn flank cuts off it; the volume of the solid is that of the cut alone."""
    grid = grid_of(pinion)
    field = np.zeros((12, 2, grid.rows, grid.fillet + grid.flank))
    field[3, 0, :, grid.fillet :] = 0.075
    solid = gear_triangles(worn_profiles(ProfileNodes.of(grid), field)).volume
    removed = removed_volume((AbrasiveWear(75.0, 1, (3,)),), Outline.of(PINION), 3, 1)
    cell = (pinion.tip_roll**2 - pinion.form_roll**2) / (2.0 * pinion.base_radius)
    arc = 0.5 * grid.fillet_radius[-2:].sum() * np.diff(-pinion.half_angle(grid.fillet_radius[-2:]))[0]
    length = float(np.hypot(np.diff(grid.fillet_radius[-2:])[0], arc))
    field[3, 0, :, grid.fillet - 1] = (removed / pinion.face_width - 0.075 * cell) / length
    assert gear_triangles(worn_profiles(ProfileNodes.of(grid), field)).volume == pytest.approx(
        solid, abs=0.05 * (removed - 0.075 * cell * 15.0)
    )


def worn(pinion, depths):
    """A scan of left flanks that lost so much each, with some noise; nan: not seen."""
    grid = grid_of(pinion)
    tooth, side, roll, z = (
        a.ravel()
        for a in np.meshgrid(
            np.arange(12), [1, -1], np.linspace(pinion.form_roll, pinion.tip_roll, 80), np.linspace(0.0, 15.0, 60)
        )
    )
    points = flank_points(pinion, tooth.astype(int), side.astype(int), roll, z)
    lost = np.asarray(depths)[points.tooth] * (points.side > 0)
    noise = np.random.default_rng(1).normal(0.0, 0.003, len(points))
    points = points.take(np.isfinite(lost)).with_deviation((noise - lost)[np.isfinite(lost)])
    cells = bin_points(points, grid)
    return find_wear(cells, 0.003, sides_of(Side.LEFT))


def test_a_tooth_unlike_the_others_follows_no_law(pinion):
    depths = np.array([40.0, 44, 38, 41, 260, 43, 39, 42, 40, np.nan, 45, 37]) * 1e-3
    wear = worn(pinion, depths)
    assert set(worn_teeth(wear, 0)) == set(range(12)) - {9}
    assert set(alike_teeth(wear, 0)) == set(range(12)) - {4, 9}
    assert len(worn_teeth(wear, 1)) == 0


def test_two_worn_teeth_are_no_rule(pinion):
    wear = worn(pinion, np.where(np.isin(np.arange(12), (2, 3)), 0.05, 0.0))
    wear = replace(wear, mask=wear.mask & (wear.depth > 0.02))
    assert set(alike_teeth(wear, 0)) == set(worn_teeth(wear, 0))


def column_means(grid, depth):
    """Of `depth` over the roll, points lying evenly in L²; on all left flanks and rows."""
    edges = grid.roll_edges**2
    fine = np.sqrt(edges[:-1, None] + np.diff(edges)[:, None] * (np.arange(400) + 0.5) / 400)
    result = np.zeros((grid.gear.teeth, 2, grid.rows, grid.fillet + grid.flank))
    result[:, 0, :, grid.fillet :] = depth(fine).mean(axis=1)
    return result


@pytest.mark.parametrize("place", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_a_flank_worn_to_a_corner_is_worn_to_it_within_its_column(pinion, place):
    """Sliding wear has none at the pitch point, wherever in a column that lies; the mean of the column says a quarter of what is lost a column on."""
    grid = grid_of(pinion)
    low, high = grid.roll_edges[5:7]
    corner = low + place * (high - low)
    parts = 4
    nodes = ProfileNodes.of(grid, parts)
    depth = column_means(grid, lambda roll: 0.01 * np.abs(roll - corner))
    roll = grid.rolls(parts)[5 * parts : 6 * parts + 1]
    off = []
    for crest in (None, crest_left(grid, depth, parts)):
        worn = worn_profiles(nodes, depth, crest=crest).half_angle[0, 0, 3, -(parts * grid.flank + 1) :]
        lost = (nodes.half_angle[0, 3, -len(worn) :] - worn) * pinion.base_radius
        off.append(float(np.abs(lost[5 * parts : 6 * parts + 1] - 0.01 * np.abs(roll - corner)).max()))
    assert off[0] > 0.1 * 0.01 * (high - low)
    assert off[1] < 0.5 * off[0]
    assert not crest_left(grid, depth, parts)[1].any()


def test_a_flank_worn_round_has_no_corner(pinion):
    """A parabola: beyond what its columns show there is next to nothing, a tenth of what the lines beside it would add."""
    grid = grid_of(pinion)
    middle, wide = 0.5 * grid.roll_edges[5:7].sum(), np.diff(grid.roll_edges[5:7])[0]
    crest = crest_left(grid, column_means(grid, lambda roll: 0.02 + 0.002 * (roll - middle) ** 2), 4)
    assert crest.max() < 0.1 * 2.0 * 0.002 * wide**2


def test_of_few_worn_flanks_no_corner_is_told(pinion):
    grid = grid_of(pinion)
    middle = 0.5 * grid.roll_edges[5:7].sum()
    depth = column_means(grid, lambda roll: 0.01 * np.abs(roll - middle))
    depth[3:] = 0.0
    assert not crest_left(grid, depth, 4).any()

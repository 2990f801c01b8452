"""Profiles and solids of worn helical gears: rows fine enough for the turn of the teeth, and arcs by the normal depth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearwear.design import Gear, GearSpec
from gearwear.design.surface import flank_points
from gearwear.placing.cells import CellGrid
from gearwear.wear.profiles import MAX_TURN, ProfileNodes, node_heights, worn_profiles
from gearwear.wear.solid import gear_triangles
from tests.wear.sections import section_thickness

GEAR = Gear.from_spec(GearSpec("gear", 19, 3.0, 30.0, profile_shift=0.1, helix_angle=math.radians(-28.0)))


def grid(size: float) -> CellGrid:
    return CellGrid.for_scan(GEAR, 50_000, size=size)


def test_rows_are_added_where_the_teeth_turn_far_between_them():
    fine, coarse = grid(0.5), grid(8.0)
    assert len(node_heights(fine)) == fine.rows + 2
    heights = node_heights(coarse)
    assert len(heights) > coarse.rows + 2
    assert np.diff(heights).max() * abs(GEAR.twist) < MAX_TURN * (1 + 1e-12)
    assert (heights[0], heights[-1]) == (0.0, 30.0) and (np.diff(heights) > 0.0).all()


@pytest.mark.parametrize("size", [pytest.param(0.5, marks=pytest.mark.long), 8.0])
def test_an_even_loss_takes_its_arc_everywhere(size):
    """d along the normal turns the flank by d / (r_b cos β_b), whatever the rows: the volume is the area between two sections times b."""
    cells = grid(size)
    depth = np.zeros((GEAR.teeth, 2, cells.rows, cells.fillet + cells.flank))
    depth[:, 0, :, cells.fillet :] = 0.08
    worn = worn_profiles(ProfileNodes.of(cells), depth)
    turn = 0.08 / (GEAR.base_radius * math.cos(GEAR.base_helix_angle))
    on = worn.radius >= GEAR.form_radius
    lost = GEAR.half_angle(worn.radius)[on] - worn.half_angle[:, 0][..., on]
    assert lost == pytest.approx(np.full(lost.shape, turn), rel=1e-9)
    assert worn.loss[:, 0][..., on] == pytest.approx(np.full(lost.shape, 0.08), rel=1e-9)
    whole = gear_triangles(worn_profiles(ProfileNodes.of(cells), np.zeros_like(depth))).volume
    sector = GEAR.teeth * GEAR.face_width * turn * 0.5 * (GEAR.flank_end_radius**2 - GEAR.form_radius**2)
    taken = whole - gear_triangles(worn).volume
    assert taken == pytest.approx(sector, rel=0.05)  # and what it takes of the fillet's top, and chords


def test_arcs_are_transverse_and_by_the_points_own_height():
    rng = np.random.default_rng(0)
    n = 120_000
    tooth, side = rng.integers(0, GEAR.teeth, n), rng.choice([-1, 1], n)
    roll = GEAR.reference_roll + rng.uniform(-1.0, 1.0, n)
    points = flank_points(GEAR, tooth, side, roll, rng.uniform(0.0, 30.0, n))
    # Deep in the upper half: there the feet lie off the points' own heights.
    points = points.with_deviation(-0.3 * (points.position[:, 2] > 15.0))
    found = section_thickness(points, GEAR, 1e-6, z=np.arange(1.0, 30.0, 1.0))
    loss = 0.6 * GEAR.reference_radius / (GEAR.base_radius * math.cos(GEAR.base_helix_angle))
    shift = 0.5 + 0.3 * abs(math.sin(GEAR.base_helix_angle))
    low, high = found.z < 15.0 - shift, found.z > 15.0 + shift
    assert found.nominal == pytest.approx(GEAR.tooth_thickness)
    for rows, arc in ((low, found.nominal), (high, found.nominal - loss)):
        assert found.arc[:, rows] == pytest.approx(np.full((GEAR.teeth, int(rows.sum())), arc), abs=1e-9)

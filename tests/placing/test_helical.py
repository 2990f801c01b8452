"""Helical scans placed from scratch: a known motion comes back, and what cannot be seen is said.

The scans are of the generator in tests/synthetic, which shares nothing with the package.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from gearwear.design import Gear
from gearwear.errors import InputError
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.placing.pose import Pose, along_screw
from gearwear.placing.refusal import check_gear
from gearwear.placing.side_maps import make_side_maps
from gearwear.placing.views import PlacedScan, place
from tests.synthetic.helical import Helical, scan
from tests.synthetic.test_helical import designed
from tests.synthetic.tooth import Cloud

RIGHT, STEEP = Helical(), Helical(teeth=21, helix=-33.0, width=25.0, tip_radius=0.2)
SEEN = (pytest.param(RIGHT, marks=pytest.mark.long), STEEP)


@cache
def placed(gear: Helical, faces: bool = True) -> tuple[Cloud, PlacedScan, Gear]:
    cloud = scan(gear, 40_000, seed=3, faces=faces)
    design = designed(gear)
    return cloud, place([cloud.points], design, [None]), design


def left_over(cloud: Cloud, found: PlacedScan, design: Gear) -> tuple[np.ndarray, float, np.ndarray]:
    """What is left of the true motion at mid-face: shift, mm, turn about the axis beside whole teeth, and tilt, rad."""
    motion = Pose(cloud.rotation, cloud.translation).then(found.registration.pose)
    middle = np.array([0.0, 0.0, 0.5 * design.face_width])
    assert motion.rotation[2, 2] > 0.9  # not upside down: the scan's own axes are near
    turn = math.remainder(math.atan2(motion.rotation[1, 0], motion.rotation[0, 0]), design.pitch_angle)
    return motion.apply(middle[None])[0] - middle, turn, motion.rotation[:2, 2]


@pytest.mark.long
@pytest.mark.parametrize("gear", SEEN)
def test_a_known_motion_comes_back_within_its_own_deviations(gear):
    cloud, found, design = placed(gear)
    registration = found.registration
    shift, turn, tilt = left_over(cloud, found, design)
    std = np.sqrt(np.diag(registration.covariance))
    assert registration.converged and registration.observed.all()
    assert (np.abs(shift) < 4.0 * std[:3] + 1e-5).all()
    assert abs(turn) < 4.0 * std[5] + 1e-6
    assert (np.abs(tilt) < 4.0 * std[3:5].max() + 1e-6).all()
    assert std[:3].max() < 1e-3 and std[5] < 3e-5


@pytest.mark.parametrize("gear", SEEN)
def test_without_end_faces_the_screw_is_not_seen_and_the_rest_is(gear):
    cloud, found, design = placed(gear, faces=False)
    registration = found.registration
    shift, turn, _ = left_over(cloud, found, design)
    assert registration.observed.tolist() == [True, True, False, True, True, True]
    assert any("no end face was seen" in note and "turn is stated for this height" in note for note in registration.notes)
    assert registration.covariance[2, 2] == 0.0
    along_teeth = turn - design.twist * shift[2]
    assert abs(along_teeth) < 4.0 * registration.rotation_std
    assert registration.rotation_std < 3e-5
    assert np.abs(shift[:2]).max() < 2e-3


@pytest.mark.long
def test_moving_along_the_teeth_leaves_their_flanks():
    cloud, found, design = placed(RIGHT)
    pose = found.registration.pose
    moved = along_screw(pose, design, 0.7)
    before, after = pose.apply(cloud.points), moved.apply(cloud.points)
    turn = design.twist * 0.7
    assert after[:, 2] - before[:, 2] == pytest.approx(np.full(len(before), 0.7))
    angle = np.angle((after[:, 0] + 1j * after[:, 1]) / (before[:, 0] + 1j * before[:, 1]))
    assert angle == pytest.approx(np.full(len(before), turn), abs=1e-12)


@pytest.mark.parametrize(
    ("degrees", "said"),
    [
        (-20.0, "the design is left hand, helix_angle = -20"),
        (17.0, "helical, right hand, of a larger helix angle"),
        (23.0, "helical, right hand, of a smaller helix angle"),
        (0.0, "the design is of a spur gear"),
    ],
)
def test_a_wrong_hand_or_angle_is_refused_by_name(degrees, said):
    cloud = scan(RIGHT, 12_000, seed=4)
    design = designed(Helical(helix=degrees))
    with pytest.raises(InputError) as error:
        check_gear(place([cloud.points], design, [None]), design)
    assert "not of this gear" in str(error.value) or "does not fit" in str(error.value)
    assert said in str(error.value)


@pytest.mark.parametrize("gear", SEEN)
def test_cells_know_their_own_height_and_their_area_is_the_helicoids(gear):
    """Area of a flank: ∫∫ L / (r_b cos β_b) dL dz; and every row of a flank holds the points of its own heights, worn or not."""
    _, found, design = placed(gear)
    grid = CellGrid.for_scan(design, 40_000)
    cells = bin_points(found.located, grid)
    maps = make_side_maps(cells)
    flank = grid.rows * maps.area[grid.fillet :].sum()
    exact = gear.width * (design.tip_roll**2 - design.form_roll**2) / (2 * gear.base) / gear.base_cos
    assert flank == pytest.approx(exact, rel=1e-12)
    fillet = grid.rows * maps.area[: grid.fillet].sum()
    radius, half = gear.fillet(400)
    z = np.linspace(0.0, gear.width, 101)
    angle = half + gear.turn * (z[:, None] - 0.5 * gear.width)
    skin = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(z[:, None], angle.shape)], axis=-1)
    along, up = np.diff(skin, axis=1)[:-1], np.diff(skin, axis=0)[:, :-1]
    assert fillet == pytest.approx(np.linalg.norm(np.cross(along, up), axis=-1).sum(), rel=0.015)  # chords of the columns
    deep = found.located.with_deviation(found.located.deviation - 0.5)
    on = (deep.surface == 0) & (np.abs(deep.position[:, 2] - 0.5 * gear.width) < 0.4 * gear.width)
    height = deep.own_height[on]
    row = (grid.index(deep)[on] // grid.flank) % grid.rows
    assert np.abs(height / gear.width * grid.rows - row - 0.5).max() < 0.5 + 1e-9

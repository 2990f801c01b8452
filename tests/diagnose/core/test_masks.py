"""Which cells a fit may use, on cells made by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, TIP
from gearwear.diagnose.masks import folds, not_stray, sound_cells, worn_mask
from gearwear.diagnose.rules import RULES
from gearwear.placing.cells import bin_points
from tests.diagnose.core.toy import TEETH, cells_of, grid, sides_of
from tests.diagnose.sample import feet

NOISE, COUNT = 0.005, 20.0


def noisy(one, seed=1):
    at = sides_of(one)
    return at, NOISE / np.sqrt(COUNT) * np.random.default_rng(seed).normal(size=at.z.shape)


def mask_of(one, sheets, caution=1.0):
    cells = cells_of(one, sheets, COUNT, NOISE)
    return one.sides(worn_mask(cells, np.nan_to_num(cells.points.deviation), NOISE, caution))


def test_a_hollow_is_masked_with_its_rim_and_nothing_else():
    one = grid()
    at, sheets = noisy(one)
    hollow = (at.tooth == 4) & ~at.left & (np.abs(at.z - 0.5) < 0.2) & (np.abs(at.across - 0.6) < 0.2)
    mask = mask_of(one, np.where(hollow, -0.05, sheets))
    assert mask[hollow].all()
    assert not mask[(at.tooth != 4) | at.left].any()
    assert mask.sum() > hollow.sum()  # its rim


def test_metal_that_stands_proud_is_not_worn():
    one = grid()
    at, sheets = noisy(one)
    hump = (at.tooth == 4) & ~at.left & (np.abs(at.z - 0.5) < 0.2)
    assert not mask_of(one, np.where(hump, 0.05, sheets)).any()


def test_what_all_flanks_lack_alike_was_made_so():
    one = grid()
    at, sheets = noisy(one)
    relief = -0.05 * np.maximum(at.across - 0.7, 0.0) / 0.3
    assert not mask_of(one, sheets + relief).any()
    assert mask_of(one, sheets + np.where(at.left, relief, 0.0)).any()  # on one side alone it may be wear


def test_noise_alone_is_seldom_masked_and_caution_masks_less():
    one = grid()
    scans = [noisy(one, seed)[1] for seed in range(100)]
    # At 1 % of scans: more than 5 of 100 in one case of 2000.
    assert sum(mask_of(one, sheets).any() for sheets in scans) <= 5
    at, sheets = noisy(one)
    shallow = np.where((at.tooth == 2) & at.left, -3.0 * NOISE / np.sqrt(COUNT), 0.0) + sheets
    masks = [mask_of(one, shallow, caution) for caution in (1.0, 1.5, 3.0)]
    assert masks[0].sum() > 0
    assert all((less <= more).all() for more, less in pairwise(masks))


def scanned(size):
    """Cells of all surfaces of the bored gear, and where the seen ones of the tip lands lie: from −1 to 1 across."""
    points = feet()
    gear = grid(size).gear
    cells = bin_points(points, grid(size))
    cells = replace(cells, count=np.where(cells.seen, COUNT, 0.0))
    tip = np.flatnonzero(cells.seen & (cells.points.surface == TIP))
    angle = np.arctan2(cells.points.position[tip, 1], cells.points.position[tip, 0]) - cells.points.tooth[tip] * gear.pitch_angle
    return cells, tip, (np.mod(angle + np.pi, 2.0 * np.pi) - np.pi) / gear.tip_half_angle


def test_cells_of_few_points_and_next_to_the_form_circle_are_left_out():
    one = grid()
    at, sheets = noisy(one)
    cells = cells_of(one, sheets, COUNT, NOISE)
    # A side that is thin all over is thin by itself: its own cells are its measure.
    thin = one.on_cells((at.tooth == 3) & at.left & (at.across > 0.8))
    low = one.on_cells((at.tooth == 5) & (at.across > 0.5))
    roll = np.where(low, one.gear.form_roll + 0.9 * RULES.edge * one.gear.transverse_module, cells.points.roll)
    cells = replace(cells, count=np.where(thin, 0.2 * COUNT, cells.count), points=replace(cells.points, roll=roll))
    sound = sound_cells(cells, frozenset())
    np.testing.assert_array_equal(sound, cells.seen & ~thin & ~low)


@pytest.mark.parametrize("side", list(Side))
def test_a_side_worn_throughout_is_left_out_with_the_end_of_its_fillets(side):
    one = grid()
    cells = cells_of(one, noisy(one)[1], COUNT, NOISE)
    plain, without = sound_cells(cells, frozenset()), sound_cells(cells, frozenset({side}))
    gone = plain & ~without
    radius = np.hypot(*cells.points.position[:, :2].T)
    flank = (cells.points.surface == FLANK) & (cells.points.side == side)
    upper = (cells.points.surface == FILLET) & (cells.points.side == side) & (radius > one.fillet_radius[-2])
    np.testing.assert_array_equal(gone, plain & (flank | upper))
    assert not (without & ~plain).any()


def test_a_tip_land_of_many_columns_loses_its_outer_two():
    cells, tip, across = scanned(0.8)
    columns = cells.grid.tip
    assert columns >= 4 and (np.abs(across) > 1.0 - 2.0 / columns).any()
    np.testing.assert_array_equal(sound_cells(cells, frozenset())[tip], np.abs(across) <= 1.0 - 2.0 / columns)


@pytest.mark.parametrize(("size", "columns"), [(4.0, 1), (2.0, 2), (1.5, 3)])
def test_a_tip_land_of_few_columns_stays_unless_the_flank_beside_it_is_worn(size, columns):
    cells, tip, across = scanned(size)
    assert cells.grid.tip == columns and len(tip) > 0
    assert sound_cells(cells, frozenset())[tip].all()
    for side in Side:
        np.testing.assert_array_equal(sound_cells(cells, frozenset({side}))[tip], side * across <= 1.0 - 2.0 / columns)
    np.testing.assert_array_equal(sound_cells(cells, frozenset(Side))[tip], np.abs(across) <= 1.0 - 2.0 / columns)


def test_a_torn_cell_is_a_stray_and_a_common_offset_is_not():
    rng = np.random.default_rng(6)
    residual = 0.3 + 0.002 * rng.normal(size=500)
    residual[7] += 0.1
    kept = not_stray(residual, np.arange(500) != 7)
    assert np.flatnonzero(~kept).tolist() == [7]


@pytest.mark.parametrize(("teeth", "pieces"), [(1, 12), (4, 3), (5, 3)])
def test_of_few_teeth_that_were_seen_pieces_are_left_out(teeth, pieces):
    """Twelve or a few more, as far as there are rows, each a piece of one tooth along z; of three teeth Student's t would ask for more than any effect shows."""
    one = grid()
    at, sheets = noisy(one)
    cells = cells_of(one, sheets, COUNT, NOISE).without(one.on_cells(at.tooth >= teeth))
    by_tooth = one.sides(folds(cells)[0])[:teeth]
    np.testing.assert_array_equal(by_tooth // pieces, at.tooth[:teeth])
    stretch = by_tooth % pieces
    assert (np.diff(stretch, axis=2) >= 0).all()  # the higher the further
    assert stretch.max() == pieces - 1 and stretch.min() == 0


def test_folds_leave_out_every_tooth_and_every_height_once_and_never_all_of_either():
    one = grid()
    at, sheets = noisy(one)
    cells = cells_of(one, sheets, COUNT, NOISE)
    by_tooth, by_block = (one.sides(fold) for fold in folds(cells))
    np.testing.assert_array_equal(by_tooth, at.tooth)
    assert set(by_block.ravel().tolist()) == set(range(6))
    for fold in range(6):
        out = by_block == fold
        for tooth in range(TEETH):
            share = out[tooth].mean()
            assert 0.0 < share < 0.5
        rows = out.mean(axis=(0, 1, 3))
        assert (rows > 0.0).all() and (rows < 0.5).all()

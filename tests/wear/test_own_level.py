"""Worn flanks of teeth made thinner and thicker, under an index for each tooth: what the generator took away is asked back."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from gearwear.design.side import Side
from gearwear.design.surface import locate
from gearwear.diagnose.active_face import ActiveFace
from gearwear.diagnose.effects.pitch import EFFECT as PITCH
from gearwear.diagnose.made_height import MadeHeight
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.placing.side_maps import make_side_maps
from gearwear.wear.own_level import above_made, at_own_level, standing_proud
from gearwear.wear.regions import find_wear
from tests.placing.cells import every_cell, flanks_of, with_flanks
from tests.placing.placing import designed, true_pose
from tests.synthetic import Patch, Recipe, make_scan

PINION = designed()
SURE = 4.0
WORN = (5, 1)
SCATTER = 0.0015
"""mm; of the levels that teeth without wear have on both flanks: half of their thickness errors."""
INDEXED = SimpleNamespace(effects=(SimpleNamespace(candidate=SimpleNamespace(effect=PITCH)),))


def levelled(own, seed=7):
    """Scan and cells of a gear with one patch: sound teeth off by ±`SCATTER` on both flanks, the worn flank by `own` (mm) and the one behind it by
    nothing, as an index that follows the latter leaves it."""
    scan = make_scan(
        Recipe(jitter=1.0, noise_um=3.0, wear=(Patch(*WORN, 120.0, (37.0, 42.0), (3.0, 11.0)),)).of_size(40_000), seed
    )
    located = locate(true_pose(scan).apply(scan.points), PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)))
    level = np.repeat(SCATTER * np.random.default_rng(seed).choice([-1.0, 1.0], PINION.teeth)[:, None], 2, axis=1)
    level[WORN[0]] = 0.0
    sheet = np.zeros(cells.grid.sides(cells.count).shape) + level[..., None, None]
    sides = cells.grid.sides(cells.points.side)
    sheet[WORN[0]] += np.where(sides[WORN[0]] == WORN[1], own, 0.0)
    return scan, cells.with_deviation(cells.points.deviation + cells.grid.on_cells(sheet))


@pytest.mark.parametrize("own", [-0.006, -0.003, 0.0, 0.003, 0.006])
def test_the_level_of_a_worn_flank_is_no_wear_where_teeth_scatter_as_much(own):
    """What is lost is the patch, however thin or thick the tooth was made; without the level it is off by the level times the flank."""
    scan, cells = levelled(own)
    raised, perhaps = at_own_level(cells, noise(cells), INDEXED)
    wear = find_wear(raised, noise(cells))
    assert [(region.tooth, int(region.side)) for region in wear.regions] == [WORN]
    assert abs(wear.volume - scan.truth.volume_mm3) < SURE * wear.volume_std
    assert wear.volume == pytest.approx(scan.truth.volume_mm3, rel=0.1)
    area = float(wear.side_maps.area[wear.side_maps.fillet :].sum()) * wear.mask.shape[2]
    assert perhaps == pytest.approx(max(-own, 0.0) * area, abs=0.001 * area)
    if own:
        assert abs(wear.volume - scan.truth.volume_mm3) < abs(find_wear(cells, noise(cells)).volume - scan.truth.volume_mm3)
    if own < -0.005:
        assert find_wear(cells, noise(cells)).volume > 1.5 * scan.truth.volume_mm3


def test_a_flank_far_lower_than_teeth_scatter_is_worn():
    _, cells = levelled(-0.020)
    assert at_own_level(cells, noise(cells), INDEXED) == (cells, 0.0)


def test_without_an_index_for_each_tooth_nothing_is_done():
    _, cells = levelled(-0.006)
    assert at_own_level(cells, noise(cells), None) == (cells, 0.0)
    assert at_own_level(cells, noise(cells), SimpleNamespace(effects=())) == (cells, 0.0)


LEFT = frozenset({Side.LEFT})


def sliding(thick, shared=0.0):
    """Side maps of a gear whose left flanks have slid, 60 µm at most and nothing at the pitch point, and stand `thick` (mm) above where a loop without
    them puts them; `shared` (mm) is the top of a form that both sides have next to their roots."""
    scan = make_scan(Recipe(jitter=1.0, pose="none", noise_um=4.0).of_size(40_000), 3)
    located = locate(scan.points, PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)))
    way = cells.grid.rolls(2)[1::2] / PINION.reference_roll - 1.0
    lost = 0.06 * np.abs(way) / np.abs(way).max()
    deviation = cells.points.deviation.copy()
    flank = cells.grid.flank_shape(deviation)
    flank[:, Side.LEFT.index] += thick - lost
    flank[..., :2] += shared
    return make_side_maps(cells.with_deviation(deviation))


def as_known_to(std, faces=()):
    return SimpleNamespace(as_made_std=(std, std), made=MadeHeight(), context=SimpleNamespace(faces=faces))


@pytest.mark.parametrize("thick", [0.02, 0.04])
def test_a_worn_side_that_stands_proud_tells_how_much_thicker_its_teeth_were_cut(thick):
    proud = standing_proud(sliding(thick), as_known_to(0.004), LEFT)
    assert proud == (pytest.approx(thick, abs=0.0025), 0.0)  # the cells beside the pitch point have slid by up to 2 µm


def test_what_may_be_chance_and_what_roots_share_is_not_proud():
    assert standing_proud(sliding(0.02), as_known_to(0.012), LEFT) == (0.0, 0.0)
    assert standing_proud(sliding(0.0, shared=0.05), as_known_to(0.004), LEFT) == (0.0, 0.0)
    assert standing_proud(sliding(-0.02), as_known_to(0.004), LEFT) == (0.0, 0.0)


def test_a_tooth_that_is_worn_far_deeper_leaves_the_level_of_all_where_it_is():
    """As high as without it: half of a millimetre off one tooth of twelve is no doubt of the median of them."""
    sheets = sliding(0.02)
    deep = sheets.deviation.copy()
    deep[3, Side.LEFT.index] -= 0.5
    level, known = as_known_to(0.004), standing_proud(sheets, as_known_to(0.004), LEFT)[0]
    assert standing_proud(replace(sheets, deviation=deep), level, LEFT)[0] == pytest.approx(known, abs=0.001)


def test_chance_on_the_other_side_takes_nothing_off_a_worn_one():
    """Its cells scatter up as often as down: of the mean over a strip nothing is left of them."""
    scatter = np.random.default_rng(2)
    sheets = sliding(0.04)
    flanks = np.zeros(sheets.deviation.shape)
    flanks[:, Side.LEFT.index] = 0.04
    flanks[:, Side.RIGHT.index] = scatter.normal(0.0, 0.008, flanks[:, 1].shape)
    above = above_made(replace(sheets, deviation=flanks), Side.LEFT)
    assert np.nanmean(above) == pytest.approx(0.04, abs=0.0003)


def test_where_both_sides_are_worn_or_no_loop_was_closed_nothing_is_said():
    sheets = sliding(0.04)
    assert standing_proud(sheets, as_known_to(0.004), frozenset(Side)) == (0.0, 0.0)
    assert standing_proud(sheets, as_known_to(0.004), frozenset()) == (0.0, 0.0)
    assert standing_proud(sheets, None, LEFT) == (0.0, 0.0)


def test_the_highest_of_many_strips_is_high_by_chance():
    """Flanks slid by 60 µm on one side of the pitch point and not on the other, of noise alone: a level known to 0.1 µm stands proud in no more of 60 gears
    than five in a hundred leave likely (binomial, 0.999); where it is 2 µm thicker, in all of them."""
    cells = every_cell(PINION, 0.9)
    taken = []
    for seed in range(60):
        flank = flanks_of(cells)
        flank[:, 0, :, : flank.shape[3] // 2] -= 0.06
        flank += 0.004 * np.random.default_rng(seed).standard_normal(flank.shape)
        sheets = [make_side_maps(with_flanks(cells, flank + more)) for more in (0.0, np.array([0.002, 0.0])[:, None, None])]
        taken.append([standing_proud(one, as_known_to(0.0001), LEFT)[0] for one in sheets])
    none, thick = np.array(taken).T
    assert np.count_nonzero(none) <= stats.binom.ppf(0.999, 60, 0.05)
    assert np.all(thick > 0.0) and abs(thick.mean() - 0.002) < 0.001


def test_a_side_that_shows_where_no_mate_ran_needs_no_strip_for_its_level():
    sheets = sliding(0.02)
    assert standing_proud(sheets, as_known_to(0.004), LEFT)[0] > 0.01
    assert standing_proud(sheets, as_known_to(0.004, (ActiveFace(Side.RIGHT, 2.0, 9.0),)), LEFT)[0] > 0.01
    assert standing_proud(sheets, as_known_to(0.004, (ActiveFace(Side.LEFT, 2.0, 9.0),)), LEFT) == (0.0, 0.0)

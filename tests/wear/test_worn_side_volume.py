"""Volume of a side worn throughout, of few points, where the wear is steep: flanks that are alike do not read too shallow alike."""

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FLANK, flank_points, locate
from gearwear.placing.cells import CellGrid, bin_points
from gearwear.report.words.numbers import which_flanks
from gearwear.wear.regions import find_wear
from gearwear.wear.surface import SideSurface
from tests.placing.placing import designed
from tests.synthetic import Recipe, SlidingWear, make_scan

GEAR = designed()
SIZE = 1.5
NOISE, DEEPEST, REACH = 0.005, 0.025, 0.25
WORN = frozenset({Side.LEFT})


def worn_side(random, points=6, deepest=DEEPEST):
    """A scan of left flanks that are worn from the form circle on, evenly less over L² to nothing at `REACH` of the way to the tip, and on each
    tooth by its own factor about 1; few points, and fewer on the first third of the way. And the volume that is lost: of a wedge."""
    grid = CellGrid.for_scan(GEAR, 1, SIZE)
    number = points * grid.rows * grid.flank // 4
    shape = (GEAR.teeth, 2, number)
    way = random.random(shape)
    seen = (way > 1.0 / 3.0) | (random.random(shape) < 0.4)
    low, high = grid.roll_edges[0] ** 2, grid.roll_edges[-1] ** 2
    factor = np.linspace(0.7, 1.3, GEAR.teeth)[random.permutation(GEAR.teeth)]
    loss = deepest * np.maximum(1.0 - way / REACH, 0.0) * factor[:, None, None]
    loss[:, 1] = 0.0
    tooth, half, _ = np.indices(shape)
    side = np.where(half == 0, 1, -1)
    height = GEAR.face_width * random.random(shape)
    deviation = NOISE * random.standard_normal(shape) - loss
    roll = np.sqrt(low + way * (high - low))
    ideal = flank_points(GEAR, tooth[seen], side[seen], roll[seen], height[seen])
    area = abs(high - low) / (2.0 * GEAR.base_radius) * GEAR.face_width
    return bin_points(ideal.with_deviation(deviation[seen]), grid), 0.5 * deepest * REACH * area * factor


@pytest.mark.long
def test_steep_wear_that_all_flanks_share_is_not_flattened():
    errors = []
    for seed in range(8):
        cells, lost = worn_side(np.random.default_rng(seed))
        wear = find_wear(cells, NOISE, WORN, limits=False)
        errors.append((wear.volume - lost.sum()) / wear.volume_std)
    assert abs(np.mean(errors)) < 3.0 / np.sqrt(len(errors))
    assert 0.3 < np.sqrt(np.mean(np.square(errors))) < 1.7  # what is said to be uncertain is


def test_flanks_of_a_worn_side_that_do_not_stand_out_count_with_it():
    """Wear of which hardly any flank stands out by itself: all flanks together tell what was lost, or none does and the range holds it."""
    errors, alone = [], 0
    for seed in range(8):
        cells, lost = worn_side(np.random.default_rng(seed), deepest=0.4 * DEEPEST)
        wear = find_wear(cells, NOISE, WORN, limits=False)
        if not wear.regions:
            assert wear.volume == 0.0 and lost.sum() < wear.unsure < 4.0 * lost.sum()
            continue
        assert len(wear.regions) == GEAR.teeth and wear.unsure == 0.0
        alone += sum(region.volume > 3.0 * region.volume_std for region in wear.regions)
        errors.append((wear.volume - lost.sum()) / wear.volume_std)
    assert len(errors) > 3 and alone < 0.5 * GEAR.teeth * len(errors)
    assert np.abs(errors).max() < 2.5


def test_flanks_that_were_not_seen_have_no_wear():
    """Half of the teeth, and of one more one place of its flank: nothing is said of those, though their side is worn throughout."""
    cells, lost = worn_side(np.random.default_rng(2), points=12, deepest=2.0 * DEEPEST)
    teeth = GEAR.teeth // 2
    points, hidden = cells.points, cells.points.tooth >= teeth
    there = (points.tooth == teeth) & (points.surface == FLANK) & (points.side == Side.LEFT)
    hidden[np.argmax(there * cells.count)] = False
    half = cells.without(hidden)
    wear = find_wear(half, NOISE, WORN)
    seen = {flank.tooth for flank in wear.flanks if flank.side is Side.LEFT and flank.seen > 0.1}
    assert seen == set(range(teeth)) and any(flank.tooth == teeth and flank.seen > 0.0 for flank in wear.flanks)
    assert sorted(region.tooth for region in wear.regions) == list(range(teeth)) and wear.flanks_seen(Side.LEFT) == teeth
    assert min(region.max_depth for region in wear.regions) > 0.0
    assert not wear.mask[teeth:].any() and not wear.depth[teeth:].any()
    assert abs(wear.volume - lost[:teeth].sum()) < 3.0 * wear.volume_std
    assert which_flanks(wear.regions, wear) == f"all {teeth} left flanks that were seen"
    assert which_flanks(wear.regions[:-1], wear) == f"{teeth - 1} left flanks"


@pytest.mark.parametrize(
    ("points", "noise"),
    [
        pytest.param(points, noise, marks=[] if (points, noise) in ((36_000, 1.0), (40_000, 10.0)) else [pytest.mark.long])
        for points in (36_000, 40_000, 44_000, 60_000)
        for noise in (1.0, 10.0)
    ],
)
def test_points_of_a_lattice_may_miss_what_wear_takes_off_an_undercut_fillet(points, noise):
    """Sliding after Archard, 0.1 mm at the form circle: a wedge of the fillet there goes with it, 8 % of the volume and narrower than the rows of
    points are apart, and the first column of the flank falls to a tenth. The truth is integrated apart (`tests/synthetic/removal.py`)."""
    recipe = Recipe(pose="none", noise_um=noise, wear=(SlidingWear(100.0, law="archard"),)).of_size(points)
    scan = make_scan(recipe, seed=3)
    cells = bin_points(locate(scan.points, GEAR), CellGrid.for_scan(GEAR, points))
    wear = find_wear(cells, 1e-3 * noise, WORN, limits=False)
    off = wear.volume - scan.truth.volume_mm3
    assert abs(off) < 2.0 * wear.volume_std
    assert wear.volume_std < 0.15 * wear.volume


def test_the_shares_of_the_other_flanks_are_in_the_weights():
    """A volume that leans on what all flanks have in common moves by what its weights say when another flank's cells move."""
    random = np.random.default_rng(5)
    mean, count = -0.02 + NOISE * random.standard_normal((6, 5)), np.full((6, 5), 2.0)
    variance, offset, everywhere = NOISE**2 / count, np.zeros((2, 6, 5)), np.ones((6, 5), dtype=bool)
    common = SideSurface.of(mean, 10.0 * count, 0.1 * variance, offset, everywhere)
    own = mean + NOISE * random.standard_normal((6, 5))
    area = random.random((6, 5))
    surface = SideSurface.of(own, count, variance, offset, everywhere, common)
    passed, unknown = common.passed_on(surface.left_to_before(area)[None])
    weights, _ = surface.shares(area)
    # Both surfaces follow a level wholly, so what they weigh is all of the area; and the integral is that sum but for the level.
    assert (weights + passed[0]).sum() == pytest.approx(area.sum(), rel=1e-9)
    integral = float((surface.value * area).sum())
    assert float((weights * own + passed[0] * mean).sum()) == pytest.approx(integral, rel=1e-9)
    assert unknown[0, 0] >= 0.0


@pytest.mark.parametrize("both", [True, False])
def test_corners_made_on_both_sides_are_no_wear_of_the_worn_one(both):
    """Left flanks worn evenly, and the corner of tip and lower end taken off, evenly less over a third of the face: of all flanks, or of the worn ones
    alone. Where both sides have it, its cells next to the end are no wear; where only the worn one has it, all of it is."""
    random = np.random.default_rng(3)
    grid = CellGrid.for_scan(GEAR, 1, 0.4 * SIZE)
    shape = (GEAR.teeth, 2, 300 * grid.rows)
    tooth, half, _ = np.indices(shape)
    way, height = random.random(shape), GEAR.face_width * random.random(shape)
    low, corner, high = grid.roll_edges[[0, -3, -1]] ** 2
    last, even, deep, reach = (high - corner) / (high - low), 0.02, 0.3, 5.0
    fallen = deep * np.maximum(1.0 - height / reach, 0.0) * (way > 1.0 - last) * (both | (half == 0))
    deviation = NOISE * random.standard_normal(shape) - even * (half == 0) - fallen
    places = (tooth, np.where(half == 0, 1, -1), np.sqrt(low + way * (high - low)), height)
    ideal = flank_points(GEAR, *(a.ravel() for a in places))
    wear = find_wear(bin_points(ideal.with_deviation(deviation.ravel()), grid), NOISE, WORN, limits=False)
    assert {region.side for region in wear.regions} == {Side.LEFT}
    lost = even * GEAR.face_width + last * deep * 0.5 * reach
    if both:
        end = 2.0 * grid.row_height  # rows of which the middle lies within 5 % of the face and a row
        lost -= last * end * (even + deep * (1.0 - 0.5 * end / reach))
    assert wear.volume == pytest.approx(GEAR.teeth * abs(high - low) / (2.0 * GEAR.base_radius) * lost, rel=0.03)


def test_wear_whose_stiffness_is_known_is_the_same_without_a_search(monkeypatch):
    """Of each flank, each fillet and what the flanks have in common: nothing is left to ask, and every number is the same."""
    cells, _ = worn_side(np.random.default_rng(3), points=12)
    own = find_wear(cells, NOISE, WORN, limits=False)
    assert own.regions and own.as_stiff
    for search in ("likeliest", "shares_of_likelihood"):
        monkeypatch.setattr(f"gearwear.wear.surface.{search}", None)
    again = find_wear(cells, NOISE, WORN, limits=False, as_stiff=own.as_stiff)
    assert [(one.volume, one.max_depth) for one in again.regions] == [(one.volume, one.max_depth) for one in own.regions]
    with pytest.raises(TypeError):
        find_wear(cells, NOISE, WORN, limits=False)

"""Where the mate ran, from flanks whose heights are known because they were put in."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FLANK, ROOT, TIP, locate
from gearwear.diagnose.active_face import active_faces
from gearwear.diagnose.effects.face_level import EFFECT as FACE_LEVEL
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.placing.cells import CellGrid, bin_points, noise
from gearwear.wear.regions import find_wear
from tests.diagnose.plain import PLAIN, PLAIN_AND_ALL
from tests.placing.placing import designed
from tests.synthetic import Recipe, make_scan

GEAR = designed()
WIDTH, TEETH = GEAR.face_width, GEAR.teeth


def scanned(seed=3, points=30_000):
    """Points of an unworn gear, 6 µm of noise, in the design frame."""
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", fillets_follow=False)
    return locate(make_scan(recipe.of_size(points), seed).points, GEAR)


SOUND = scanned()


def cells_with(heights, points=SOUND):
    """The cells of the scan with `heights` of tooth, side and ζ, mm, added to its flanks."""
    zeta = points.position[:, 2] / WIDTH - 0.5
    added = np.where(points.surface == FLANK, heights(points.tooth, points.side, zeta), 0.0)
    moved = points.with_deviation(points.deviation + added)
    return bin_points(moved, CellGrid.for_scan(GEAR, len(points)), clip=0.4)


def low_between(low, high, depth, side=0, teeth=None):
    """A loss of `depth` mm from z = low to high, on the flanks of a side or of both, of all teeth or those of a share."""

    def heights(tooth, own, zeta):
        z = (zeta + 0.5) * WIDTH
        there = (z > low) & (z < high) & (side in (0, 1, -1)) & ((own == side) | (side == 0))
        return np.where(there & (True if teeth is None else tooth < teeth * TEETH), -depth, 0.0)

    return heights


def test_both_ends_are_found_to_half_a_row():
    cells = cells_with(low_between(2.6, 12.1, 0.015, side=-1))
    (face,) = active_faces(cells)
    half = 0.5 * cells.grid.row_height
    assert face.side is Side.RIGHT
    assert face.low == pytest.approx(2.6, abs=half) and face.high == pytest.approx(12.1, abs=half)
    assert face.at_both_ends(GEAR)


def test_where_one_end_alone_shows_it_the_stretch_goes_on_to_the_other():
    faces = active_faces(cells_with(low_between(-1.0, 11.0, 0.015)))
    assert [face.side for face in faces] == [Side.LEFT, Side.RIGHT]
    for face in faces:
        assert face.low == 0.0 and face.high == pytest.approx(11.0, abs=0.5)
        assert not face.at_both_ends(GEAR)


@pytest.mark.parametrize(
    "heights",
    [
        pytest.param(lambda tooth, side, zeta: 0.0 * zeta, id="as made"),
        pytest.param(lambda tooth, side, zeta: -0.012 * (2.0 * zeta) ** 2, id="crowned"),
        pytest.param(lambda tooth, side, zeta: 0.012 * (2.0 * zeta) ** 2, id="hollow"),
        pytest.param(lambda tooth, side, zeta: 0.008 * (2.0 * zeta) ** 4 + 0.010 * zeta, id="hollow at the ends, leaning"),
        pytest.param(
            lambda tooth, side, zeta: 0.030 * (2.0 * zeta) ** 2 - low_between(2.6, 12.1, 0.010)(tooth, side, zeta),
            id="hollow, and proud where a mate would have run",
        ),
        pytest.param(lambda tooth, side, zeta: -0.015 * np.clip(10.0 * np.abs(zeta) - 4.0, 0.0, None), id="end relief"),
        pytest.param(lambda tooth, side, zeta: -0.015 * (np.abs(zeta) > 0.35), id="ends low"),
        pytest.param(lambda tooth, side, zeta: 0.004 * np.cos(9.0 * zeta + 1.0), id="a wave along the face"),
        pytest.param(low_between(6.0, 8.5, 0.015), id="a groove"),
        pytest.param(low_between(-1.0, 2.0, 0.050), id="an end low"),
        pytest.param(low_between(2.6, 12.1, 0.015, teeth=0.6), id="on two teeth in three"),
        pytest.param(low_between(0.3, 14.7, 0.015), id="a burr at the ends"),
    ],
)
def test_what_no_narrower_mate_leaves_is_none(heights):
    assert active_faces(cells_with(heights)) == ()


@pytest.mark.parametrize("land", [TIP, ROOT], ids=["tips", "bottom lands"])
def test_a_ledge_that_lands_show_too_is_the_scanners(land):
    """No mate touches them: a scanner that stitches two heights of a gear lifts all of what lies above."""
    z = SOUND.position[:, 2]
    stepped = SOUND.with_deviation(SOUND.deviation - np.where((SOUND.surface == land) & (z < 11.0), 0.020, 0.0))
    assert active_faces(cells_with(low_between(-1.0, 11.0, 0.015), stepped)) == ()


def test_cells_beside_it_are_as_made_and_the_others_are_not():
    cells = cells_with(low_between(2.6, 12.1, 0.5))
    for face in active_faces(cells):
        own = (cells.points.surface == FLANK) & (cells.points.side == int(face.side)) & cells.seen
        margin = face.margins(cells)
        assert margin.any() and (own & ~margin).any()
        assert (cells.points.deviation[margin] > -0.1).all()
        z = cells.points.position[margin, 2]
        assert z.min() < 1.0 and z.max() > 14.0


@pytest.mark.parametrize("level", [0.0, -0.050], ids=["as drawn", "cut low"])
def test_how_high_flanks_stand_beside_it_is_told_however_low_they_were_cut(level):
    """No mate touched them: low, they are not worn; as drawn, they are so within a ± and not by assumption."""
    low = low_between(2.6, 12.1, 0.030, side=1)
    cells = cells_with(lambda tooth, side, zeta: low(tooth, side, zeta) + np.where(side > 0, level, 0.0))
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), (FACE_LEVEL,), worn=frozenset({Side.LEFT}))
    (told,) = (one.parameters["level_um"] for one in loop.form)
    value, std = np.atleast_1d(told.value), np.atleast_1d(told.std)
    assert np.abs(value - [1e3 * level, 0.0, 0.0]) == pytest.approx(0.0, abs=4.0 * std.max())
    assert (std > 0.0).all() and std.max() < 2.0
    (face,) = loop.context.faces
    assert loop.use[face.margins(cells)].mean() > 0.9


def closed(heights, seed):
    """Cells, loop and wear of a scan with heights put in."""
    cells = cells_with(heights, scanned(seed))
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False))
    return cells, loop, find_wear(cells.with_deviation(loop.left), loop.noise, loop.worn_sides, loop, limits=False)


def lost(depth, low, high, sides):
    """Volume of an even loss of `depth` of the flanks of so many sides, mm³: ∫∫ (L − δ) / r_b dδ dL dz."""
    roll = GEAR.tip_roll**2 - GEAR.form_roll**2
    layer = depth * roll / (2.0 * GEAR.base_radius) - depth**2 * (GEAR.tip_roll - GEAR.form_roll) / (2.0 * GEAR.base_radius)
    return sides * TEETH * (high - low) * layer


@pytest.mark.long
@pytest.mark.parametrize("made", [(0.0, 0.0, 0.0), (-0.020, 0.005, -0.007)], ids=["as drawn", "low, leaning and crowned"])
@pytest.mark.parametrize(("side", "sides"), [(1, 1), (0, 2)])
def test_an_even_loss_is_told_from_thinner_teeth_beside_the_ledges(side, sides, made):
    """Without what stands at the ends an even loss of all flanks is a thinner tooth, and no scan tells it."""
    worn, apart = low_between(3.0, 11.5, 0.030, side=side), np.random.default_rng(2).normal(0.0, (0.004, 0.001), (TEETH, 2, 2))

    def heights(tooth, own, zeta):
        up = np.where((own == side) | (side == 0), 2.0 * zeta, 0.0)
        level = np.where((own == side) | (side == 0), made[0], 0.0)
        each = apart[tooth, np.where(own > 0, 0, 1)]
        return worn(tooth, own, zeta) + level + made[1] * up + made[2] * up**2 + each[..., 0] + 2.0 * zeta * each[..., 1]

    cells, loop, wear = closed(heights, 8)
    assert len(loop.worn_sides) == sides and not loop.others
    assert not {"tooth_thickness", "profile_shift", "coating"} & {effect.name for effect in loop.effects}
    assert abs(wear.volume - lost(0.030, 3.0, 11.5, sides)) < 2.0 * wear.volume_std
    assert wear.volume_std < 0.1 * wear.volume
    told = next(level for level in loop.form if level.name == "face_level").parameters["level_um"]
    off = (np.reshape(told.value, (sides, 3)) - 1e3 * np.array(made)) / np.maximum(np.reshape(told.std, (sides, 3)), 1.0)
    assert np.abs(off).max() < 3.0
    assert all(loop.use[face.margins(cells)].mean() > 0.7 for face in loop.context.faces)


@pytest.mark.long
@pytest.mark.parametrize("form", [0.0, 0.012], ids=["as drawn", "leaning and crowned"])
def test_beyond_one_end_it_is_known_as_well_as_flanks_are_cut(form):
    """What leans and bends along the face tells at one end alone how high it stands at the other."""
    worn, true = low_between(-1.0, 11.0, 0.030, side=1), lost(0.030, 0.0, 11.0, 1)
    *_, wear = closed(lambda tooth, own, zeta: worn(tooth, own, zeta) + form * zeta - form * zeta**2, 9)
    assert abs(wear.volume - true) < 2.0 * wear.volume_std
    assert (wear.volume_std > 0.04 * true) == (form > 0.0)


@PLAIN_AND_ALL
def test_the_other_side_may_be_worn_without_a_ledge(effects):
    """A mate as wide as the face on one side of an idler, a narrower one on the other."""
    narrow, wide = low_between(2.6, 12.1, 0.030, side=1), low_between(-1.0, WIDTH + 1.0, 0.060, side=-1)
    sliding = np.abs(SOUND.roll / GEAR.reference_roll - 1.0)

    def heights(tooth, own, zeta):
        return narrow(tooth, own, zeta) + wide(tooth, own, zeta) * np.nan_to_num(sliding)

    cells = cells_with(heights)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), effects)
    assert [face.side for face in loop.context.faces] == [Side.LEFT]
    assert loop.worn_sides == frozenset(Side)


def test_a_side_that_is_known_to_be_unworn_has_none():
    cells = cells_with(low_between(2.6, 12.1, 0.015, side=1))
    context = make_context(cells, np.eye(3), False)
    assert [face.side for face in context.faces] == [Side.LEFT]
    loop = close_loop(cells, noise(cells), context, PLAIN, worn=frozenset())
    assert not loop.worn_sides and not loop.context.faces

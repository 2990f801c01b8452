"""How high a worn side may stand as it was made: by what the maker left on the flanks that are seen, in closed form."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.design.side import Side
from gearwear.design.surface import FILLET, FLANK, locate
from gearwear.diagnose.effects.root_form import ROOT_FORM
from gearwear.diagnose.found import form_of_all
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.made_height import MadeHeight, fillets_off, made_height
from gearwear.diagnose.pattern import Pattern
from gearwear.placing.cells import CellGrid, bin_points, noise
from tests.diagnose.plain import PLAIN
from tests.placing.placing import designed
from tests.synthetic import Effect, Recipe, SlidingWear, make_scan

PINION = designed()
LEFT = frozenset({Side.LEFT})
TURN = 2.0 * np.pi / PINION.teeth


@pytest.fixture(scope="module")
def fit():
    """Of a scan without wear, whose right flanks are used."""
    scan = make_scan(Recipe(jitter=1.0, noise_um=6.0, pose="none").of_size(20_000), 3)
    located = locate(scan.points, PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=0.3)
    right = cells.seen & (cells.points.surface == FLANK) & (cells.points.side == int(Side.RIGHT))
    return SimpleNamespace(cells=cells, target=np.zeros(len(cells.seen)), use=right)


def of_tooth(fit, height):
    """A height of each tooth, (teeth,) mm, on all its flanks."""
    flank = fit.cells.seen & (fit.cells.points.surface == FLANK)
    return np.where(flank, np.asarray(height)[fit.cells.points.tooth], 0.0)


def waves_across(fit, amplitude):
    """The same on all right flanks: two waves across the face."""
    height = np.nan_to_num(fit.cells.points.position[:, 2])
    return np.where(fit.use, amplitude * np.sin(4.0 * np.pi * height / PINION.face_width), 0.0)


def test_a_form_of_all_teeth_may_be_on_the_worn_side_too(fit):
    """Waves across the face of the right flanks, 12 / √2 µm RMS; one that goes round the gear is no form of all teeth, and an offset of all is known."""
    field = waves_across(fit, 0.012)
    waves = Pattern(0, "right only", 2.0, 0.0, 0.008, 0.012, 0.0, field)
    once = Pattern(1, "right only", 2.0, 0.0, 0.008, 0.012, 0.0, field)
    made = made_height(LEFT, fit, [np.full(len(field), 0.05)], form_of_all((waves, once), len(field)))
    assert made.of(Side.LEFT) == made.std == pytest.approx(0.012 / np.sqrt(2.0), rel=0.01)
    assert made.of(Side.RIGHT) == 0.0
    assert made_height(frozenset(), fit, [], field) == MadeHeight()
    assert made_height(LEFT, fit, [], form_of_all((once,), len(field))) == MadeHeight()


def test_teeth_off_each_by_itself_say_as_much_of_thickness_as_they_scatter(fit):
    """By a normal amount each, drawn many times; kinds and what sound flanks are bowed by add up as errors do."""
    rng, squares, none = np.random.default_rng(5), [], np.zeros(len(fit.target))
    for _ in range(200):
        made = made_height(LEFT, fit, [of_tooth(fit, rng.normal(0.0, 0.009, PINION.teeth))], none)
        squares.append(made.std**2)
    assert np.sqrt(np.mean(squares)) == pytest.approx(0.009, rel=0.05)
    by_turns = of_tooth(fit, 0.009 * (-1.0) ** np.arange(PINION.teeth))  # neighbours are 18 µm apart
    assert made_height(LEFT, fit, [by_turns], none).std == pytest.approx(0.009 * np.sqrt(2.0), rel=1e-3)
    both = made_height(LEFT, fit, [by_turns], waves_across(fit, 0.01), 0.012)
    assert both.std == pytest.approx(np.sqrt(2.0 * 0.009**2 + 0.5 * 0.01**2 + 0.012**2), rel=0.01)


@pytest.mark.parametrize("times", [1, 2, 3])
def test_what_goes_slowly_round_the_gear_says_little_of_thickness(fit, times):
    """A wave a sin(kτ) from tooth to tooth has differences of neighbours of mean square a² (1 − cos kτ), and half of that is (a sin(kτ/2))²."""
    wave = of_tooth(fit, 0.02 * np.sin(times * TURN * np.arange(PINION.teeth)))
    assert made_height(LEFT, fit, [wave], np.zeros(len(wave))).std == pytest.approx(0.02 * np.sin(0.5 * times * TURN), rel=0.01)


def test_what_goes_along_the_face_alone_says_nothing_of_thickness(fit):
    """A lead, a crowning, a twist and marks of a feed have the same mean over the face on every profile; beside them a slope counts as it does alone."""
    grid = fit.cells.grid
    row, column = np.meshgrid(np.arange(grid.rows), np.arange(grid.flank), indexing="ij")
    along, across = (2.0 * (row + 0.5) / grid.rows - 1.0, (column + 0.5) / grid.flank)

    def of_all_flanks(shape):
        field = np.zeros(len(fit.target))
        grid.flank_shape(field)[...] = 0.02 * shape
        return field

    slope, none = of_all_flanks(across), of_all_flanks(0.0 * across)
    alone = made_height(LEFT, fit, [slope], none).std
    assert alone == pytest.approx(slope[fit.use].std(), rel=0.01)
    for shape in (along, along**2, along * across, (-1.0) ** (row // 2)):
        beside = of_all_flanks(shape)
        assert made_height(LEFT, fit, [beside], none).std < 0.05 * beside[fit.use].std()
        assert made_height(LEFT, fit, [slope, beside], none).std == pytest.approx(alone, rel=0.01)
        assert made_height(LEFT, fit, [], beside).std == pytest.approx(beside[fit.use].std(), rel=0.02)
        # From an end that no mate touched on it is known as well as flanks are straight.
        at_the_end = made_height(LEFT, fit, [beside], none, from_one_end=True)
        assert at_the_end.std == pytest.approx(beside[fit.use].std(), rel=0.02)


def off_by(fit, height):
    """The fit, with fillets that stand off by a height, (teeth, 2) mm, left first."""
    points = fit.cells.points
    fillet = fit.cells.seen & (points.surface == FILLET)
    residual = np.where(fillet, np.asarray(height)[points.tooth, np.where(points.side == int(Side.LEFT), 0, 1)], 0.0)
    return SimpleNamespace(
        cells=fit.cells, use=fit.cells.seen, weight=np.full(len(residual), 4.0), residual=lambda model: residual
    )


def test_fillets_stand_off_as_far_as_those_of_sound_sides_do(fit):
    """Left 3 µm high, right 4 µm low: the right ones tell beside left flanks that are worn, √((3² + 4²) / 2) both where both are, or none."""
    off = off_by(fit, np.tile([0.003, -0.004], (PINION.teeth, 1)))
    assert fillets_off(off, (), LEFT) == pytest.approx(0.004)
    for worn in (frozenset(Side), frozenset[Side]()):
        assert fillets_off(off, (), worn) == pytest.approx(np.sqrt(12.5) * 1e-3)
    assert fillets_off(SimpleNamespace(**{**vars(off), "use": off.cells.points.surface == FLANK}), (), LEFT) == 0.0


def test_fillets_that_scatter_by_chance_stand_off_by_what_chance_leaves(fit):
    """Each tooth off by a normal amount of its own: of mean² less its variance what is above 0 comes to 2 φ(1) = 0.484 of the mean of mean²."""
    rng, told, means = np.random.default_rng(8), [], []
    for _ in range(400):
        height = rng.normal(0.0, 0.005, (PINION.teeth, 2))
        told.append(fillets_off(off_by(fit, height), (), LEFT))
        means.append(height[:, 1].mean())
    assert np.mean(np.square(told)) / np.mean(np.square(means)) == pytest.approx(
        2.0 * np.exp(-0.5) / np.sqrt(2.0 * np.pi), abs=0.2
    )


@pytest.mark.parametrize("off_um", [0.0, 4.0])
def test_a_worn_side_is_known_no_better_than_fillets_stand_by_their_flanks(off_um):
    """Left flanks slid off, all fillets cut low by as much, and no form of the root searched: nearly that (they take a little part in the pose), or nothing."""
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=(SlidingWear(60.0, 1, law="archard"),))
    located = locate(make_scan(recipe.of_size(20_000), 3).points, PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=0.3)
    fillet = cells.points.surface == FILLET
    low = cells.with_deviation(cells.points.deviation - np.where(fillet, 1e-3 * off_um, 0.0))
    searched = tuple(effect for effect in PLAIN if effect.name != ROOT_FORM)
    loop = close_loop(low, noise(low), make_context(low, np.eye(3), False), searched, worn=LEFT)
    assert 0.8 * off_um - 0.1 < 1e3 * loop.made.of(Side.LEFT) < 1.05 * off_um + 0.3


@pytest.mark.parametrize("sides", [(1,), (1, -1)], ids=["one side", "both"])
def test_teeth_out_of_pitch_tell_how_well_a_gear_was_cut_where_no_side_is_sound(sides):
    """Indices of ±9 µm, drawn: where a sound side shows the forms, fillets tell where its teeth stand; where none does, a flank may be as far off as an index."""
    index = np.random.default_rng(8).normal(0.0, 9.0, PINION.teeth)
    index -= index.mean()
    share = tuple((1.0 + 0.3 * np.sin(np.arange(PINION.teeth) ** 2)).tolist())
    wear = tuple(SlidingWear(60.0, side, share, "archard") for side in sides)
    recipe = Recipe(jitter=1.0, noise_um=6.0, pose="none", wear=wear, effects=(Effect("pitch", {"index_um": tuple(index)}),))
    located = locate(make_scan(recipe.of_size(20_000), 3).points, PINION)
    cells = bin_points(located, CellGrid.for_scan(PINION, len(located)), clip=0.3)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False), PLAIN)
    assert {int(side) for side in loop.worn_sides} == set(sides)
    off = 1e-3 * np.sqrt(0.5 * np.mean((index - np.roll(index, 1)) ** 2)) * np.cos(PINION.transverse_pressure_angle)
    low, high = (0.0, 0.25 * off) if len(sides) == 1 else (0.85 * off, 1.15 * off)
    assert low <= loop.made.std <= high
